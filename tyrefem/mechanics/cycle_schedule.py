"""From a study's cards to its strain cycles: stiffness of the parts, load cases of the drive."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.boundaries.contained_air import ATMOSPHERE
from tyrefem.brief import Brief, PickledFields
from tyrefem.errors import InputError
from tyrefem.inputs.drive import Drive
from tyrefem.inputs.loading import GivenFootprint, LoadCase, TrR64, load_case
from tyrefem.inputs.motion import WheelMotion, motion_in
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.wheel_state import wheel_state
from tyrefem.materials.reads import ARCS, FEM_ROLLING, values_read
from tyrefem.mechanics.arc_geometry import BiasPlies
from tyrefem.mechanics.arcs import ArcStiffness
from tyrefem.mechanics.finite_elements import FiniteElements
from tyrefem.mechanics.strain_cycle import StrainCycle, solved_case
from tyrefem.mechanics.strain_laws import strain_law

if TYPE_CHECKING:
    from tyrefem.geometry import Section

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


def warming_knots(count: int) -> Sequence[float]:
    """Fractions of a phase at which strain cycles follow the temperature: closer at its start, where it changes fast.

    >>> warming_knots(5)
    (0.0, 0.0625, 0.25, 0.5625, 1.0)
    """
    return tuple(float(x) for x in np.linspace(0.0, 1.0, count) ** 2)


def ramp_knots(changes: bool, count: int = 9) -> Sequence[float]:
    """Fractions of a phase at which load cases are solved: the start alone, or ``count`` where the load changes.

    Nine give up to 0.8 % too much heat in a ramp from no load: h^2/2 with h = 1/8, where U goes with the square of the
    load; 0.2 % in a ramp from half the load to 1.25 times it. The arcs of the 8PR: 0.3 % up to the rated load.
    """
    return tuple(np.linspace(0.0, 1.0, count)) if changes else (0.0,)


#: Regions of the sections to which the report's arcs apply.
ARC_REGIONS = tuple(ARCS)


def stiffness(study: StudyData) -> ArcStiffness:
    """Stiffness values of the material cards from which the arcs compute strain energy, SI.

    Raises
    ------
    InputError : a card lacks a modulus or an angle that the law needs.
    """
    section = study.section
    for region in ARC_REGIONS:
        if region not in section.regions:
            message = (
                f"the strain law 'arcs' needs the region '{region}', which section '{section.name}' does not have;"
                ' other constructions take strain = "given"'
            )
            raise InputError(message, field="mechanics.strain", file=study.file)
    cord = study.materials["carcass"].cord
    mechanics, rating = study.card.mechanics, section.rating
    if rating is None:
        raise InputError("the strain law 'arcs' needs the section's [rating]", field="section.rating")
    if cord is None or cord.ply_shear_modulus is None:
        raise InputError("the carcass card needs 'cord.ply_shear_modulus'", field="materials.carcass.cord")
    angle = rating.cord_angle or cord.crown_angle
    if not angle:
        raise InputError("neither the section nor the carcass card gives the crown cord angle", field="section")
    return ArcStiffness(
        BiasPlies(_modulus(study, "carcass", "shear_modulus"), angle, _crown_radius(section), mechanics.poisson_term),
        cord.ply_shear_modulus if mechanics.membrane_shear else np.inf,
        _modulus(study, "tread", "shear_modulus"),
        _modulus(study, "sidewall", "shear_modulus"),
        _modulus(study, "bead", "youngs_modulus"),
        rating.bead_area,
    )


@functools.lru_cache(maxsize=32)
def _crown_radius(section: Section) -> float:
    """Distance of the meridian from the wheel's axis at the crown, m. The values of the 32 latest sections are kept."""
    return float(section.line.position(np.zeros(1))[0, 0])


def _modulus(study: StudyData, region: str, name: str) -> float:
    modulus = getattr(study.materials[region], name)
    if modulus is None:
        raise InputError(f"the card of region '{region}' needs '{name}'", field=f"materials.{region}.{name}")
    return float(modulus.value)


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


def changes_cycle(study: StudyData, number: int) -> bool:
    """True if the strain cycle changes during a phase: load, deflection, pressure, a turning tyre's speed, or slip,
    torque, slip angle and camber with friction."""
    phase = study.card.drive.phases[number]
    if phase.changes_load:
        return True
    if study.card.boundaries.sliding.rolls and wheel_state(phase, 0.0) != wheel_state(phase, 1.0):
        return True
    return _speed_matters(study) and motion_in(phase, 0.0).rolling_speed != motion_in(phase, 1.0).rolling_speed


def _speed_matters(study: StudyData) -> bool:
    """True if the strain cycle depends on the speed: by inertia and loss, or by friction."""
    if study.card.mechanics.rolling:
        return True
    laws = (card.friction for card in study.materials.values())
    return study.card.boundaries.sliding.rolls and any(law is not None and law.depends_on_speed for law in laws)


def check_cases(study: StudyData) -> None:
    """Raise an error for loads and deflections that the section cannot take, by checks without finite elements.

    Raises
    ------
    InputError : the message names the phase.
    """
    solver, cheap = KnotSolver(study), not strain_law(study).by_elements
    for number, _ in enumerate(study.card.drive.phases):
        for fraction in ramp_knots(changes_cycle(study, number)):
            case = solver.case(number, fraction)
            if cheap:
                solver.cycle(number, case)


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


def rated_case(study: StudyData) -> LoadCase:
    """The load case of the section's rated load and pressure on a flat road, with the strain law's contact.

    Raises
    ------
    InputError : no rating; a rated load that the tyre cannot carry.
    """
    rating, mechanics = study.section.rating, study.card.mechanics
    if rating is None:
        raise InputError("the rated deflection needs the section's [rating]", field="section.rating", file=study.file)
    radius, footprint = study.section.outer_diameter / 2, mechanics.footprint
    law = None if strain_law(study).presses else mechanics.load_law
    case = load_case(law, rating, outer_radius=radius, pressure=rating.pressure, load=rating.load, footprint=footprint)
    if law is not None:
        return case
    try:
        return solved_case(strain_law(study).provider(study)(case), case)
    except InputError as error:
        raise error.within(field="section.rating", file=study.file) from None


class KnotSolver:
    """Load case and strain cycle at one point of a study's drive."""

    def __init__(self, study: StudyData) -> None:
        _check_footprint(study)
        self.study = study
        if not strain_law(study).by_elements:
            _ = self._cycle
        _check_rating(study)

    @functools.cached_property
    def _cycle(self) -> Callable[..., StrainCycle]:
        provider: Callable[..., StrainCycle] = strain_law(self.study).provider(self.study)
        return provider

    def case(self, number: int, fraction: float, pressure_ratio: float = 1.0) -> LoadCase:
        """The load case at a fraction of a driven phase; ``pressure_ratio``: absolute pressure over that of the drive.

        Raises
        ------
        InputError : a load or deflection that the section cannot take; the message names the phase.
        """
        try:
            return _load_case(self.study, number, fraction, pressure_ratio)
        except InputError as error:
            raise self._placed(error, number) from None

    def cycle(self, number: int, case: LoadCase, near: StrainCycle | None = None) -> StrainCycle:
        """The strain cycle of a load case of a phase; raises the same errors as `case`. ``near``: a nearby cycle to
        start from, if it is a footprint."""
        try:
            return self._cycle(case, near) if isinstance(near, FiniteElements) else self._cycle(case)
        except InputError as error:
            raise self._placed(error, number) from None

    def solve(self, number: int, fraction: float) -> tuple[LoadCase, StrainCycle]:
        """Load case, with the contact that the strain law computes, and strain cycle at the drive's pressure."""
        case = self.case(number, fraction)
        cycle = self.cycle(number, case)
        return solved_case(cycle, case), cycle

    def _placed(self, error: InputError, number: int) -> InputError:
        """The error with its phase, unless it is of another file or of another table of the study, as ``mesh.cell``."""
        table = (error.field or "").partition(".")[0]
        if error.file or table in type(self.study.card).model_fields:
            return error.within(file=self.study.file)
        name = self.study.card.drive.phases[number].name
        return self.study.as_written(error.within(field=f"drive.phases.{name}", file=self.study.file))


def _check_rating(study: StudyData) -> None:
    law = study.card.mechanics.load_law
    if study.section.rating is None and isinstance(law, TrR64) and not strain_law(study).presses:
        message = f"the load-deflection law '{law.law}' needs the section's [rating]"
        raise InputError(message, field="section.rating", file=study.file)


def _check_footprint(study: StudyData) -> None:
    law, diameter = study.card.mechanics.footprint, study.section.outer_diameter
    if isinstance(law, GivenFootprint) and law.length >= diameter:
        message = (
            f"{law.length * 1e3:.4g} mm is too long; must be less than the tyre's diameter, {diameter * 1e3:.4g} mm"
        )
        raise InputError(message, field="mechanics.footprint.length", file=study.file)


def _load_case(study: StudyData, number: int, fraction: float, pressure_ratio: float = 1.0) -> LoadCase:
    phase, section = study.card.drive.phases[number], study.section
    pressure = phase.pressure.at(fraction)
    # In this form a ratio of 1 leaves the pressure unchanged to the last bit.
    pressure = pressure + (pressure + ATMOSPHERE) * (pressure_ratio - 1)
    mechanics = study.card.mechanics
    case = load_case(
        None if strain_law(study).presses else mechanics.load_law,
        section.rating,
        outer_radius=section.outer_diameter / 2,
        pressure=pressure,
        load=None if phase.load is None else phase.load.at(fraction),
        deflection=None if phase.deflection is None else phase.deflection.at(fraction),
        drum_diameter=phase.drum_diameter,
        footprint=mechanics.footprint,
    )
    if _speed_matters(study):
        case = replace(case, speed=motion_in(phase, fraction).rolling_speed)
    if study.card.boundaries.sliding.rolls and not phase.stands:
        case = replace(case, wheel=wheel_state(phase, fraction))
    return case
