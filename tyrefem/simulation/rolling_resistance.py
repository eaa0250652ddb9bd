"""Rolling resistance from hysteresis, without the friction of sliding."""

from __future__ import annotations

from collections.abc import Sequence
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

    ``force`` and ``coefficient`` are at the end of ``phase``, the rolling phase with most heat, or at its last reading
    before the tyre comes to rest or leaves the road; ``cold_*`` at the same time with every point at the drive's
    initial temperature. All are zero if the tyre never rolls. With slip they are the hysteresis per metre of the road,
    without the friction.
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


@dataclass(frozen=True)
class RollingPhase:
    """A phase in which a loaded tyre rolls: its start and end, s; speed over the road, m/s, and load, N, at its end.

    ``stops``: the tyre is at rest, or off the road, at the end.
    """

    name: str
    start: float
    end: float
    speed: float
    load: float
    stops: bool = False


def rolling_phases(tyre: RollingTyre) -> tuple[RollingPhase, ...]:
    """The phases of a tyre's drive in which it rolls under load, in order."""
    phases, drive = [], tyre.drive
    for start, phase in zip(drive.starts, drive.phases, strict=True):
        end = start + phase.duration
        t = end * (1 - 1e-12)
        load = float(tyre.schedule.mean(lambda case: case.load, t))
        motion = tyre.motion(t)
        if load > 0 and motion.rolling_speed > TURNS * motion.speed:
            # Heat and load of the last instant, both next to nothing, are of slightly different times.
            stops = phase.stops or phase.unloads
            phases.append(RollingPhase(phase.name, start, end, motion.speed, load, stops))
    return tuple(phases)


def rolling_reading(result: Rolled) -> int | None:
    """Index of the last reading of the rolling phase with most heat, in which it still rolls under load.

    None if the tyre never rolls, or only in phases to rest or off the road without a reading before it.
    """
    best = _most_heat(result, rolling_phases(result.tyre))
    return None if best is None else best[0]


def _most_heat(result: Rolled, phases: Sequence[RollingPhase]) -> tuple[int, RollingPhase] | None:
    """The rolling phase with most heat, and its last reading in which the tyre rolls."""
    best: tuple[float, int] | None = None
    phase_of: dict[int, RollingPhase] = {}
    for phase in phases:
        if phase.start >= result.times[-1]:
            continue
        end = min(phase.end, float(result.times[-1]))
        first, last = (int(np.searchsorted(result.times, t - 1e-6)) for t in (phase.start, end))
        heat = result.generated(last)[0] - result.generated(first)[0]
        if phase.stops and end == phase.end:
            last -= 1
            if last == first:
                continue
        best, phase_of[last] = (max(best, (heat, last)) if best else (heat, last)), phase
    return None if best is None else (best[1], phase_of[best[1]])


def rolling_resistance(result: Rolled, phases: Sequence[RollingPhase] | None = None) -> RollingResistance:
    """Force, N, and coefficient at the `rolling_reading`; ``phases``: those that roll, if steady."""
    best = _most_heat(result, rolling_phases(result.tyre) if phases is None else phases)
    if best is None:
        return RollingResistance("", 0.0, 0.0, 0.0, 0.0)
    i, phase = best
    t = just_before(result.times, i)
    name, speed, load = phase.name, phase.speed, phase.load
    if phases is None:
        drive, tyre = result.tyre.drive, result.tyre
        name = drive.phases[drive.locate(t)[0]].name
        speed, load = tyre.motion(t).speed, float(tyre.schedule.mean(lambda case: case.load, t))
    force, cold = result.generated(i)[1] / speed, result.cold_power(t) / speed
    return RollingResistance(name, force, force / load, cold, cold / load)


def just_before(times: Array, i: int) -> float:
    """A time just before ``times[i]``, which at the end of a phase is still in that phase."""
    t = float(times[i])
    return t - 1e-9 * max(t, 1.0) if i else t
