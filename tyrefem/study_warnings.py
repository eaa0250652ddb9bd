"""The warnings of a study: its own, its section's, its material cards', and what belongs to another tyre."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from tyrefem.errors import InputWarning

if TYPE_CHECKING:
    from tyrefem.studies import Study


def study_warnings(study: Study) -> tuple[InputWarning, ...]:
    """What can be run but is perhaps not meant, each with the study's file and the dotted name of the field.

    >>> from tyrefem.studies import study
    >>> light = study("nasa-22x5.5-8pr", {"materials.tread.density.value": "1.18 kg/m**3"})
    >>> [warning.field for warning in study_warnings(light)]
    ['materials.tread.density.value']
    """
    card = study.card
    found = [*card.warnings(), *_of_another_tyre(study)]
    found += [warning.within(field="section") for warning in study.new_section.warnings]
    found += _of_materials(study)
    if card.mechanics.energy is not None:
        rows = card.mechanics.energy.without_effect(study.new_section)
        found += [warning.within(field="mechanics.energy") for warning in rows]
    return tuple(warning.within(file=study.file) for warning in found)


def _of_materials(study: Study) -> Iterator[InputWarning]:
    """One warning for all regions of a card."""
    regions: dict[InputWarning, list[str]] = {}
    for region, material in study.materials.items():
        for warning in material.warnings():
            regions.setdefault(warning, []).append(region)
    for warning, named in regions.items():
        also = f" (so in {', '.join(named[1:])})" if len(named) > 1 else ""
        yield InputWarning(f"{warning.message}{also}", warning.field).within(field=f"materials.{named[0]}")


def _of_another_tyre(study: Study) -> Iterator[InputWarning]:
    made_for, names = study.card.made_for, study.card.of_one_tyre
    if made_for is not None and names and study.new_section.name != made_for:
        yield InputWarning(
            f"{', '.join(names)}: these are of section '{made_for}', but the section is '{study.new_section.name}'; "
            "give those of this tyre or remove them, then change made_for",
            field="made_for",
        )
