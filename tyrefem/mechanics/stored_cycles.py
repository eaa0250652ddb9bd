"""Strain cycles as plain data and arrays, and back.

A cycle by finite elements is stored as its energies at the Gauss points, with the numbers of its footprint; its tyre
is solved again when someone needs more. Any other cycle is quick, and is computed again from its load case.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields, replace
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.inputs.loading import LoadCase, PressedContact
from tyrefem.inputs.wheel_state import WheelState
from tyrefem.mechanics.cycle_schedule import CycleSchedule
from tyrefem.mechanics.footprint.strain_harmonics import LinearisationError
from tyrefem.mechanics.point_energies import GaussPoints, PointEnergies
from tyrefem.mechanics.rolling.friction_rings import FrictionRings
from tyrefem.mechanics.solved_cases import KnotSolver
from tyrefem.mechanics.strain_cycle import Zone

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.mechanics.strain_cycle import StrainCycle

Array = NDArray[np.float64]
Arrays = dict[str, NDArray[Any]]


@dataclass(frozen=True)
class FootprintNumbers:
    """Numbers of a footprint, SI: as the properties of `tyrefem.mechanics.footprint.footprint.Footprint`."""

    motion: str
    load: float
    deflection: float
    stiffness: float
    length: float
    width: float
    area: float
    rolling_radius: float
    harmonics: int
    contact_harmonics: int
    error: float


class PressedCycle(Protocol):
    """A strain cycle of a tyre on the road: by finite elements, or stored."""

    @property
    def footprint(self) -> Any:
        """The footprint, or its numbers; None without load."""

    @property
    def linearisation_error(self) -> LinearisationError | None:
        """What linear strains leave out; None without load."""


@dataclass(frozen=True, eq=False)
class StoredCycle(Brief):
    """A strain cycle by finite elements that was stored.

    Parameters
    ----------
    energies : at the Gauss points. footprint : its numbers; None: no load.
    linearisation_error : of a linear footprint. study, phase, case, warmth : from which it was computed.
    """

    energies: PointEnergies
    footprint: FootprintNumbers | None
    linearisation_error: LinearisationError | None
    study: StudyData
    phase: int
    case: LoadCase
    warmth: Mapping[str, float] | None

    @property
    def zones(self) -> tuple[Zone, ...]:
        """The regions."""
        return self.energies.zones

    @property
    def friction(self) -> FrictionRings | None:
        """Friction of the tread's rings; None: the tyre does not roll with friction."""
        return self.energies.friction

    def energy_density(self, zone: str, points: Array) -> Array:
        """U, J/m3, at points (2, n) in (r, z) of a region of the undeformed section."""
        return self.energies.energy_density(zone, points)

    def spectrum(self, zone: str, points: Array) -> Array:
        """(orders, n) U, J/m3, at points (2, n) by `strain_cycle.ORDERS`."""
        return self.energies.spectrum(zone, points)

    def solve(self) -> StrainCycle:
        """The strain cycle, solved again."""
        return _solver(self.study, self.warmth).cycle(self.phase, self.case)


def solved(schedule: CycleSchedule) -> CycleSchedule:
    """The schedule with stored cycles solved again: with inflated tyre and footprint."""
    if not any(isinstance(cycle, StoredCycle) for cycles in schedule.cycles for cycle in cycles):
        return schedule
    cycles = tuple(
        tuple(cycle.solve() if isinstance(cycle, StoredCycle) else cycle for cycle in each) for each in schedule.cycles
    )
    return replace(schedule, cycles=cycles)


def stored(schedule: CycleSchedule) -> tuple[dict[str, Any], Arrays]:
    """Plain data and arrays of a schedule; the study is stored with them, elsewhere."""
    arrays: Arrays = {}
    names: dict[int, str] = {}
    places = [(phase, knot) for phase, cycles in enumerate(schedule.cycles) for knot in range(len(cycles))]
    entries = []
    for phase, knot in places:
        case, cycle = schedule.cases[phase][knot], schedule.cycles[phase][knot]
        warmth = schedule.warmth[phase][knot] if schedule.warmth else None
        entries.append(
            {
                "load": case.load,
                "deflection": case.deflection,
                "pressure": case.pressure,
                "wheel": None if case.wheel is None else asdict(case.wheel),
                "contact": None if case.contact is None else asdict(case.contact),
                "warmth": None if warmth is None else dict(warmth),
                **_elements(cycle, names.setdefault(id(cycle), f"cycle-{phase}-{knot}"), arrays),
            }
        )
    return {"knots": [list(knots) for knots in schedule.knots], "cycles": entries}, arrays


def _elements(cycle: Any, name: str, arrays: Arrays) -> dict[str, Any]:
    """What is stored of a cycle by finite elements; nothing of another."""
    energies = getattr(cycle, "energies", cycle)
    if not isinstance(energies, PointEnergies):
        return {}
    points = energies.points
    if f"{name}-densities" not in arrays:
        arrays[f"{name}-densities"] = energies.densities
    if not any(key.startswith("gauss-") for key in arrays):
        # All cycles of a study have the same mesh.
        arrays["gauss-points"] = points.points
        arrays |= {f"gauss-{zone.region}": np.asarray(points.members[zone.region]) for zone in energies.zones}
    footprint = getattr(cycle, "footprint", None)
    if (rings := energies.friction) is not None:
        arrays |= {f"{name}-ring-{field.name}": np.asarray(getattr(rings, field.name)) for field in fields(rings)}
    linear = footprint is not None and footprint.motion == "linear" and cycle.linearisation_error is not None
    return {
        "arrays": name,
        "zones": [asdict(zone) for zone in energies.zones],
        "footprint": None
        if footprint is None
        else {field.name: getattr(footprint, field.name) for field in fields(FootprintNumbers)},
        "linearisation_error": asdict(cycle.linearisation_error) if linear else None,
    }


def restored(study: StudyData, data: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]]) -> CycleSchedule:
    """The schedule of a study from what `stored` gave."""
    knots = tuple(tuple(map(float, each)) for each in data["knots"])
    entries = iter(data["cycles"])
    cases, cycles, warmths = [], [], []
    for phase, fractions in enumerate(knots):
        solved_here = [_cycle(study, phase, fraction, next(entries), arrays) for fraction in fractions]
        cases.append(tuple(case for case, _, _ in solved_here))
        cycles.append(tuple(cycle for _, cycle, _ in solved_here))
        warmths.append(tuple(warmth for _, _, warmth in solved_here))
    return CycleSchedule(study.card.drive, knots, tuple(cases), tuple(cycles), tuple(warmths))


def _cycle(
    study: StudyData, phase: int, fraction: float, entry: Mapping[str, Any], arrays: Mapping[str, Any]
) -> tuple[LoadCase, StrainCycle, Mapping[str, float] | None]:
    contact, warmth = entry["contact"], entry["warmth"]
    solver = _solver(study, warmth)
    wheel = None if entry["wheel"] is None else WheelState(**entry["wheel"])
    driven = replace(solver.case(phase, fraction), pressure=entry["pressure"], wheel=wheel)
    case = replace(
        driven,
        load=entry["load"],
        deflection=entry["deflection"],
        contact=None if contact is None else PressedContact(**contact),
    )
    if "zones" not in entry:
        return case, solver.cycle(phase, case), warmth
    name = entry["arrays"]
    members = {zone["region"]: arrays[f"gauss-{zone['region']}"] for zone in entry["zones"]}
    rings = {field.name: arrays.get(f"{name}-ring-{field.name}") for field in fields(FrictionRings)}
    energies = PointEnergies(
        tuple(Zone(**zone) for zone in entry["zones"]),
        GaussPoints(arrays["gauss-points"], members),
        arrays[f"{name}-densities"],
        None if rings["work"] is None else FrictionRings(**{key: _number(value) for key, value in rings.items()}),
    )
    footprint, error = entry["footprint"], entry["linearisation_error"]
    cycle = StoredCycle(
        energies,
        None if footprint is None else FootprintNumbers(**footprint),
        None if error is None else LinearisationError(**error),
        study,
        phase,
        driven,
        warmth,
    )
    return case, cycle, warmth


def _number(value: Any) -> Any:
    return value if value.ndim else float(value)


def _solver(study: StudyData, warmth: Mapping[str, float] | None) -> KnotSolver:
    return KnotSolver(study if warmth is None else study.warmed(warmth))
