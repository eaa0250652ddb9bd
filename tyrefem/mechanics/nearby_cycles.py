"""Strain cycles of studies near a solved one: interpolated from one further solution per changed number."""

from __future__ import annotations

import functools
import hashlib
import math
import re
from collections.abc import Callable
from dataclasses import astuple, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.inputs.loading import LoadCase, PressedContact
from tyrefem.inputs.uncertain_numbers import UncertainNumber, written_at
from tyrefem.mechanics.cycle_schedule import CycleSchedule, KnotSolver, cycle_schedule, same_cycles
from tyrefem.mechanics.finite_elements import PointEnergies
from tyrefem.mechanics.rolling.friction_rings import CHANGING
from tyrefem.mechanics.strain_cycle import solved_case
from tyrefem.output import atomic_path

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData

_AMOUNT = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$", re.DOTALL)
Solved = tuple[LoadCase, PointEnergies]


@dataclass(frozen=True, eq=False)
class SolvedCycles:
    """Solved load cases and their energies by name, in memory and in a folder that several processes share."""

    folder: Path | None = None
    known: dict[str, Solved] = field(default_factory=dict)

    def get(self, name: str, like: PointEnergies, solve: Callable[[], Solved]) -> Solved:
        """The stored solution of a name, or else a new one from ``solve``; ``like``: energies at the same points."""
        if name not in self.known:
            self.known[name] = self._read(name, like) or self._store(name, solve())
        return self.known[name]

    def _file(self, name: str) -> Path | None:
        return None if self.folder is None else self.folder / f"{hashlib.sha256(name.encode()).hexdigest()[:24]}.npz"

    def _read(self, name: str, like: PointEnergies) -> Solved | None:
        file = self._file(name)
        if file is None or not file.exists():
            return None
        with np.load(file, allow_pickle=False) as kept:
            (load, deflection, pressure, radius, drum), contact = kept["case"], kept["contact"]
            case = LoadCase(float(load), float(deflection), float(pressure), float(radius), float(drum))
            contact = PressedContact(*map(float, contact)) if len(contact) else None
            friction = like.friction
            if friction is not None:
                changed: dict[str, Any] = {
                    name: kept[name] if kept[name].ndim else float(kept[name]) for name in CHANGING
                }
                friction = replace(friction, **changed)
            return replace(case, contact=contact), replace(like, densities=kept["densities"], friction=friction)

    def _store(self, name: str, solved: Solved) -> Solved:
        file = self._file(name)
        if file is not None:
            case, energies = solved
            numbers = (case.load, case.deflection, case.pressure, case.outer_radius, case.drum_diameter)
            contact = () if case.contact is None else astuple(case.contact)
            with atomic_path(file) as temporary, temporary.open("wb") as stream:
                rings: dict[str, Any] = {}
                if (friction := energies.friction) is not None:
                    rings = {name: getattr(friction, name) for name in CHANGING}
                np.savez(stream, case=numbers, contact=contact, densities=energies.densities, **rings)
        return solved


@dataclass(frozen=True, eq=False)
class NearbyCycles:
    """Strain cycles by finite elements, linear in the logarithms of the numbers that they depend on.

    U(x) = U_0 + sum_i x_i / s_i (U_i - U_0). x_i is ln of a number's factor, U_i the solution at the factor 1 + sd, s_i
    its ln. Deflection, footprint and rolling radius are interpolated alike. The first change of a number costs one
    solution per load case.

    Parameters
    ----------
    study : with a strain law by finite elements. solved : studies that differ in their drives may share it.
    """

    study: StudyData
    solved: SolvedCycles = field(default_factory=SolvedCycles)

    @functools.cached_property
    def schedule(self) -> CycleSchedule:
        """The study's schedule."""
        return cycle_schedule(self.study)

    @functools.cached_property
    def numbers(self) -> tuple[UncertainNumber, ...]:
        """The study's uncertain numbers that its strain cycles depend on."""
        return tuple(
            number
            for number in self.study.uncertain_numbers
            if not number.idle and not same_cycles(self._raised(number), self.study)
        )

    def schedule_of(self, study: StudyData) -> CycleSchedule | None:
        """The strain cycles of another study; None if it differs in more than `numbers`.

        Raises
        ------
        InputError : a load, deflection or number that the tyre cannot take.
        """
        changes: list[tuple[str, float]] = []
        unchanged_numbers: dict[str, Any] = {}
        for number in self.numbers:
            if (factor := _factor(study, number)) != 1.0:
                changes.append((number.key, math.log(factor) / math.log1p(number.sd)))
                unchanged_numbers |= dict(zip(number.keys, number.written, strict=True))
        if not same_cycles(study.replace(unchanged_numbers, self.study), self.study):
            return None
        schedule, driven = self.schedule, KnotSolver(study)
        neighbours = [(self._neighbours[key], share) for key, share in changes]
        cases: list[tuple[LoadCase, ...]] = []
        cycles: list[tuple[PointEnergies, ...]] = []
        for phase, fractions in enumerate(schedule.knots):
            neighbours_at_knots = [
                [(neighbour[phase][knot], share) for neighbour, share in neighbours] for knot in range(len(fractions))
            ]
            cases.append(
                tuple(
                    _between(driven.case(phase, fraction), case, [(neighbour[0], share) for neighbour, share in at])
                    for fraction, case, at in zip(fractions, schedule.cases[phase], neighbours_at_knots, strict=True)
                )
            )
            cycles.append(
                tuple(
                    _energies(cycle).interpolated([(neighbour[1], share) for neighbour, share in at])
                    for cycle, at in zip(schedule.cycles[phase], neighbours_at_knots, strict=True)
                )
            )
        return CycleSchedule(study.card.drive, schedule.knots, tuple(cases), tuple(cycles))

    def _raised(self, number: UncertainNumber) -> StudyData:
        return self.study.replace(number.changes(1.0 + number.sd))

    @functools.cached_property
    def _neighbours(self) -> _Neighbours:
        return _Neighbours(self)


class _Neighbours(dict[str, list[list[Solved]]]):
    """Key of a number -> solutions by (phase, knot) with the number one standard deviation up, made when used."""

    def __init__(self, near: NearbyCycles) -> None:
        super().__init__()
        self.near = near

    def __missing__(self, key: str) -> list[list[Solved]]:
        near = self.near
        number = next(uncertain for uncertain in near.numbers if uncertain.key == key)
        solver, schedule = KnotSolver(near._raised(number)), near.schedule

        def solved(phase: int, knot: int) -> Solved:
            start = schedule.cycles[phase][knot]
            case, like = solver.case(phase, schedule.knots[phase][knot]), _energies(start)

            def solve() -> Solved:
                cycle = solver.cycle(phase, case, start)
                # Interpolated to the same points, so that the mesh of the other cycle need not be kept.
                energies = _energies(cycle)
                return solved_case(cycle, case), replace(like, densities=energies.densities, friction=energies.friction)

            return near.solved.get(f"{key} {case!r}", like, solve)

        self[key] = [[solved(phase, knot) for knot in range(len(knots))] for phase, knots in enumerate(schedule.knots)]
        return self[key]


def _energies(cycle: Any) -> PointEnergies:
    """The energies at Gauss points of a cycle by finite elements."""
    energies: PointEnergies = cycle.energies
    return energies


def _factor(study: StudyData, number: UncertainNumber) -> float:
    """The number in one study over that in another; 1: unchanged, or not comparable."""
    now, before = written_at(study, number.keys[0]), number.written[0]
    if now == before:
        return 1.0
    (now, unit), (before, other) = _amount(now), _amount(before)
    return now / before if unit == other and now > 0 and before > 0 else 1.0


def _amount(value: Any) -> tuple[float, str]:
    if isinstance(value, list):
        # The numbers of a table change by one factor: the last cell gives it.
        return _amount(value[-1])
    if isinstance(value, str):
        match = _AMOUNT.match(value)
        return (float(match[1]), match[2]) if match else (0.0, value)
    return float(value), ""


def _between(driven: LoadCase, case: LoadCase, others: list[tuple[LoadCase, float]]) -> LoadCase:
    """A driven load case whose computed contact is interpolated towards other load cases by their weights."""
    if case.contact is None:
        return driven

    def mean(value: Callable[[LoadCase], float]) -> float:
        return value(case) + sum(share * (value(neighbour) - value(case)) for neighbour, share in others)

    contact = PressedContact(
        mean(lambda neighbour: neighbour.footprint_length), mean(lambda neighbour: neighbour.footprint_area or 0.0),
        mean(lambda neighbour: neighbour.rolling_radius),
    )  # fmt: skip
    if driven.by_deflection:
        return replace(driven, load=mean(lambda neighbour: neighbour.load), contact=contact)
    return replace(driven, deflection=mean(lambda neighbour: neighbour.deflection), contact=contact)
