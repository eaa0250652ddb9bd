"""Wear of a tread over a drive whose phases roll with friction."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import read_only
from tyrefem.errors import InputError
from tyrefem.materials.wear import Wear
from tyrefem.mechanics.cycle_schedule import CycleSchedule, cycle_schedule
from tyrefem.simulation.run import run
from tyrefem.wear.ring_wear import RingWear, rubber_share, tread_table

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.rolling.friction_rings import FrictionRings

Array = NDArray[np.float64]
#: Intervals of a phase; speed and state of each are those of its middle.
INTERVALS = 32


@dataclass(frozen=True, eq=False)
class DriveWear(RingWear):
    """Mean wear of the rings over a drive, by distance: sum of share_i times depth per km of state i.

    Rolling without load wears nothing; its distance counts. ``power`` is the mean over the time, ``travel`` that of a
    revolution under load, ``spin`` such that ``travel`` fits the speed.

    Parameters
    ----------
    states : wear in each solved state. shares : (states,) of the drive's distance, less than 1 in all where it also
        rolls without load. distance : m, of the drive.
    by_phase : name -> (distance, m; friction work, J; mean depth per km, m).
    """

    states: tuple[RingWear, ...] = ()
    shares: Array = field(default_factory=lambda: np.ones(0))
    distance: float = 0.0
    by_phase: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)

    @functools.cached_property
    def depth_per_km(self) -> Array:
        """(m,) depth worn per kilometre, m."""
        return read_only(sum(share * state.depth_per_km for share, state in zip(self.shares, self.states, strict=True)))


def _schedule(study: StudyData) -> CycleSchedule:
    """Strain cycles of the drive; with feedback those at the temperatures of its run."""
    return cycle_schedule(study) if study.card.mechanics.feedback is None else run(study).tyre.schedule


def drive_wear(study: StudyData) -> DriveWear:
    """Wear of a study's tread over its drive, from the friction work of the rings in every phase.

    Raises
    ------
    InputError : errors of `tread_table`; a law of sliding other than ``rolling``; a drive that does not roll.
    """
    table = tread_table(study)
    if not study.card.boundaries.sliding.rolls:
        message = "the wear of a drive needs boundaries.sliding = 'rolling'"
        raise InputError(message, field="boundaries.sliding", file=study.file)
    schedule = _schedule(study)
    distances, unloaded = _distances(schedule)
    loaded = sum(distances.values())
    if not loaded > 0:
        raise InputError("the tyre never rolls under load: no wear", field="drive", file=study.file)
    rings = {place: _rings(schedule, place) for place in distances}
    rubber = rubber_share(study)
    states = {place: _state(friction, table, rubber) for place, friction in rings.items()}
    by_phase = {}
    for number, phase in enumerate(study.card.drive.phases):
        ours = {place: distance for place, distance in distances.items() if place[0] == number}
        way = sum(ours.values()) + unloaded.get(number, 0.0)
        if way > 0:
            work = sum(distance * rings[place].total for place, distance in ours.items())
            depth = sum(distance * states[place].mean for place, distance in ours.items()) / way
            by_phase[phase.name] = (way, work, depth)
    total = loaded + sum(unloaded.values())
    shares = np.array([distance / total for distance in distances.values()])
    first = next(iter(states.values()))
    travel = loaded / sum(distance / states[place].travel for place, distance in distances.items())
    work_per_metre = np.sum(
        [share * friction.work for share, friction in zip(shares, rings.values(), strict=True)], axis=0
    )
    speed = total / study.card.drive.end
    return DriveWear(
        first.places, first.widths, work_per_metre * speed, 2 * np.pi * speed / travel, travel, table,
        rubber, tuple(states.values()), shares, total, by_phase,
    )  # fmt: skip


def _distances(schedule: CycleSchedule) -> tuple[dict[tuple[int, int], float], dict[int, float]]:
    """(phase, knot) of a state with friction -> m that the wheel travels in it, shared between two in a ramp; phase ->
    m that it rolls without load."""
    distances: dict[tuple[int, int], float] = {}
    unloaded: dict[int, float] = {}
    for start, phase in zip(schedule.drive.starts, schedule.drive.phases, strict=True):
        step = phase.duration / INTERVALS
        for time in start + step * (np.arange(INTERVALS) + 0.5):
            way = schedule.motion(float(time)).speed * step
            for number, knot, weight in schedule.weights(float(time)):
                if not way * weight > 0:
                    continue
                if _friction(schedule, (number, knot)) is not None:
                    distances[number, knot] = distances.get((number, knot), 0.0) + way * weight
                elif getattr(schedule.cycles[number][knot], "footprint", None) is None:
                    unloaded[number] = unloaded.get(number, 0.0) + way * weight
    return distances, unloaded


def _friction(schedule: CycleSchedule, place: tuple[int, int]) -> FrictionRings | None:
    cycle: Any = schedule.cycles[place[0]][place[1]]
    return getattr(cycle, "friction", None)


def _rings(schedule: CycleSchedule, place: tuple[int, int]) -> FrictionRings:
    friction = _friction(schedule, place)
    assert friction is not None
    return friction


def _state(friction: FrictionRings, table: Wear, rubber: float) -> RingWear:
    """Wear of a state at 1 m/s: the energy of a passing does not depend on the speed."""
    travel = friction.travel
    return RingWear(friction.places, friction.widths, friction.work, 1 / travel, 2 * np.pi * travel, table, rubber)
