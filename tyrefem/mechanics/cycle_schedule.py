"""The strain cycles of a drive over its phases."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from tyrefem.brief import Brief, PickledFields
from tyrefem.inputs.drive import Drive
from tyrefem.inputs.loading import LoadCase
from tyrefem.inputs.motion import WheelMotion
from tyrefem.inputs.study import StudyData
from tyrefem.materials.reads import FEM_ROLLING, values_read
from tyrefem.mechanics.solved_cases import KnotSolver, changes_cycle, ramp_knots
from tyrefem.mechanics.strain_cycle import StrainCycle
from tyrefem.mechanics.strain_laws import strain_law

#: Number of times whose weights a schedule keeps.
REMEMBERED = 512
#: (phase, knot, weight) of load cases that are mixed.
Weights = tuple[tuple[int, int, float], ...]


@dataclass(frozen=True, eq=False)
class CycleSchedule(Brief, PickledFields):
    """The strain cycles of a drive: for each phase the load cases at ``knots`` fractions of it.

    Between knots the strain energy is interpolated linearly in time. ``warmth``: mean temperatures of the regions for
    the moduli of every strain cycle, degC; None, or no entry at all: moduli as in the cards.
    """

    drive: Drive
    knots: tuple[tuple[float, ...], ...]
    cases: tuple[tuple[LoadCase, ...], ...]
    cycles: tuple[tuple[StrainCycle, ...], ...]
    warmth: tuple[tuple[Mapping[str, float] | None, ...], ...] = ()

    def weights(self, time: float) -> Weights:
        """(phase, knot, weight) of the load cases that are mixed at a time."""
        return self._weights(time)

    @functools.cached_property
    def _weights(self) -> Callable[[float], Weights]:
        """`weights` with a cache of the latest times: all zones and films use the same times."""
        return functools.lru_cache(REMEMBERED)(functools.partial(_weights, self.drive, self.knots))

    def moment(self, time: float) -> tuple[int, float]:
        """Phase, and the time in it, which is 0 where motion and strain cycle are constant within the phase."""
        return self._moment(time)

    @functools.cached_property
    def _moment(self) -> Callable[[float], tuple[int, float]]:
        pairs = zip(self.drive.phases, self.knots, strict=True)
        constant = tuple(phase.steady_motion and len(knots) == 1 for phase, knots in pairs)
        return functools.lru_cache(REMEMBERED)(functools.partial(_moment, self.drive, constant))

    def mean(self, quantity: Callable[[LoadCase], float], time: float) -> float:
        """A quantity of the load case at a time, e.g. its deflection."""
        return sum(weight * quantity(self.cases[phase][knot]) for phase, knot, weight in self.weights(time))

    @property
    def most_deflected(self) -> tuple[int, int]:
        """Phase and knot of the first load case with the largest deflection."""
        places = [(phase, knot) for phase, cases in enumerate(self.cases) for knot in range(len(cases))]
        return max(places, key=lambda place: self.cases[place[0]][place[1]].deflection)

    @property
    def zones(self) -> tuple[Any, ...]:
        """The strain provider's zones."""
        return self.cycles[0][0].zones

    def rolling_radius(self, time: float) -> float:
        """Rolling radius of the load case at a time, m."""
        return self.mean(_rolling_radius, time)

    @functools.cached_property
    def motion(self) -> WheelMotion:
        """Motion of the wheel as a function of time, with the rolling radius of the load cases at that time."""
        return WheelMotion(self.drive, self.rolling_radius)

    def revolutions_per_second(self, time: float) -> float:
        """Revolutions of the wheel per second, 1/s, at a time (s): those of `motion`, for effects."""
        return self.motion(time).revolutions_per_second


def _rolling_radius(case: LoadCase) -> float:
    return case.rolling_radius


def _moment(drive: Drive, constant: tuple[bool, ...], time: float) -> tuple[int, float]:
    phase, _ = drive.locate(time)
    return phase, 0.0 if constant[phase] else time


def _weights(drive: Drive, knots: tuple[tuple[float, ...], ...], time: float) -> Weights:
    phase, fraction = drive.locate(time)
    at = knots[phase]
    if len(at) == 1:
        return ((phase, 0, 1.0),)
    right = int(np.clip(np.searchsorted(at, fraction), 1, len(at) - 1))
    share = (fraction - at[right - 1]) / (at[right] - at[right - 1])
    return (phase, right - 1, 1 - share), (phase, right, share)


def cycle_schedule(study: StudyData) -> CycleSchedule:
    """Load cases and strain cycles of every phase of the drive.

    Raises
    ------
    InputError : a load or deflection that the section cannot take; the message names the phase.
    """
    solver = KnotSolver(study)
    knots, cases, cycles = [], [], []
    for number, _ in enumerate(study.card.drive.phases):
        fractions = tuple(ramp_knots(changes_cycle(study, number)))
        solved = [solver.solve(number, fraction) for fraction in fractions]
        knots.append(fractions)
        cases.append(tuple(case for case, _ in solved))
        cycles.append(tuple(cycle for _, cycle in solved))
    return CycleSchedule(study.card.drive, tuple(knots), tuple(cases), tuple(cycles))


def same_cycles(study: StudyData, other: StudyData) -> bool:
    """True if section, drive, mechanics, mesh and the material data that the strain law reads are equal."""
    if study.section != other.section:
        return False
    if any(study.data.get(table) != other.data.get(table) for table in ("drive", "mechanics")):
        return False
    law = strain_law(study)
    if law.by_elements and study.card.mesh != other.card.mesh:
        return False
    if study.card.boundaries.sliding.rolls or other.card.boundaries.sliding.rolls:
        laws = [
            (each.card.boundaries.sliding.rolls, *(card.friction for card in each.materials.values()))
            for each in (study, other)
        ]
        if laws[0] != laws[1]:
            return False
    reads = FEM_ROLLING if study.card.mechanics.rolling else law.name
    return values_read(reads, study.materials) == values_read(reads, other.materials)
