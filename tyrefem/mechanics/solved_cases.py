"""Load cases of a study with their strain cycles: at the knots of its drive, and at its rated load."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from tyrefem.boundaries.contained_air import ATMOSPHERE
from tyrefem.errors import InputError
from tyrefem.inputs.loading import GivenFootprint, LoadCase, TrR64, check_drum, load_case
from tyrefem.inputs.motion import motion_in
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.wheel_state import wheel_state
from tyrefem.mechanics.finite_elements import FiniteElements
from tyrefem.mechanics.strain_cycle import StrainCycle, solved_case
from tyrefem.mechanics.strain_laws import strain_law


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
    check_drum(phase.drum_diameter, section.outer_diameter)
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
