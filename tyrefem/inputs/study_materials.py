"""The material cards of a study, by region."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem import library
from tyrefem.brief import Brief
from tyrefem.cards import read_toml
from tyrefem.errors import InputError, nearest
from tyrefem.materials.card import MaterialCard
from tyrefem.materials.cord_layers import check_cords_fit

if TYPE_CHECKING:
    from tyrefem.geometry import Section


@dataclass(frozen=True, eq=False)
class StudyMaterials(Brief):
    """Region -> material card; and region -> the card as written, with the study's changes, and its file.

    ``references``: the study's table ``[materials]``; ``folder``: folder of its relative references.
    """

    references: Mapping[str, Any]
    folder: Path | None
    cards: dict[str, MaterialCard]
    written: dict[str, tuple[dict[str, Any], Path]]

    @classmethod
    def read(
        cls,
        references: Mapping[str, Any],
        section: Section,
        folder: Path | None,
        file: Path | None,
        like: StudyMaterials | None,
        *,
        same_section: bool = True,
    ) -> StudyMaterials:
        """Read the cards of all regions of a section. Unchanged cards of ``like`` are reused.

        ``same_section``: of ``like`` too; else cords are checked again.

        Raises
        ------
        InputError : a region has no card, a card has no region, or a card has an error or does not fit its region.
        """
        regions = section.regions
        for region in references:
            if region not in regions:
                message = f"unknown region '{region}'{nearest(str(region), regions)}"
                raise InputError(message, field="materials", file=file)
        cards: dict[str, MaterialCard] = {}
        written: dict[str, tuple[dict[str, Any], Path]] = {}
        for region in regions:
            if region not in references:
                raise InputError(f"no material card for region '{region}'", field="materials", file=file)
            known = like is not None and region in like.cards and (same_section or like.folder == folder)
            if known and like is not None and references[region] == like.references[region]:
                cards[region], written[region] = like.cards[region], like.written[region]
                if same_section:
                    continue
            try:
                if region not in cards:
                    cards[region], written[region] = _card(region, references[region], folder, like)
                check_cords_fit(cards[region], section, region)
            except InputError as error:
                raise error if error.file else error.within(field=f"materials.{region}", file=file) from None
        return cls(references, folder, cards, written)

    def warmed(self, temperatures: Mapping[str, float]) -> StudyMaterials:
        """The cards with their moduli at given mean temperatures of the regions, degC."""
        self._check_regions(temperatures)
        missing = [region for region in self.cards if region not in temperatures]
        if missing:
            raise InputError(f"every region needs a temperature; missing: {', '.join(missing)}", field="temperatures")
        cards = {region: card.warmed(temperatures[region]) for region, card in self.cards.items()}
        return StudyMaterials(self.references, self.folder, cards, self.written)

    def at_amplitudes(self, amplitudes: Mapping[str, float]) -> StudyMaterials:
        """The cards with their moduli at given shear strain amplitudes of the regions; others do not change."""
        self._check_regions(amplitudes)
        cards = {
            region: card.at_amplitude(amplitudes[region]) if region in amplitudes else card
            for region, card in self.cards.items()
        }
        return StudyMaterials(self.references, self.folder, cards, self.written)

    def _check_regions(self, values: Mapping[str, float]) -> None:
        for region in values:
            if region not in self.cards:
                raise InputError(f"no region '{region}'{nearest(region, self.cards)}")


def _card(
    region: str, reference: object, folder: Path | None, like: StudyMaterials | None
) -> tuple[MaterialCard, tuple[dict[str, Any], Path]]:
    """A card, with its data and file; tables that ``like`` has read are not read again."""
    if like is not None and region in like.cards and like.folder == folder:
        before, path = like.written[region]
        data = library.over("material", reference, like.references[region], before)
        if data is not None:
            try:
                return like.cards[region].checked(before, data, path), (data, path)
            except InputError as error:
                raise error.without_file(path) from None
    data, path, _ = library.load("material", reference, folder)
    try:
        return MaterialCard.check(data, path), (data, path)
    except InputError as error:
        if isinstance(reference, Mapping):
            # Where the card alone is right, the error is in the study's changes.
            MaterialCard.check(read_toml(path), path)
            raise error.without_file(path) from None
        raise
