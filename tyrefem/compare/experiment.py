"""The experiments of a comparison: each measured run with the drive it was driven at."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, cast

from tyrefem.compare.interface import MeasuredEntryLike, StudyLike
from tyrefem.compare.sensors import check_sensors, sensor_of
from tyrefem.errors import InputError, ResultWarning, nearest
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.study_effects import check_runs
from tyrefem.measured import MeasuredRun
from tyrefem.measured.frame import frame_lines, is_frame
from tyrefem.measured.heading import parts
from tyrefem.measured.names import ColumnNames, is_time_or_run, missing_columns_error
from tyrefem.measured.table import MeasuredTable, TableLines, table_lines

#: A CSV file, a pandas DataFrame with the same columns, a run already read, or several of these.
Table = Any


@dataclass(frozen=True, eq=False)
class Experiment:
    """A measured run and the data of its ``[[measured]]`` entry.

    Parameters
    ----------
    run : the measured histories, on the clock of the simulation.
    origin : the run's name in its table: effects that act in some runs only are stated with it.
    drive : dotted overrides of the study's drive for this run; empty = the study's own drive.
    noise : sensor -> K, standard deviation of a reading; without those of the sensors' cards.
    hold_out : whether no fit may use the run.
    entry : number of the entry; None: the study does not name the run.
    """

    run: MeasuredRun
    origin: str
    drive: Mapping[str, Any] = field(default_factory=dict)
    noise: Mapping[str, float] = field(default_factory=dict)
    hold_out: bool = False
    entry: int | None = None

    @classmethod
    def of(cls, run: MeasuredRun, entry: MeasuredEntryLike | None, number: int | None = None) -> Experiment:
        """A run, with the names of the study's sensors, as its entry says; None: a run that the study does not name.

        ``number``: of the entry.
        """
        if not run.sensors:
            raise InputError(f"run '{run.name}': every sensor is ignored", file=run.file)
        if entry is None:
            return cls(run, run.name)
        noise = {} if entry.noise is None else dict.fromkeys(run.sensors, entry.noise)
        return cls(run, run.name, dict(entry.drive), noise, entry.hold_out, number)

    @property
    def name(self) -> str:
        """The name among all runs: that of its table, with a number if others have it too."""
        return self.run.name

    def noise_of(self, sensor: str, study: StudyLike) -> float:
        """K, standard deviation of a reading of a sensor: that of the entry, else of the sensor's card."""
        return self.noise.get(sensor, sensor_of(study, sensor).noise)

    def joins(self, other: Experiment) -> bool:
        """Whether both are one run with two loggers: the same run at the same drive, with different sensors."""
        same = (self.origin, self.drive, self.hold_out) == (other.origin, other.drive, other.hold_out)
        return same and set(self.run.sensors).isdisjoint(other.run.sensors)

    def joined(self, other: Experiment) -> Experiment:
        """This run with the sensors of the other logger."""
        return replace(self, run=self.run.joined(other.run), noise={**self.noise, **other.noise})


def experiments(
    study: StudyLike,
    table: Table | None = None,
    *,
    ignore: Iterable[str] = (),
    rename: Mapping[str, str] | None = None,
) -> tuple[Experiment, ...]:
    """The runs to compare with: those of ``table``, or else of the study's ``[[measured]]`` entries.

    A run of a given table has the drive, noise, offset and column names of the entry with the same file or run name. A
    run without an entry is compared with the study's drive. Tables with the same run, at the same drive and with
    different sensors, are one run.

    Parameters
    ----------
    ignore : columns to leave out. rename : column -> sensor. Both act on every table, in addition to its entry.

    Raises
    ------
    InputError : no run; an effect is in a run that the study's tables do not have; an entry names a run that is not in
        the table, or is that of another entry; a column is no sensor of the study; no table has a column that is to be
        renamed or ignored.
    """
    given = ColumnNames.of(ignore=ignore, rename=rename)
    reader = _ExperimentReader(study.measured, given)
    planned = reader.of_entries(reader.entries) if table is None else reader.of_tables(table)
    given.require(reader.columns)
    if not planned:
        raise InputError("there is no measured run to compare with")
    check_sensors([experiment.run for experiment in planned], study)
    joined = _joined(planned)
    _warn_of_folders(joined, reader.nameless)
    distinct = _with_distinct_names(joined)
    if table is None and isinstance(study, StudyData):
        check_runs(study, [experiment.origin for experiment in distinct])
    return distinct


def driven_as(planned: Sequence[Experiment], study: StudyLike) -> tuple[Experiment, ...]:
    """The experiments with the drives in a study whose entries are of the same runs, such as an amended study."""
    entries = study.measured
    return tuple(
        each if each.entry is None else replace(each, drive=dict(entries[each.entry].drive)) for each in planned
    )


def driven(study: StudyLike, experiment: Experiment) -> StudyLike:
    """The study at the drive of an experiment, with the effects that act in its run."""
    if acting_in(study, experiment) or (isinstance(study, StudyData) and study.card.run is not None):
        return cast(StudyData, study).at_run(experiment.origin, experiment.drive)
    return study.with_drive(dict(experiment.drive)) if experiment.drive else study


def acting_in(study: StudyLike, experiment: Experiment) -> tuple[int, ...]:
    """Numbers of the study's effects that act in some runs only, and in that of the experiment."""
    effects = study.card.effects if isinstance(study, StudyData) else ()
    return tuple(i for i, effect in enumerate(effects) if effect.runs and effect.acts_in(experiment.origin))


def _joined(experiments: Sequence[Experiment]) -> list[Experiment]:
    """The experiments; runs that several loggers recorded have the sensors of all."""
    result: list[Experiment] = []
    for experiment in experiments:
        place = next((i for i, before in enumerate(result) if before.joins(experiment)), None)
        if place is None:
            result.append(experiment)
        else:
            result[place] = result[place].joined(experiment)
    return result


def _warn_of_folders(joined: Sequence[Experiment], nameless: Mapping[str, Sequence[object]]) -> None:
    """Warn of files in several folders that are one run only because they have the same name."""
    for name, tables in nameless.items():
        files = [table for table in tables if isinstance(table, Path)]
        if len(files) > 1 and len([each for each in joined if each.origin == name]) < len(files):
            named = " and ".join(map(str, files))
            warnings.warn(
                f"{named} are taken as one run '{name}' with {len(files)} loggers: "
                f"say run = '{name}' in their entries, or give different runs different names",
                ResultWarning,
                stacklevel=4,
            )


def _with_distinct_names(experiments: Sequence[Experiment]) -> tuple[Experiment, ...]:
    """The experiments with distinct names; two records of the same sensors in one run stay apart."""
    names: set[str] = {experiment.origin for experiment in experiments}
    used: set[str] = set()
    result = []
    for experiment in experiments:
        name, number = experiment.origin, 1
        while name in used or (number > 1 and name in names):
            number += 1
            name = f"{experiment.origin} ({number})"
        used.add(name)
        result.append(replace(experiment, run=replace(experiment.run, name=name)))
    return tuple(result)


class _ExperimentReader:
    """Reads tables by entries and given names. ``columns``: names and headings of all columns read."""

    def __init__(self, entries: Sequence[MeasuredEntryLike], given: ColumnNames) -> None:
        self.entries, self.given = entries, given
        self.columns: list[str] = []
        self._at_hand: dict[str, MeasuredTable] = {}
        self._lines: dict[Path, TableLines] = {}
        #: Columns of times and runs that are called otherwise, in any table.
        self._times_and_runs = {
            column: name
            for names in (*(entry.rename for entry in entries), given.rename)
            for column, name in names.items()
            if is_time_or_run(name)
        }
        #: Name that a table without names of runs gives to its run -> such tables, in the order of reading.
        self.nameless: dict[str, list[object]] = {}

    def of_entries(self, entries: Sequence[MeasuredEntryLike]) -> list[Experiment]:
        """The runs of entries; one without ``run`` has those runs of its table that no other entry names."""
        named: dict[Path, list[str | None]] = {}
        drives: list[tuple[Path, str | None, dict[str, Any]]] = []
        for entry in entries:
            named.setdefault(_path(entry.table), []).append(entry.run)
            compared = _path(entry.table), entry.run, dict(entry.drive)
            if compared in drives:
                which = "all runs" if entry.run is None else f"run '{entry.run}'"
                hint = "; give each entry its 'run'" if entry.run is None else ""
                wrong = f"two entries for {which} of this table at the same drive{hint}"
                raise InputError(wrong, field="measured.run", file=entry.table)
            drives.append(compared)
        result = []
        for entry in entries:
            measured = self._of_entry(entry)
            names = [run.name for run in measured.runs]
            if entry.run is not None and entry.run not in names:
                wrong = f"no run '{entry.run}'{nearest(entry.run, names)}"
                raise InputError(wrong, field="measured.run", file=entry.table)
            wanted = {entry.run} if entry.run is not None else {*names} - {*named[_path(entry.table)]}
            planned = [
                self._experiment(self._later(run, measured), entry) for run in measured.runs if run.name in wanted
            ]
            result += (
                planned
                if entry.run is not None
                else self._apart(planned, self._lines_of(entry.table), self._names(entry))
            )
        return result

    def of_tables(self, table: Table) -> list[Experiment]:
        """The runs of one or several tables."""
        alone = isinstance(table, str | Path | MeasuredRun) or is_frame(table)
        if not alone and not isinstance(table, Sequence):
            raise _no_table(table)
        return [experiment for each in ((table,) if alone else table) for experiment in self._of_table(each)]

    def _of_table(self, table: Any) -> list[Experiment]:
        """The runs of a file, a frame or a run already read."""
        if isinstance(table, MeasuredRun):
            return [self._of_run(table)]
        if is_frame(table):
            return self._of_frame(table)
        if not isinstance(table, str | Path):
            raise _no_table(table)
        of_file = [entry for entry in self.entries if _path(entry.table) == _path(table)]
        if of_file:
            return self.of_entries(of_file)
        lines = self._lines_of(table)
        return self._apart(self._of_other(lines), lines, self.given)

    def _lines_of(self, table: str | Path) -> TableLines:
        """The rows of a file, read once."""
        path = _path(table)
        if path not in self._lines:
            self._lines[path] = table_lines(table, self._times_and_runs)
        return self._lines[path]

    def _of_entry(self, entry: MeasuredEntryLike) -> MeasuredTable:
        """The table of an entry, read once; it must have the columns that the entry names."""
        names = self._names(entry)
        key = repr((entry.table, entry.time_offset, names))
        if key not in self._at_hand:
            self._at_hand[key] = _read(self._lines_of(entry.table), names, entry)
        measured = self._at_hand[key]
        for wanted, purpose in ((entry.rename, "to rename"), (entry.ignore, "to ignore")):
            missing = measured.missing(wanted)
            if missing:
                raise missing_columns_error(missing, purpose, measured.columns, measured.file)
        self._note(measured, entry)
        return measured

    def _of_other(self, lines: TableLines) -> list[Experiment]:
        """The runs of a table of no entry, each read as the entry of its name says."""
        of_run = {name: self._entry_of(name) for name in lines.runs(self.given)}
        result = {}
        for entry in _distinct(of_run.values()):
            names = self._names(entry)
            measured = _read(lines, names, entry)
            self._note(measured, entry)
            for run in measured.runs:
                if of_run.get(run.name) is entry:
                    result[run.name] = self._experiment(self._later(run, measured), entry)
        return [result[name] for name in of_run if name in result]

    def _of_frame(self, frame: Any) -> list[Experiment]:
        """The runs of a frame."""
        lines = frame_lines(frame, self._times_and_runs)
        return self._apart(self._of_other(lines), lines, self.given)

    def _apart(self, planned: list[Experiment], lines: TableLines, names: ColumnNames) -> list[Experiment]:
        """The runs of a table; frames whose runs have no names are different runs, files have their own name."""
        if lines.runs(names) != (lines.name,):
            return planned
        tables = self.nameless.setdefault(lines.name, [])
        table: object = lines if lines.in_memory else _path(lines.file)
        if table not in tables:
            tables.append(table)
        number = tables.index(table) + 1
        if number == 1 or not lines.in_memory:
            return planned
        return [replace(each, origin=f"{lines.name} ({number})") for each in planned]

    def _of_run(self, run: MeasuredRun) -> Experiment:
        """A run already read, as the entry of its name says."""
        entry = self._entry_of(run.name)
        names = self._names(entry)
        known = [*run.sensors, *run.channels, *(parts(heading)[0] for heading in run.channels)]
        self.columns += [*known, *(entry.rename.values() if entry else ())]
        shifted = run.shifted(0.0 if entry is None else entry.time_offset)
        renamed = shifted.without(names.ignore).renamed(names.rename)
        return self._experiment(renamed.without(name for name in self.given.ignore if name not in known), entry)

    def _experiment(self, run: MeasuredRun, entry: MeasuredEntryLike | None) -> Experiment:
        """The run as its entry says."""
        return Experiment.of(run, entry, next((n for n, each in enumerate(self.entries) if each is entry), None))

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
    """Each entry once; entries with equal content are different entries."""
    result: list[MeasuredEntryLike | None] = []
    for entry in entries:
        if not any(entry is before for before in result):
            result.append(entry)
    return result


def _path(table: str | Path) -> Path:
    """A file's path, however it is written; what cannot be a path is refused when it is read."""
    try:
        return Path(table).resolve()
    except (OSError, RuntimeError, ValueError):
        return Path(table).absolute()


def _no_table(table: object) -> InputError:
    return InputError(
        f"a value of type {type(table).__name__} is no measured table; allowed: the path of a CSV file or workbook, a "
        "pandas DataFrame with 'time [s]' and sensors like 'crown [degC]', a MeasuredRun, or a list of these",
        field="table",
    )
