"""From a study's cards to its strain cycles: stiffness of the parts, load cases of the drive."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tyrefem.errors import InputError
from tyrefem.footprint import GivenFootprint
from tyrefem.heating import CycleSchedule, ramp_knots
from tyrefem.loading import LoadCase, load_case
from tyrefem.strain import StrainCycle
from tyrefem.strain.arcs import Arcs, Stiffness
from tyrefem.strain.cord_rubber import BiasPlies
from tyrefem.strain.given import Given
from tyrefem.studies import Study


def stiffness(study: Study) -> Stiffness:
    """What the strain energy of the arcs needs of the cards, SI.

    Raises
    ------
    InputError : a card lacks a modulus or an angle that the law needs.
    """
    section = study.section
    for region in ("carcass", "tread", "sidewall", "bead"):
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
    crown_radius = float(section.line.position(np.zeros(1))[0, 0])
    return Stiffness(
        BiasPlies(_modulus(study, "carcass", "shear_modulus"), angle, crown_radius, mechanics.poisson_term),
        cord.ply_shear_modulus if mechanics.membrane_shear else np.inf,
        _modulus(study, "tread", "shear_modulus"),
        _modulus(study, "sidewall", "shear_modulus"),
        _modulus(study, "bead", "youngs_modulus"),
        rating.bead_area,
    )


def _modulus(study: Study, region: str, name: str) -> float:
    modulus = getattr(study.materials[region], name)
    if modulus is None:
        raise InputError(f"the card of region '{region}' needs '{name}'", field=f"materials.{region}.{name}")
    return float(modulus.value)


def cycle_schedule(study: Study) -> CycleSchedule:
    """Load cases and strain cycles of every phase of the drive.

    Raises
    ------
    InputError : a load or deflection that the section cannot take; names the phase.
    """
    _check_footprint(study)
    cycle = _provider(study)
    knots, cases, cycles = [], [], []
    for number, phase in enumerate(study.card.drive.phases):
        fractions = tuple(ramp_knots(phase.changes_load))
        try:
            phase_cases = tuple(_load_case(study, number, fraction) for fraction in fractions)
            phase_cycles = tuple(cycle(case) for case in phase_cases)
        except InputError as error:
            placed = error.within(field=f"drive.phases.{phase.name}", file=study.file)
            raise study.as_written(placed) from None
        knots.append(fractions)
        cases.append(phase_cases)
        cycles.append(phase_cycles)
    return CycleSchedule(study.card.drive, tuple(knots), tuple(cases), tuple(cycles))


def _provider(study: Study) -> Callable[[LoadCase], StrainCycle]:
    """The study's strain law: from a load case to its strain cycle."""
    if study.card.mechanics.strain == "given":
        return _given(study)
    if study.card.mechanics.strain == "fem":
        from tyrefem.strain import fem

        return fem.provider(study)
    moduli = stiffness(study)
    return lambda case: _cycle(study, moduli, case)


def _given(study: Study) -> Callable[[LoadCase], StrainCycle]:
    section, energy = study.section, study.card.mechanics.energy
    assert energy is not None
    if section.rating is None:
        raise InputError("the strain law 'given' needs the section's [rating]", field="section.rating")
    deflection = study.card.mechanics.load_law.deflection(energy.load, energy.pressure, section.rating)
    return lambda case: Given(section, energy.regions, deflection, case)


def _check_footprint(study: Study) -> None:
    law, diameter = study.card.mechanics.footprint, study.section.outer_diameter
    if isinstance(law, GivenFootprint) and law.length >= diameter:
        message = (
            f"{law.length * 1e3:.4g} mm is too long; must be less than the tyre's diameter, {diameter * 1e3:.4g} mm"
        )
        raise InputError(message, field="mechanics.footprint.length", file=study.file)


def _cycle(study: Study, moduli: Stiffness, case: LoadCase) -> Arcs:
    cycle = Arcs(study.section, moduli, case)
    try:
        _ = cycle.deflected if case.deflection > 0 else None
    except InputError as error:
        given = f"{case.load:.4g} N at {case.pressure / 1e3:.4g} kPa: {error.message}"
        raise InputError(given, field=error.field) from None
    return cycle


def _load_case(study: Study, number: int, fraction: float) -> LoadCase:
    phase, section = study.card.drive.phases[number], study.section
    assert section.rating is not None
    return load_case(
        study.card.mechanics.load_law,
        section.rating,
        outer_radius=section.outer_diameter / 2,
        pressure=phase.pressure.at(fraction),
        load=None if phase.load is None else phase.load.at(fraction),
        deflection=None if phase.deflection is None else phase.deflection.at(fraction),
        drum_diameter=phase.drum_diameter,
        footprint=study.card.mechanics.footprint,
    )
