"""The measured runs of a comparison, each with the ``[[measured]]`` entry that it follows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from tyrefem.compare.interface import MeasuredEntryLike
from tyrefem.errors import InputError, nearest
from tyrefem.measured import MeasuredRun
from tyrefem.measured.columns import parts
from tyrefem.measured.frame import frame_lines, is_frame
from tyrefem.measured.names import ColumnNames, missing_columns_error
from tyrefem.measured.table import MeasuredTable, TableLines, table_lines

#: A CSV file, a pandas DataFrame with the same columns, a run already read, or several of these.
Table = Any


@dataclass(frozen=True, eq=False)
class Record:
    """A measured run with the names of the study's sensors, and its entry; None: a run that the study does not name."""

    run: MeasuredRun
    entry: MeasuredEntryLike | None = None


def records(entries: Sequence[MeasuredEntryLike], table: Table | None, given: ColumnNames) -> list[Record]:
    """The runs of ``table``, or else of the entries.

    A file of an entry is read as the entry says. A run of another table follows the entry of its name.

    Raises
    ------
    InputError : no such file, run or column; two entries for one run; no table has a column that ``given`` names.
    """
    reader = _Reader(entries, given)
    if table is None:
        result = reader.of_entries(entries)
    else:
        result = [record for each in listed(table) for record in reader.of_table(each)]
    given.require(reader.columns)
    return result


def listed(table: Table) -> Sequence[Any]:
    """The given tables and runs as a sequence."""
    if isinstance(table, str | Path | MeasuredRun) or is_frame(table):
        return (table,)
    if isinstance(table, Sequence):
        return table
    raise _no_table(table)


def _no_table(table: object) -> InputError:
    return InputError(
        f"a value of type {type(table).__name__} is no measured table; allowed: a CSV file's path, a pandas DataFrame "
        "with 'time [s]' and sensors like 'crown [degC]', a MeasuredRun, or a list of these"
    )


class _Reader:
    """Reads tables by entries and given names. ``columns``: names and headings of all columns read."""

    def __init__(self, entries: Sequence[MeasuredEntryLike], given: ColumnNames) -> None:
        self.entries, self.given = entries, given
        self.columns: list[str] = []
        self._at_hand: dict[str, MeasuredTable] = {}
        self._frames = 0

    def of_entries(self, entries: Sequence[MeasuredEntryLike]) -> list[Record]:
        """The runs of entries. One without ``run`` has those runs of its table that no other entry names."""
        named: dict[Path, list[str | None]] = {}
        for entry in entries:
            before = named.setdefault(_path(entry.table), [])
            if entry.run in before:
                which = "all runs" if entry.run is None else f"run '{entry.run}'"
                hint = "; give each entry its 'run'" if entry.run is None else ""
                raise InputError(f"two entries for {which} of this table{hint}", field="measured.run", file=entry.table)
            before.append(entry.run)
        result = []
        for entry in entries:
            measured = self._of_entry(entry)
            names = [run.name for run in measured.runs]
            if entry.run is not None and entry.run not in names:
                wrong = f"no run '{entry.run}'{nearest(entry.run, names)}"
                raise InputError(wrong, field="measured.run", file=entry.table)
            wanted = {entry.run} if entry.run is not None else {*names} - {*named[_path(entry.table)]}
            result += [Record(self._later(run, measured), entry) for run in measured.runs if run.name in wanted]
        return result

    def of_table(self, table: Any) -> list[Record]:
        """The runs of a file, a frame or a run already read."""
        if isinstance(table, MeasuredRun):
            return [self._of_run(table)]
        if is_frame(table):
            return self._of_frame(table)
        if not isinstance(table, str | Path):
            raise _no_table(table)
        of_file = [entry for entry in self.entries if _path(entry.table) == _path(table)]
        return self.of_entries(of_file) if of_file else self._of_other(table_lines(table))

    def _of_entry(self, entry: MeasuredEntryLike) -> MeasuredTable:
        """The table of an entry, read once; it must have the columns that the entry names."""
        names = self._names(entry)
        key = repr((entry.table, entry.time_offset, names))
        if key not in self._at_hand:
            self._at_hand[key] = _read(table_lines(entry.table), names, entry)
        measured = self._at_hand[key]
        for wanted, purpose in ((entry.rename, "to rename"), (entry.ignore, "to ignore")):
            missing = measured.missing(wanted)
            if missing:
                raise missing_columns_error(missing, purpose, measured.columns, measured.file)
        self._note(measured, entry)
        return measured

    def _of_other(self, lines: TableLines) -> list[Record]:
        """The runs of a table of no entry, each read as the entry of its name says."""
        of_run = {name: self._entry_of(name) for name in lines.runs(self.given.ignore)}
        result = {}
        for entry in _distinct(of_run.values()):
            names = self._names(entry)
            measured = _read(lines, names, entry)
            self._note(measured, entry)
            for run in measured.runs:
                if of_run.get(run.name) is entry:
                    result[run.name] = Record(self._later(run, measured), entry)
        return [result[name] for name in of_run if name in result]

    def _of_frame(self, frame: Any) -> list[Record]:
        """The runs of a frame; frames whose runs have no names are different runs."""
        lines = frame_lines(frame)
        result = self._of_other(lines)
        nameless = lines.runs(self.given.ignore) == (lines.name,)
        self._frames += nameless
        if not nameless or self._frames == 1:
            return result
        return [replace(each, run=replace(each.run, name=f"{lines.name} ({self._frames})")) for each in result]

    def _of_run(self, run: MeasuredRun) -> Record:
        entry = self._entry_of(run.name)
        names = self._names(entry)
        known = [*run.sensors, *run.channels, *(parts(heading)[0] for heading in run.channels)]
        self.columns += [*known, *(entry.rename.values() if entry else ())]
        shifted = run.shifted(0.0 if entry is None else entry.time_offset)
        renamed = shifted.without(names.ignore).renamed(names.rename)
        return Record(renamed.without(name for name in self.given.ignore if name not in known), entry)

    def _names(self, entry: MeasuredEntryLike | None) -> ColumnNames:
        """The given names, before those of an entry."""
        if entry is None:
            return self.given
        return ColumnNames({**entry.rename, **self.given.rename}, (*entry.ignore, *self.given.ignore))

    def _entry_of(self, run: str) -> MeasuredEntryLike | None:
        return next((entry for entry in self.entries if run == (entry.run or Path(entry.table).stem)), None)

    def _later(self, run: MeasuredRun, measured: MeasuredTable) -> MeasuredRun:
        """The run without sensors that are ignored by their new names."""
        return run.without(measured.missing(self.given.ignore))

    def _note(self, measured: MeasuredTable, entry: MeasuredEntryLike | None) -> None:
        self.columns += [*measured.columns, *measured.headings, *(entry.rename.values() if entry else ())]


def _read(lines: TableLines, names: ColumnNames, entry: MeasuredEntryLike | None) -> MeasuredTable:
    offset = 0.0 if entry is None else entry.time_offset
    return lines.read(time_offset=offset, rename=names.rename, ignore=names.ignore)


def _distinct(entries: Iterable[MeasuredEntryLike | None]) -> list[MeasuredEntryLike | None]:
    """Each entry once."""
    return list({id(entry): entry for entry in entries}.values())


def _path(table: str | Path) -> Path:
    """A file's path, however it is written."""
    return Path(table).resolve()
