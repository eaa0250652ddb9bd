"""The stiffness of the arcs' parts from a study's section and material cards."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

import numpy as np

from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.materials.reads import ARCS
from tyrefem.mechanics.arc_geometry import BiasPlies
from tyrefem.mechanics.arcs import ArcStiffness

if TYPE_CHECKING:
    from tyrefem.geometry import Section

#: Regions of the sections to which the report's arcs apply.
ARC_REGIONS = tuple(ARCS)


def arc_stiffness(study: StudyData) -> ArcStiffness:
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
