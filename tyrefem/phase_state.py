"""The phases of a drive as they were simulated."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tyrefem.rolling import RollingTyre


@dataclass(frozen=True)
class PhaseState:
    """A phase of the drive as it was simulated; mechanical quantities at its end. SI units, degC."""

    name: str
    start: float
    end: float
    speed: float
    load: float
    pressure: float
    deflection: float
    rolling_radius: float
    footprint_length: float
    #: Area of rubber in contact, m2; None where the strain law does not press the tyre on its road.
    footprint_area: float | None
    road_fraction: float
    road_film: float
    air_film: float
    #: Depth to which one contact cools the tread (Cattani et al. 2023, eq 8).
    propagation_depth: float
    #: Speed of the tread over the road; 0 without slip.
    sliding_speed: float
    #: Whether the wheel is locked all the time.
    locked: bool


def phase_states(tyre: RollingTyre) -> tuple[PhaseState, ...]:
    """Every phase of a tyre's drive."""
    drive, found = tyre.drive, []
    for start, phase in zip(drive.starts, drive.phases, strict=True):
        end = start + phase.duration
        t = end * (1 - 1e-12)
        mean = functools.partial(tyre.schedule.mean, time=t)
        found.append(
            PhaseState(
                phase.name,
                start,
                end,
                tyre.speed(t),
                mean(lambda case: case.load),
                mean(lambda case: case.pressure),
                mean(lambda case: case.deflection),
                mean(lambda case: case.rolling_radius),
                mean(lambda case: case.footprint_length),
                tyre.footprint_area(t),
                tyre.road_fraction(t),
                tyre.road_film(t) + tyre.sliding.skid_film(t),
                tyre.air_film(t),
                tyre.propagation_depth(t),
                drive.slip(t).sliding_speed,
                drive.locked_since(t) is not None,
            )
        )
    return tuple(found)
