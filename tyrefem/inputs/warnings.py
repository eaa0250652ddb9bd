"""The warnings of a study, its section and its material cards, and of data for another tyre."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path

from tyrefem.cards.plausible import AIR_TEMPERATURE
from tyrefem.errors import InputWarning
from tyrefem.geometry import Section
from tyrefem.inputs.study_card import StudyCard
from tyrefem.materials.card import MaterialCard

#: Two angles that differ by less are the same, rad: 0.05 deg.
SAME_ANGLE = math.radians(0.05)


def study_warnings(
    card: StudyCard, section: Section, materials: Mapping[str, MaterialCard], file: Path | None
) -> tuple[InputWarning, ...]:
    """Warnings of unusual input, each with the study's file and the dotted name of the field.

    >>> from tyrefem.inputs.study import study
    >>> light = study("nasa-22x5.5-8pr", {"materials.tread.density.value": "1.18 kg/m**3"})
    >>> [warning.field for warning in light.input_warnings]
    ['materials.tread.density.value']
    """
    warnings = [*card.warnings(), *_of_another_tyre(card, section), *_of_driven_temperatures(card)]
    warnings += [*_of_ambient(card), *_of_mesh_file(card)]
    warnings += [warning.within(field="section") for warning in section.warnings]
    warnings += [*_of_materials(materials), *_of_crown_angles(card, section, materials)]
    if card.mechanics.energy is not None:
        rows = card.mechanics.energy.without_effect(section)
        warnings += [warning.within(field="mechanics.energy") for warning in rows]
    return tuple(warning.within(file=file) for warning in warnings)


def _of_materials(materials: Mapping[str, MaterialCard]) -> Iterator[InputWarning]:
    """One warning for all regions of a card."""
    regions: dict[InputWarning, list[str]] = {}
    for region, material in materials.items():
        for warning in material.warnings():
            regions.setdefault(warning, []).append(region)
    for warning, named in regions.items():
        also = f" (so in {', '.join(named[1:])})" if len(named) > 1 else ""
        yield InputWarning(f"{warning.message}{also}", warning.field).within(field=f"materials.{named[0]}")


def _of_driven_temperatures(card: StudyCard) -> Iterator[InputWarning]:
    """Temperatures of the boundaries that no phase reads, because all phases give their own."""
    for side in ("road", "rim"):
        key = f"{side}_temperature"
        given = getattr(card.boundaries, side).temperature is not None
        if given and all(getattr(phase, key) is not None for phase in card.drive.phases):
            yield InputWarning(
                f"is not read: every phase of the drive has '{key}', which goes before it; remove either",
                field=f"boundaries.{side}.temperature",
            )


def _of_ambient(card: StudyCard) -> Iterator[InputWarning]:
    """The first ambient temperature of the drive that is unlikely, as one in kelvins or degF would be."""
    same = len({phase.ambient for phase in card.drive.phases}) == 1
    for phase in card.drive.phases:
        field = "drive.ambient" if same else f"drive.phases.{phase.name}.ambient"
        unlikely = [AIR_TEMPERATURE.warning(end, field) for end in (phase.ambient.start, phase.ambient.end)]
        for warning in filter(None, unlikely):
            yield warning
            return


def _of_mesh_file(card: StudyCard) -> Iterator[InputWarning]:
    """Numbers of a mesher beside a mesh from a file, and of a file beside a mesher: they would change nothing."""
    of_file = card.mesh.file is not None
    keys = ("mesher", "size", "cell", "through") if of_file else ("names", "axes", "unit")
    idle = [key for key in keys if key in card.mesh.model_fields_set]
    if idle:
        why = "the mesh comes from mesh.file" if of_file else "there is no mesh.file"
        yield InputWarning(f"not read, as {why}: {', '.join(idle)}", field="mesh")


def _of_crown_angles(
    card: StudyCard, section: Section, materials: Mapping[str, MaterialCard]
) -> Iterator[InputWarning]:
    """Crown angles that the study writes and that do not act, as the section's rating has another."""
    rated = None if section.rating is None else section.rating.cord_angle
    for region, material in materials.items():
        stated = None if material.cord is None else material.cord.crown_angle
        reference = card.materials.get(region)
        changed = isinstance(reference, Mapping) and "crown_angle" in (reference.get("cord") or {})
        if rated and changed and stated is not None and abs(stated - rated) > SAME_ANGLE:
            yield InputWarning(
                f"{math.degrees(stated):.4g} deg does not act: section.rating.cord_angle goes before it, "
                f"{math.degrees(rated):.4g} deg",
                field=f"materials.{region}.cord.crown_angle",
            )


def _of_another_tyre(card: StudyCard, section: Section) -> Iterator[InputWarning]:
    names = card.of_one_tyre
    if card.made_for is not None and names and section.name != card.made_for:
        yield InputWarning(
            f"{', '.join(names)}: these are for section '{card.made_for}', but the section is '{section.name}'; "
            "replace or remove them, then change made_for",
            field="made_for",
        )
