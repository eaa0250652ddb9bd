"""A study: immutable description of a tyre and its drive, with methods to load, change and save it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from tyrefem import library
from tyrefem.cards import read_toml
from tyrefem.cards.file_kinds import expect_kind
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.changes import all_changed, check_changes_table, check_compatible
from tyrefem.inputs.study_contents import StudyContents
from tyrefem.inputs.study_file import write_study
from tyrefem.inputs.uncertain_numbers import uncertain_number
from tyrefem.measured.cases import Case, read_cases
from tyrefem.output import as_path, note_input

if TYPE_CHECKING:
    from tyrefem.geometry.meshing import TyreMesh


@dataclass(frozen=True, eq=False)
class StudyData(StudyContents):
    """A tyre, its materials, drive, boundaries and sensors. Made by `study`; changed by `replace`.

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

    >>> faster = study("nasa-22x5.5-8pr").replace({"drive.speed": "25 mph"})
    >>> faster.data["drive"]["speed"]
    '25 mph'
    """

    @classmethod
    def load(cls, name: str | Path, changes: Mapping[str, Any] | None = None, case: str | None = None) -> Self:
        """Load a study by name or path; ``changes`` gives new values by dotted name.

        ``case``: case of a campaign; ``changes`` then change the case's values.

        Raises
        ------
        InputError : the study does not exist, or it or a card that it names has an error: file, field, what is allowed.
        """
        path = library.find("study", str(name))
        folder = path.parent.resolve()
        # The root of a disk has no name.
        stem = (folder.name or path.stem) if path.name == "study.toml" else path.stem
        check_changes_table({} if changes is None else changes)
        changes = dict(changes or {})
        # A changed table of cases is set before its case is selected.
        first = changes if case is None else {key: changes.pop(key) for key in list(changes) if key == "cases"}
        data = read_toml(path)
        expect_kind("study", data, path)
        loaded = cls(stem, all_changed(data, first), path, folder)
        loaded = loaded if case is None else loaded.case(case).replace(changes)
        # Inputs of every command with this study, also of those that do not read them.
        for entry in loaded.measured:
            note_input(entry.table)
        if not loaded.is_campaign:  # the cases of a campaign are checked each
            loaded.check_uncertainty()
        return loaded

    # -- change ------------------------------------------------------------------------------------------------------

    def replace(self, changes: Mapping[str, Any], like: StudyData | None = None) -> Self:
        """A new study with values changed by dotted names; units as text, as in a file.

        Parts of ``like`` (default: this study) are reused where the two do not differ.

        Raises
        ------
        InputError : a name is unknown (names the nearest), or a value is not allowed.
        """
        data = all_changed(self.data, changes)
        return type(self)(self.name, data, self.file, self.folder, self if like is None else like)

    def warmed(self, temperatures: Mapping[str, float]) -> Self:
        """This study with the moduli of its cards at given mean temperatures of the regions, degC.

        All else is shared. Use it to compute strain cycles, not to write or change a study.
        """
        built = self.parts.warmed(temperatures)
        return type(self)(self.name, self.data, self.file, self.folder, built=built)

    def at_amplitudes(self, amplitudes: Mapping[str, float]) -> Self:
        """This study with the moduli of its cards at shear strain amplitudes of regions, where they depend on them.

        All else is shared. Use it to compute strain cycles, not to write or change a study.
        """
        built = self.parts.at_amplitudes(amplitudes)
        return type(self)(self.name, self.data, self.file, self.folder, built=built)

    def scaled(self, key: str, factor: float) -> Self:
        """A new study with the number at a dotted name times a factor, in every region with that card.

        An uncertain number with several names (c10 and c01 of one compound) is multiplied at all of them.

        Raises
        ------
        InputError : no number of that name; a factor that is no number, or that gives a value which is not allowed.

        >>> radial = study("passenger-205-55r16").scaled("materials.body-ply.conductivity.value", 2.0)
        >>> radial.materials["turn-up"].conductivity.value == radial.materials["body-ply"].conductivity.value
        True
        """
        check_changes_table({key: factor})
        if isinstance(factor, bool) or not isinstance(factor, Real):
            raise InputError(f"must be a number, not {factor!r:.60}", field="factor")
        return self.replace(uncertain_number(self, key).changes(factor if isinstance(factor, int) else float(factor)))

    def with_drive(self, changes: Mapping[str, Any]) -> Self:
        """A new study with other values in its ``[drive]`` table."""
        if not isinstance(changes, Mapping):
            raise InputError(f"must be a mapping like {{'speed': '25 mph'}}, not {changes!r:.60}", field="changes")
        return self.replace({f"drive.{key}": value for key, value in changes.items()})

    def at_run(self, run: str, drive: Mapping[str, Any] | None = None) -> Self:
        """This study at a measured run: with values of the run's ``[drive]``, and with the effects that act in it."""
        return self.replace({"run": run, **{f"drive.{key}": value for key, value in (drive or {}).items()}})

    def save(self, path: str | Path) -> Path:
        """Write the study as a TOML file that can be run.

        Relative paths of files become absolute if the new file is in another folder.
        """
        return write_study(self.data, self.folder, as_path(path, "path"))

    # -- work --------------------------------------------------------------------------------------------------------

    def mesh(self) -> TyreMesh:
        """Mesh of the section, by the study's ``[mesh]`` table."""
        from tyrefem.geometry import meshing

        choice = self.card.mesh
        try:
            if choice.file is not None:
                path = (self.folder or Path()) / choice.file
                return meshing.read_for(self.section, path, names=choice.names, axes=choice.axes, unit=choice.unit)
            return meshing.build(
                self.section, mesher=choice.mesher, size=choice.size, cell=choice.cell, through=choice.through
            )
        except InputError as error:
            raise error if error.file else error.within(field="mesh", file=self.file) from None

    @property
    def cases_file(self) -> Path | None:
        """Absolute path of the table of cases; None if the study is no campaign."""
        return None if self.card.cases is None else (self.folder or Path()) / self.card.cases

    @property
    def cases(self) -> tuple[Case, ...]:
        """The rows of the study's table of cases.

        Raises
        ------
        InputError : the study has no table of cases, or the table has an error.
        """
        if self.cases_file is None:
            raise InputError("the study has no 'cases' table", field="cases", file=self.file)
        return read_cases(self.cases_file)

    @property
    def case_names(self) -> tuple[str, ...]:
        """Names of the cases, in the table's order; empty without a table."""
        return tuple(case.name for case in self.cases) if self.is_campaign else ()

    def case(self, name: str) -> Self:
        """The study of a case, by the case's name.

        Raises
        ------
        InputError : there is no table of cases, no case of that name (names the nearest), or the case has an error.

        >>> study("nasa-campaign").case("8pr-3270lbf-83psi-20mph").data["drive"]["load"]
        '3270 lbf'
        """
        name, by_name = str(name), {case.name: case for case in self.cases}
        if name not in by_name:
            raise InputError(f"no case '{name}'{nearest(name, by_name)}", file=self.cases_file)
        return self.case_study(by_name[name])

    def case_study(self, case: Case) -> Self:
        """The study of a row of the table of cases; an error names the row's line."""
        try:
            check_compatible(self.data, case.changes)
            changed = self.replace(case.changes)
            data = {key: value for key, value in changed.data.items() if key != "cases"}
            data["title"] = f"{case.name}: {case.note}" if case.note else case.name
            study_of_case = type(self)(case.name, data, self.file, self.folder, changed)
            study_of_case.check_uncertainty()
            return study_of_case
        except InputError as error:
            of_study = error.file is None or error.file == self.file
            reason = InputError(error.message, field=error.field) if of_study else error
            raise InputError(f"line {case.line}, case '{case.name}': {reason}", file=self.cases_file) from None


def study(name: str | Path, changes: Mapping[str, Any] | None = None, case: str | None = None) -> StudyData:
    """Load a study by name or path, see `StudyData.load`."""
    return StudyData.load(name, changes, case)
