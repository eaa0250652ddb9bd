"""The parts of a study: validated card, section, material cards, places of the sensors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.brief import Brief
from tyrefem.cache import Cache
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.drive_table import as_written
from tyrefem.inputs.sensor_places import sensor_places
from tyrefem.inputs.study_card import StudyCard
from tyrefem.inputs.study_materials import StudyMaterials
from tyrefem.materials.card import MaterialCard
from tyrefem.plugins import Registry, registry
from tyrefem.sizes import completed_materials

if TYPE_CHECKING:
    from tyrefem.geometry import Section
    from tyrefem.geometry.builder import WrittenSection

#: Worn sections, by new section and wear; studies with the same new section share the worn section.
_WORN: Cache[Section] = Cache(size=32)

#: Parts of a section's outside in a study.
OUTSIDE = ("road", "outside_air", "rim")


@dataclass(frozen=True, eq=False)
class StudyParts(Brief):
    """A study's data with file and folder, and the parts read from them.

    ``new_section``: section before wear; ``section``: section worn by the study's effects. ``temperatures``: mean
    temperatures of the regions for their moduli, degC; None: moduli as in the cards. ``plugins``: the user's effects
    and laws with which the parts were read.
    """

    data: Mapping[str, Any]
    file: Path | None
    folder: Path | None
    card: StudyCard
    new_section: Section
    section: Section
    materials: StudyMaterials
    sensor_places: Mapping[str, tuple[float, float]]
    #: The section's card as read.
    section_card: WrittenSection
    temperatures: Mapping[str, float] | None = None
    plugins: Registry = field(default_factory=registry, repr=False)

    @classmethod
    def read(
        cls, data: Mapping[str, Any], file: Path | None, folder: Path | None, like: StudyParts | None = None
    ) -> StudyParts:
        """Read all parts. Parts of ``like``, with the same cards, are reused where the two studies do not differ.

        Raises
        ------
        InputError : the study or a card that it names has an error: file, field, what is allowed.
        """
        if like is not None and not registry().keeps(like.plugins):
            like = None  # an effect or law was edited since
        try:
            card = StudyCard.check(data, file) if like is None else like.card.checked(like.data, data, file)
        except InputError as error:
            raise error_as_written(error, data) from None
        cards = None if like is None else like.materials
        if like is not None and data["section"] != like.data["section"]:
            # In another section, cords may not fit and sensors may be outside.
            like = None
        if like is not None and card.mesh.section == like.card.mesh.section:
            new_section, section_card = like.new_section, like.section_card
        else:
            new_section, section_card = _section(data["section"], card, folder, file)
        section = _worn(new_section, card)
        materials = StudyMaterials.read(
            completed(data["section"], data.get("materials", {}), file),
            new_section,
            folder,
            file,
            cards,
            same_section=like is not None,
        )
        _check_energy(card, new_section, file)
        if like is not None and new_section is like.new_section and card.sensors == like.card.sensors:
            places = like.sensor_places
        else:
            places = sensor_places(card.sensors, new_section, file)
        return cls(data, file, folder, card, new_section, section, materials, places, section_card)

    @classmethod
    def of_cards(
        cls,
        data: Mapping[str, Any],
        file: Path | None,
        folder: Path | None,
        section_card: WrittenSection,
        written: Mapping[str, tuple[dict[str, Any], Path]],
    ) -> StudyParts:
        """The parts from cards as they were read at another time: ``written`` as in `StudyMaterials`.

        Raises
        ------
        InputError : the study or a card has an error: file, field, what is allowed.
        """
        from tyrefem.geometry.builder import section_of

        card = StudyCard.check(data, file)
        new_section = _full(section_of(section_card), card)
        cards = {region: MaterialCard.check(content, path) for region, (content, path) in written.items()}
        references = completed(data["section"], data.get("materials", {}), file)
        materials = StudyMaterials(references, folder, cards, dict(written))
        places = sensor_places(card.sensors, new_section, file)
        section = _worn(new_section, card)
        return cls(data, file, folder, card, new_section, section, materials, places, section_card)

    def warmed(self, temperatures: Mapping[str, float]) -> StudyParts:
        """The same parts with moduli at given mean temperatures of the regions, degC."""
        return replace(self, materials=self.materials.warmed(temperatures), temperatures=dict(temperatures))

    def at_amplitudes(self, amplitudes: Mapping[str, float]) -> StudyParts:
        """The same parts with moduli at given shear strain amplitudes of the regions."""
        return replace(self, materials=self.materials.at_amplitudes(amplitudes))

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the data, not the card: it is read again, with the user's effects of that process."""
        sections = (self.new_section, self.section)
        read = (self.materials, self.sensor_places, self.section_card, self.temperatures)
        return _opened, (self.data, self.file, self.folder, *sections, *read)


def _opened(data: Mapping[str, Any], file: Path | None, folder: Path | None, *read: Any) -> StudyParts:
    return StudyParts(data, file, folder, StudyCard.check(data, file), *read)


def error_as_written(error: InputError, data: Mapping[str, Any]) -> InputError:
    """The error with the field as written: a value that a phase has from ``[drive]`` is named there."""
    drive = data.get("drive")
    if not isinstance(drive, Mapping) or not (error.field or "").startswith("drive.phases."):
        return error
    return InputError(error.message, field=as_written(drive, str(error.field)), file=error.file)


def completed(section: object, materials: Mapping[str, Any], file: Path | None) -> Mapping[str, Any]:
    """``[materials]``, with the cards of the section's size where it names none."""
    try:
        return completed_materials(section, materials)
    except InputError as error:
        raise error if error.file else error.within(field="section", file=file) from None


def _section(
    reference: object, card: StudyCard, folder: Path | None, file: Path | None
) -> tuple[Section, WrittenSection]:
    from tyrefem.geometry.builder import load_written

    try:
        built, written = load_written(reference, near=folder)
    except InputError as error:
        if isinstance(reference, Mapping) and "base" in reference and error.file is not None:
            # Where the card alone is right, the error is in the study's changes.
            load_written(reference["base"], near=folder)
            error = error.without_file(error.file)
        raise error if error.file else error.within(field="section", file=file) from None
    _check_sides(built, file)
    return _full(built, card), written


def _check_sides(section: Section, file: Path | None) -> None:
    """The surroundings of a study act on the outside by these names; a part of another name would be insulated."""
    names = section.outer.names
    other, missing = [name for name in names if name not in OUTSIDE], [name for name in OUTSIDE if name not in names]
    if other or missing:
        message = f"unknown '{other[0]}'{nearest(other[0], OUTSIDE)}" if other else f"'{missing[0]}' is missing"
        raise InputError(
            f"section '{section.name}', [[boundaries]]: {message}; a study wants {', '.join(OUTSIDE)}",
            field="section",
            file=file,
        )


def _full(section: Section, card: StudyCard) -> Section:
    return section.as_full() if card.mesh.section == "full" else section


def _worn(section: Section, card: StudyCard) -> Section:
    """The section, worn by the study's effects."""
    wear = [effect for effect in card.acting_effects if effect.overrides("worn")]
    if not wear:
        return section

    def worn() -> Section:
        left = section
        for effect in wear:
            left = _is_section(effect, effect.worn(left))
        return left

    return _WORN.get((section, *((type(effect), effect.model_dump_json()) for effect in wear)), worn)


def _is_section(effect: Any, left: object) -> Section:
    """What an effect makes of a section, refused where it is no section."""
    from tyrefem.geometry.section import Section

    if not isinstance(left, Section):
        raise InputError(f"worn(section) must give a section, not {left!r:.40}", field=f"effects.{effect.name}")
    return left


def _check_energy(card: StudyCard, section: Section, file: Path | None) -> None:
    try:
        if card.mechanics.energy is not None:
            card.mechanics.energy.check_regions(section)
    except InputError as error:
        raise error.within(field="mechanics.energy", file=file) from None
