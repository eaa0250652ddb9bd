"""Strain cycles of studies near a solved one: interpolated from one further solution per changed number."""

from __future__ import annotations

import functools
import hashlib
import math
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.errors import InputError
from tyrefem.inputs.loading import LoadCase, PressedContact
from tyrefem.inputs.uncertain_numbers import UncertainNumber, written_at
from tyrefem.mechanics.cycle_schedule import CycleSchedule, cycle_schedule, same_cycles
from tyrefem.mechanics.point_energies import PointEnergies, padded
from tyrefem.mechanics.rolling.friction_rings import CHANGING
from tyrefem.mechanics.solved_cases import KnotSolver
from tyrefem.mechanics.strain_cycle import solved_case
from tyrefem.mechanics.worn_sections import SectionWear
from tyrefem.output import atomic_path
from tyrefem.quantity import amount_parts

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData

Solved = tuple[LoadCase, PointEnergies]
#: Share of the largest density below which the ratio of two densities goes to 1.
LEAST_SHARE = 1e-4


@dataclass(frozen=True, eq=False)
class SolvedCycles:
    """Solved load cases and their energies by name, in memory and in a folder that several processes share."""

    folder: Path | None = None
    known: dict[str, Solved] = field(default_factory=dict)

    def get(self, name: str, like: PointEnergies, solve: Callable[[], Solved]) -> Solved:
        """The stored solution of a name, or else a new one from ``solve``; ``like``: energies of the same elements."""
        if name not in self.known:
            self.known[name] = self._read(name, like) or self._store(name, solve(), like)
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
            if "points" in kept:
                like = replace(like, points=replace(like.points, points=kept["points"]))
            friction = like.friction
            if friction is not None:
                changed: dict[str, Any] = {
                    name: kept[name] if kept[name].ndim else float(kept[name]) for name in CHANGING
                }
                friction = replace(friction, **changed)
            return replace(case, contact=contact), replace(like, densities=kept["densities"], friction=friction)

    def _store(self, name: str, solved: Solved, like: PointEnergies) -> Solved:
        file = self._file(name)
        if file is not None:
            case, energies = solved
            numbers = (case.load, case.deflection, case.pressure, case.outer_radius, case.drum_diameter)
            contact = () if case.contact is None else astuple(case.contact)
            with atomic_path(file) as temporary, temporary.open("wb") as stream:
                rings: dict[str, Any] = {}
                if (friction := energies.friction) is not None:
                    rings = {name: getattr(friction, name) for name in CHANGING}
                if energies.points is not like.points:
                    rings["points"] = energies.points.points
                np.savez(stream, case=numbers, contact=contact, densities=energies.densities, **rings)
        return solved


@dataclass(frozen=True, eq=False)
class NearbyCycles:
    """Strain cycles by finite elements, linear in the logarithms of the numbers that they depend on.

    U(x) = U_0 + sum_i x_i / s_i (U_i - U_0). x_i is ln of a number's factor, U_i the solution at the factor 1 + sd, s_i
    its ln. Deflection, footprint and rolling radius are interpolated alike. The first change of a number costs one
    solution per load case.

    A section that an effect wears has its own U_0, between amplitudes at which it is solved (`SectionWear.nodes`):
    point by point of elements that keep their number. There U(x) is times U_0 worn over U_0.

    Parameters
    ----------
    study : with a strain law by finite elements. solved : studies that differ in their drives may share it.
    known : the study's schedule; None: it is solved.
    """

    study: StudyData
    solved: SolvedCycles = field(default_factory=SolvedCycles)
    known: CycleSchedule | None = None

    @functools.cached_property
    def schedule(self) -> CycleSchedule:
        """The study's schedule."""
        return cycle_schedule(self.study) if self.known is None else self.known

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
        nodes = self._nodes(study.replace(unchanged_numbers, self.study))
        if nodes is None:
            return None
        neighbours = [(self._neighbours[key], share) for key, share in changes]
        schedule, driven = self.schedule, KnotSolver(study)
        cases: list[tuple[LoadCase, ...]] = []
        cycles: list[tuple[PointEnergies, ...]] = []
        for phase, fractions in enumerate(schedule.knots):
            of_phase = []
            for knot, fraction in enumerate(fractions):
                case, energies = schedule.cases[phase][knot], _energies(schedule.cycles[phase][knot])
                near = [(neighbour[phase][knot], share) for neighbour, share in neighbours]
                worn = [(node[phase][knot], weight) for node, weight in nodes]
                moved = energies.interpolated([(solved[1], share) for solved, share in near])
                if worn:
                    moved = _worn(moved, energies, [(solved[1], weight) for solved, weight in worn])
                cases_near = [(solved[0], share) for solved, share in (*near, *worn)]
                of_phase.append((_between(driven.case(phase, fraction), case, cases_near), moved))
            cases.append(tuple(case for case, _ in of_phase))
            cycles.append(tuple(energies for _, energies in of_phase))
        return CycleSchedule(study.card.drive, schedule.knots, tuple(cases), tuple(cycles))

    def _nodes(self, study: StudyData) -> list[tuple[list[list[Solved]], float]] | None:
        """Solutions of worn sections by (phase, knot), with their weights; none: the section is not worn.

        ``study``: with the numbers of this one. None if it differs in more than the wear of its section, if the tyre
        cannot be solved there, or if it rolls with friction.
        """
        if same_cycles(study, self.study):
            return []
        wear = SectionWear.of(study)
        frictional = any(_energies(cycle).friction is not None for cycles in self.schedule.cycles for cycle in cycles)
        if wear is None or frictional or not same_cycles(wear.at(study, 0), self.study):
            return None
        nodes = []
        for node, weight in wear.nodes.items():
            name = f"{wear.effect} {node}"
            if name not in self._worn_nodes:
                self._worn_nodes[name] = self._solved_node(name, self.study if node == 0 else wear.at(study, node))
            solved = self._worn_nodes[name]
            if solved is None:
                return None
            nodes.append((solved, weight))
        return nodes

    @functools.cached_property
    def _worn_nodes(self) -> dict[str, list[list[Solved]] | None]:
        return {}

    def _solved_node(self, name: str, study: StudyData) -> list[list[Solved]] | None:
        """A study with a worn section solved at every knot; None: it has other elements, or no equilibrium."""
        try:
            solved = self._solutions(name, KnotSolver(study), worn=True)
        except InputError:
            return None
        same = [
            cycle[1].densities.shape[1:] == _energies(self.schedule.cycles[phase][knot]).densities.shape[1:]
            for phase, cycles in enumerate(solved)
            for knot, cycle in enumerate(cycles)
        ]
        return solved if all(same) else None

    def _solutions(self, name: str, solver: KnotSolver, *, worn: bool = False) -> list[list[Solved]]:
        """Solutions by (phase, knot) of another study; ``worn``: its points have other places."""
        schedule = self.schedule

        def solved(phase: int, knot: int) -> Solved:
            start = schedule.cycles[phase][knot]
            case, like = solver.case(phase, schedule.knots[phase][knot]), _energies(start)

            def solve() -> Solved:
                cycle = solver.cycle(phase, case, None if worn else start)
                energies = _energies(cycle)
                # Kept at the points of this study, so that the mesh of the other cycle need not be kept.
                points = energies.points if worn else like.points
                kept = replace(like, points=points, densities=energies.densities, friction=energies.friction)
                return solved_case(cycle, case), kept

            return self.solved.get(f"{name} {case!r}", like, solve)

        return [[solved(phase, knot) for knot in range(len(knots))] for phase, knots in enumerate(schedule.knots)]

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
        number = next(uncertain for uncertain in self.near.numbers if uncertain.key == key)
        self[key] = self.near._solutions(key, KnotSolver(self.near._raised(number)))
        return self[key]


def _worn(moved: PointEnergies, energies: PointEnergies, nodes: Sequence[tuple[PointEnergies, float]]) -> PointEnergies:
    """The energies of a worn section: of its nodes, times what changed numbers make of the unworn one's.

    ``moved``, ``energies``: the unworn section with and without the changed numbers. ``nodes``: with their weights.
    """
    size = max(len(each.densities) for each in (moved, energies, *(node for node, _ in nodes)))
    weights = np.array([weight for _, weight in nodes])
    points = np.tensordot(weights, np.array([node.points.points for node, _ in nodes]), 1)
    densities = np.tensordot(weights, np.array([padded(node.densities, size) for node, _ in nodes]), 1)
    before, after = padded(energies.densities, size), padded(moved.densities, size)
    floor = LEAST_SHARE * before.max(axis=(1, 2), keepdims=True)
    factor = (after + floor) / np.where(floor > 0, before + floor, 1.0)
    worn = np.maximum(densities * np.where(floor > 0, factor, 1.0), 0.0)
    return replace(moved, points=replace(moved.points, points=points), densities=worn)


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
        amount = amount_parts(value)
        return (float(amount[0]), amount[1]) if amount else (0.0, value)
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
