"""A study: one immutable description of a tyre and its drive, and what can be asked of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from tyrefem import library
from tyrefem.cards import read_toml
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.changes import all_changed
from tyrefem.inputs.study_contents import StudyContents
from tyrefem.inputs.study_file import write_study
from tyrefem.inputs.uncertain_numbers import uncertain_number
from tyrefem.measured.cases import Case, read_cases

if TYPE_CHECKING:
    from tyrefem.geometry.meshing import TyreMesh


@dataclass(frozen=True, eq=False)
class StudyData(StudyContents):
    """A tyre, its materials, drive, boundaries and sensors. Made by `study`; changed by `replace`.

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

    >>> faster = study("nasa-22x5.5-8pr").replace({"drive.speed": "25 mph"})
    >>> faster.data["drive"]["speed"]
    '25 mph'
    """

    @classmethod
    def load(cls, name: str | Path, changes: Mapping[str, Any] | None = None, case: str | None = None) -> Self:
        """The study of a name or path, with values changed by dotted names.

        ``case``: of a campaign, only this case; ``changes`` are then laid over the case's own values.

        Raises
        ------
        InputError : no such study, or something wrong in it or in a card it names: file, field, what is allowed.
        """
        path = library.find("study", str(name))
        folder = path.parent.resolve()
        stem = folder.name if path.name == "study.toml" else path.stem
        changes = dict(changes or {})
        # Another table of cases comes before the case that is taken of it.
        first = changes if case is None else {key: changes.pop(key) for key in list(changes) if key == "cases"}
        loaded = cls(stem, all_changed(read_toml(path), first), path, folder)
        return loaded if case is None else loaded.case(case).replace(changes)

    # -- change ------------------------------------------------------------------------------------------------------

    def replace(self, changes: Mapping[str, Any], like: StudyData | None = None) -> Self:
        """A new study with values changed by dotted names; units as text, as in a file.

        What another study, ``like`` (this one, if not given), has built is taken over where the two do not differ.

        Raises
        ------
        InputError : unknown name (says the nearest), or a value that is not allowed.
        """
        data = all_changed(self.data, changes)
        return type(self)(self.name, data, self.file, self.folder, self if like is None else like)

    def warmed(self, temperatures: Mapping[str, float]) -> Self:
        """This study with the moduli that its cards have at the mean temperatures of the regions, degC.

        Everything else is shared. It is for finding strain cycles, not for writing or changing.
        """
        built = self.parts.warmed(temperatures)
        return type(self)(self.name, self.data, self.file, self.folder, built=built)

    def scaled(self, key: str, factor: float) -> Self:
        """A new study with the number at a dotted name times a factor, in every region that takes it from that card.

        An uncertain number that stands at several names (c10 and c01 of one compound) is moved as one.

        >>> radial = study("passenger-205-55r16").scaled("materials.body-ply.conductivity.value", 2.0)
        >>> radial.materials["turn-up"].conductivity.value == radial.materials["body-ply"].conductivity.value
        True
        """
        return self.replace(uncertain_number(self, key).changes(factor))

    def with_drive(self, changes: Mapping[str, Any]) -> Self:
        """A new study with other values in its ``[drive]`` table."""
        return self.replace({f"drive.{key}": value for key, value in changes.items()})

    def save(self, path: str | Path) -> Path:
        """Write the study as a TOML file that runs as it is.

        Files that the study names relative to its own folder are named by their whole path, if it is another folder.
        """
        return write_study(self.data, self.folder, Path(path))

    # -- work --------------------------------------------------------------------------------------------------------

    def mesh(self) -> TyreMesh:
        """The section's mesh, as the study's ``[mesh]`` table asks."""
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
        """The table of cases, its path made whole; None: the study is no campaign."""
        return None if self.card.cases is None else (self.folder or Path()) / self.card.cases

    @property
    def cases(self) -> tuple[Case, ...]:
        """The rows of its table of cases.

        Raises
        ------
        InputError : it has no table, or the table is wrong.
        """
        if self.cases_file is None:
            raise InputError("the study has no 'cases' table", field="cases", file=self.file)
        return read_cases(self.cases_file)

    @property
    def case_names(self) -> tuple[str, ...]:
        """Names of its cases, in the table's order; none without a table."""
        return tuple(case.name for case in self.cases) if self.is_campaign else ()

    def case(self, name: str) -> Self:
        """One case of the study's table by its name, a study of its own.

        Raises
        ------
        InputError : the study has no table of cases, or none of that name (says the nearest); the case is wrong.

        >>> study("nasa-campaign").case("8pr-3270lbf-83psi-20mph").data["drive"]["load"]
        '3270 lbf'
        """
        by_name = {case.name: case for case in self.cases}
        if name not in by_name:
            raise InputError(f"no case '{name}'{nearest(name, by_name)}", file=self.cases_file)
        return self.case_study(by_name[name])

    def case_study(self, case: Case) -> Self:
        """The study of one row of its table; what is wrong with it is said with its line there."""
        try:
            changed = self.replace(case.changes)
            data = {key: value for key, value in changed.data.items() if key != "cases"}
            data["title"] = f"{case.name}: {case.note}" if case.note else case.name
            return type(self)(case.name, data, self.file, self.folder, changed)
        except InputError as error:
            of_study = error.file is None or error.file == self.file
            reason = InputError(error.message, field=error.field) if of_study else error
            raise InputError(f"line {case.line}, case '{case.name}': {reason}", file=self.cases_file) from None


def study(name: str | Path, changes: Mapping[str, Any] | None = None, case: str | None = None) -> StudyData:
    """The study of a name or path, with values changed by dotted names: `Study.load`."""
    return StudyData.load(name, changes, case)
