"""Contents of a study: its data, and the parts that are read from them."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from dataclasses import InitVar, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tyrefem.brief import Brief, counted
from tyrefem.errors import InputError, InputWarning
from tyrefem.inputs.scale_warnings import scale_warnings
from tyrefem.inputs.sensor_places import sensor_place
from tyrefem.inputs.study_card import MeasuredEntry, Sensor, StudyCard
from tyrefem.inputs.study_effects import check_effects
from tyrefem.inputs.study_parts import StudyParts, error_as_written
from tyrefem.inputs.study_table import fixed
from tyrefem.inputs.uncertain_numbers import UncertainNumber, uncertain_numbers
from tyrefem.inputs.warnings import study_warnings
from tyrefem.inputs.wheel_checks import check_rim_temperature, check_wheel_states
from tyrefem.materials.card import MaterialCard

if TYPE_CHECKING:
    from tyrefem.effects import Effect
    from tyrefem.geometry import Section


@dataclass(frozen=True, eq=False)
class StudyContents(Brief):
    """A study's contents; `tyrefem.inputs.study.StudyData` adds methods to load, change and save it.

    Parameters
    ----------
    name : name of the study.
    data : the file as written (units in the text); it cannot be changed.
    file : file of the study; None: the study was not read from a file.
    folder : folder of relative references (cards, tables).
    like : another study of the same cards, whose parts are reused where the two do not differ.
    built : parts of this study, if they are already read and checked.

    Raises
    ------
    InputError : the study or a card that it names has an error: file, field, what is allowed.
    """

    name: str
    data: Mapping[str, Any]
    file: Path | None = None
    folder: Path | None = None
    like: InitVar[StudyContents | None] = None
    built: InitVar[StudyParts | None] = None
    parts: StudyParts = field(init=False, repr=False)

    def __post_init__(self, like: StudyContents | None, built: StudyParts | None) -> None:
        object.__setattr__(self, "data", fixed(self.data))
        parts = built or StudyParts.read(self.data, self.file, self.folder, None if like is None else like.parts)
        object.__setattr__(self, "parts", parts)
        if built is None:
            check_effects(self)
            try:
                check_wheel_states(self)
                check_rim_temperature(self)
            except InputError as error:
                raise self.as_written(error) from None

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the parts too, because the cards may differ where the study is unpickled."""
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
            "uncertain": counted(len(self.uncertainty), "number"),
            **({"cases": self.card.cases} if self.is_campaign else {}),
        }

    @property
    def file_read(self) -> Path | None:
        """``file`` as an absolute path, also after a change of the working directory."""
        if self.file is None or self.folder is None or self.file.is_absolute():
            return self.file
        return self.folder / self.file.name

    @property
    def is_campaign(self) -> bool:
        """True if the study names a table of cases."""
        return self.card.cases is not None

    def as_written(self, error: InputError) -> InputError:
        """The error with the field as written: a value that a phase has from ``[drive]`` is named there."""
        return error_as_written(error, self.data)

    # -- parts ------------------------------------------------------------------------------------------------------

    @property
    def card(self) -> StudyCard:
        """The study's data, validated, in SI."""
        return self.parts.card

    @property
    def section(self) -> Section:
        """The tyre's section, half or full by the mesh table, worn by the study's effects."""
        return self.parts.section

    @property
    def new_section(self) -> Section:
        """The section before any wear."""
        return self.parts.new_section

    @functools.cached_property
    def effects(self) -> tuple[Effect, ...]:
        """The study's effects of non-zero amplitude that act in its run."""
        return self.card.acting_effects

    @property
    def materials(self) -> dict[str, MaterialCard]:
        """Region of the section -> material card."""
        return self.parts.materials.cards

    @property
    def material_data(self) -> Mapping[str, tuple[Mapping[str, Any], Path]]:
        """Region -> its material card as written, with the study's changes, and the card's file."""
        return self.parts.materials.written

    @property
    def temperatures(self) -> Mapping[str, float] | None:
        """Mean temperature of each region for its moduli, degC; None: moduli as in the cards."""
        return self.parts.temperatures

    @property
    def stated_places(self) -> Mapping[str, tuple[float, float]]:
        """Stated (r, z) of every sensor, m."""
        return self.parts.sensor_places

    def section_place(self, sensor: Sensor) -> tuple[float, float]:
        """Stated (r, z) of a sensor, m; refuses a place outside the rubber."""
        return sensor_place(sensor, self.new_section)

    @functools.cached_property
    def input_warnings(self) -> tuple[InputWarning, ...]:
        """Warnings of unusual input, without the strain law's: `tyrefem.mechanics.cautions.warnings_of` gives all."""
        cautions = ((effect, effect.caution(self)) for effect in self.effects)
        return (
            *study_warnings(self.card, self.new_section, self.materials, self.file),
            *(warning.within(file=self.file) for warning in self._scale_warnings()),
            *(InputWarning(words, f"effects.{effect.name}", self.file) for effect, words in cautions if words),
        )

    def _scale_warnings(self) -> Iterator[InputWarning]:
        return scale_warnings(self.parts.section_card, self.new_section, self.data["section"])

    @property
    def title(self) -> str:
        """One line of text."""
        return self.card.title

    @property
    def sensors(self) -> Mapping[str, Sensor]:
        """Thermocouples by name."""
        return self.card.sensors

    @property
    def measured(self) -> tuple[MeasuredEntry, ...]:
        """The study's measured tables, with absolute paths."""
        folder = self.folder or Path()
        entries = self.card.measured
        return tuple(entry.model_copy(update={"table": folder / entry.table}) for entry in entries)

    @property
    def tolerance(self) -> float:
        """Allowed time-integration error, K."""
        return self.card.numerics.tolerance

    @property
    def numerical_sd(self) -> float:
        """Standard deviation of a reading by the mesh, K."""
        return self.card.numerics.mesh_sd

    @functools.cached_property
    def uncertain_numbers(self) -> tuple[UncertainNumber, ...]:
        """Every number with a standard deviation in the cards and the study, including those without influence.

        Raises
        ------
        InputError : the study has no number of a name in ``[uncertainty]``.
        """
        return uncertain_numbers(self)

    def check_uncertainty(self) -> None:
        """Raises `InputError` if the study has no number of a name in ``[uncertainty]``, or not such a deviation."""
        if self.card.uncertainty:
            _ = self.uncertain_numbers

    @functools.cached_property
    def uncertainty(self) -> dict[str, float]:
        """Dotted name of an uncertain number with influence -> relative standard deviation."""
        return {number.key: number.sd for number in self.uncertain_numbers if not number.idle}
