"""The simulated phases of a drive, and warnings of phases outside the range of the assumptions."""

from __future__ import annotations

import functools
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tyrefem.geometry import Section
    from tyrefem.simulation.rolling_tyre import RollingTyre


@dataclass(frozen=True)
class PhaseState:
    """A simulated phase of the drive; mechanical quantities are at its end. SI units, degC."""

    name: str
    start: float
    end: float
    speed: float
    load: float
    pressure: float
    deflection: float
    rolling_radius: float
    footprint_length: float
    #: Area of rubber in contact, m2; None if the strain law does not press the tyre on the road.
    footprint_area: float | None
    road_fraction: float
    road_film: float
    air_film: float
    #: Penetration depth of one contact in the tread, m (Cattani et al. 2023, eq 8).
    propagation_depth: float
    #: Speed of the tread over the road; 0 without slip.
    sliding_speed: float
    #: True if the wheel is locked during the whole phase.
    locked: bool


def phase_states(tyre: RollingTyre) -> tuple[PhaseState, ...]:
    """Every phase of a tyre's drive."""
    drive, states = tyre.drive, []
    for start, phase in zip(drive.starts, drive.phases, strict=True):
        end = start + phase.duration
        t = end * (1 - 1e-12)
        mean, motion = functools.partial(tyre.schedule.mean, time=t), tyre.motion(t)
        states.append(
            PhaseState(
                phase.name,
                start,
                end,
                motion.speed,
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
                tyre.sliding.sliding_speed(t),
                drive.locked_since(t) is not None,
            )
        )
    return tuple(states)


#: Largest penetration depth without a warning, as a share of the tread's thickness at the crown (a judgement).
SHALLOW = 0.2


def deep_contacts(section: Section, phases: Iterable[PhaseState]) -> tuple[str, ...]:
    """A warning for every phase in which the penetration depth is too large for an averaged film."""
    tread = float(section.layers[-1].thickness(0.0))
    return tuple(
        f"phase '{state.name}': one contact cools the tread {state.propagation_depth * 1e3:.2g} mm deep, "
        f"{100 * state.propagation_depth / tread:.0f} % of its thickness at the crown; a film averaged over "
        f"the revolution is valid below {100 * SHALLOW:.0f} %"
        for state in phases
        if state.propagation_depth > SHALLOW * tread
    )
