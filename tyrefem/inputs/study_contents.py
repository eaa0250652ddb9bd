"""What a study says: its data, and everything that is read from them."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import InitVar, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.brief import Brief
from tyrefem.errors import InputError, InputWarning
from tyrefem.inputs.sensor_places import sensor_place
from tyrefem.inputs.study_card import MeasuredEntry, Sensor, StudyCard
from tyrefem.inputs.study_effects import check_effects
from tyrefem.inputs.study_parts import StudyParts, error_as_written
from tyrefem.inputs.uncertain_numbers import UncertainNumber, uncertain_numbers
from tyrefem.inputs.warnings import study_warnings
from tyrefem.materials.card import MaterialCard

if TYPE_CHECKING:
    from tyrefem.effects import Effect
    from tyrefem.geometry import Section


@dataclass(frozen=True, eq=False)
class StudyContents(Brief):
    """A study as it can be read: `tyrefem.inputs.study.StudyData` adds how it is loaded, changed and saved.

    Parameters
    ----------
    name : what the study is called.
    data : the file as written (units in the text).
    file : where it was read; None: nowhere.
    folder : where relative references (cards, tables) start from.
    like : another study of the same cards; what it is built of serves where the two do not differ.
    built : what this study is built of, if that is known and checked.

    Raises
    ------
    InputError : something wrong in the study or in a card it names: file, field, what is allowed.
    """

    name: str
    data: Mapping[str, Any]
    file: Path | None = None
    folder: Path | None = None
    like: InitVar[StudyContents | None] = None
    built: InitVar[StudyParts | None] = None
    parts: StudyParts = field(init=False, repr=False)

    def __post_init__(self, like: StudyContents | None, built: StudyParts | None) -> None:
        parts = built or StudyParts.read(self.data, self.file, self.folder, None if like is None else like.parts)
        object.__setattr__(self, "parts", parts)
        if built is None:
            check_effects(self)

    def __reduce__(self) -> tuple[Any, ...]:
        """What it is built of travels too: the cards may have changed where it is opened again."""
        return type(self), (self.name, self.data, self.file, self.folder, None, self.parts)

    def _facts(self) -> Mapping[str, Any]:
        drive, section = self.card.drive, self.section
        mesh = self.card.mesh
        return {
            "title": self.title,
            "file": self.file or "not in a file",
            "section": f"{section.name}, {'half' if section.half else 'whole'}, regions {', '.join(section.regions)}",
            "drive": f"{', '.join(phase.name for phase in drive.phases)}: {drive.end:g} s from {drive.initial:g} degC",
            "strain law": self.card.mechanics.strain,
            "mesh": mesh.file or f"{mesh.mesher}, {mesh.size * 1e3:g} mm, {mesh.element}",
            "sensors": self.sensors,
            "effects": [effect.name for effect in self.effects],
            "measured": [Path(entry.table).name for entry in self.measured],
            "uncertain": f"{len(self.uncertainty)} numbers",
            **({"cases": self.card.cases} if self.is_campaign else {}),
        }

    @property
    def is_campaign(self) -> bool:
        """Does it name a table of cases?"""
        return self.card.cases is not None

    def as_written(self, error: InputError) -> InputError:
        """The error in the file's own words: what a phase takes over from ``[drive]`` is wrong there."""
        return error_as_written(error, self.data)

    # -- what it is made of ------------------------------------------------------------------------------------------

    @property
    def card(self) -> StudyCard:
        """The study's data, validated, in SI."""
        return self.parts.card

    @property
    def section(self) -> Section:
        """The tyre's section, half or full as the mesh table says, worn as the study's effects say."""
        return self.parts.section

    @property
    def new_section(self) -> Section:
        """The section before any wear."""
        return self.parts.new_section

    @functools.cached_property
    def effects(self) -> tuple[Effect, ...]:
        """The study's effects that are not null."""
        return tuple(effect for effect in self.card.effects if not effect.is_null)

    @property
    def materials(self) -> dict[str, MaterialCard]:
        """Region of the section -> material card."""
        return self.parts.materials.cards

    @property
    def material_data(self) -> Mapping[str, tuple[Mapping[str, Any], Path]]:
        """Region -> its material card as written, changes laid over it, and the card's file."""
        return self.parts.materials.written

    @property
    def temperatures(self) -> Mapping[str, float] | None:
        """Mean temperature of each region that the moduli are at, degC; None: as the cards give them."""
        return self.parts.temperatures

    @property
    def stated_places(self) -> Mapping[str, tuple[float, float]]:
        """(r, z) of every sensor as it was built in, m."""
        return self.parts.sensor_places

    def section_place(self, sensor: Sensor) -> tuple[float, float]:
        """(r, z) of a sensor as it was built in, m; refuses one outside the rubber."""
        return sensor_place(sensor, self.new_section)

    @functools.cached_property
    def warnings(self) -> tuple[InputWarning, ...]:
        """What can be run but is perhaps not meant, in the study, its section and its material cards."""
        return study_warnings(self.card, self.new_section, self.materials, self.file)

    @property
    def title(self) -> str:
        """One line for people."""
        return self.card.title

    @property
    def sensors(self) -> Mapping[str, Sensor]:
        """Thermocouples by name."""
        return self.card.sensors

    @property
    def measured(self) -> tuple[MeasuredEntry, ...]:
        """The study's measured tables, their paths made whole."""
        folder = self.folder or Path()
        entries = self.card.measured
        return tuple(entry.model_copy(update={"table": folder / entry.table}) for entry in entries)

    @property
    def tolerance(self) -> float:
        """Time-integration error aimed at, K."""
        return self.card.numerics.tolerance

    @property
    def numerical_sd(self) -> float:
        """Standard deviation of a reading left by the mesh, K."""
        return self.card.numerics.mesh_sd

    @functools.cached_property
    def uncertain_numbers(self) -> tuple[UncertainNumber, ...]:
        """Every number with a standard deviation, from the cards and the study, also those that cannot matter.

        Raises
        ------
        InputError : a name in ``[uncertainty]`` that the study has not.
        """
        return uncertain_numbers(self)

    @functools.cached_property
    def uncertainty(self) -> dict[str, float]:
        """Dotted name of an uncertain number that can matter -> relative standard deviation."""
        return {number.key: number.sd for number in self.uncertain_numbers if not number.idle}
