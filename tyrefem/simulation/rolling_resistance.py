"""Rolling resistance from hysteresis, without the friction of sliding."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from tyrefem.simulation.rolling_tyre import RollingTyre

Array = NDArray[np.float64]

#: Smallest share of its free speed at which a wheel counts as rolling (a judgement).
TURNS = 0.01


@dataclass(frozen=True)
class RollingResistance:
    """Rolling resistance from hysteresis, F = (total heat) / v, N, and coefficient F / F_z.

    ``force`` and ``coefficient`` are at the end of ``phase``, the rolling phase with most heat; ``cold_*`` at the same
    time with every point at the drive's initial temperature. All are zero if the tyre never rolls. With slip they are
    the hysteresis per metre of the road, without the friction.
    """

    phase: str
    force: float
    coefficient: float
    cold_force: float
    cold_coefficient: float


class Rolled(Protocol):
    """Data of a run for its rolling resistance."""

    @property
    def tyre(self) -> RollingTyre:
        """The tyre with its drive and load cases."""
        ...

    @property
    def times(self) -> Array:
        """Times of the readings, (n,) s."""
        ...

    def generated(self, i: int) -> tuple[float, float]:
        """Heat of hysteresis in the whole tyre: energy until ``times[i]``, J, and power at that time, W."""
        ...

    def cold_power(self, t: float) -> float:
        """Power of hysteresis at the drive's initial temperature, W."""
        ...


def rolling_reading(result: Rolled) -> int | None:
    """Index of the last reading of the rolling phase with most heat; None if the tyre never rolls."""
    tyre = result.tyre
    drive = tyre.drive
    best: tuple[float, int] | None = None
    for start, phase in zip(drive.starts, drive.phases, strict=True):
        t = (start + phase.duration) * (1 - 1e-12)
        load = tyre.schedule.mean(lambda case: case.load, t)
        if phase.stops or load <= 0 or start >= result.times[-1]:
            continue
        motion = tyre.motion(t)
        if motion.rolling_speed <= TURNS * motion.speed:
            continue
        end = min(start + phase.duration, float(result.times[-1]))
        first, last = (int(np.searchsorted(result.times, t - 1e-6)) for t in (start, end))
        heat = result.generated(last)[0] - result.generated(first)[0]
        best = max(best, (heat, last)) if best else (heat, last)
    return None if best is None else best[1]


def rolling_resistance(result: Rolled) -> RollingResistance:
    """Force, N, and coefficient at the `rolling_reading`."""
    i = rolling_reading(result)
    if i is None:
        return RollingResistance("", 0.0, 0.0, 0.0, 0.0)
    t, drive, tyre = just_before(result.times, i), result.tyre.drive, result.tyre
    phase = drive.phases[drive.locate(t)[0]].name
    speed, load = tyre.motion(t).speed, float(tyre.schedule.mean(lambda case: case.load, t))
    force, cold = result.generated(i)[1] / speed, result.cold_power(t) / speed
    return RollingResistance(phase, force, force / load, cold, cold / load)


def just_before(times: Array, i: int) -> float:
    """A time just before ``times[i]``, which at the end of a phase is still in that phase."""
    t = float(times[i])
    return t - 1e-9 * max(t, 1.0) if i else t
