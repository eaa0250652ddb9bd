"""The experiments of a comparison: each measured run with the drive it was driven at."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from tyrefem.compare.interface import MeasuredEntryLike, StudyLike
from tyrefem.errors import InputError, nearest, quoted
from tyrefem.measured import MeasuredRun
from tyrefem.measured.columns import parts
from tyrefem.measured.frame import frame_table, is_frame
from tyrefem.measured.table import MeasuredTable, missing_columns_error, read

#: Temperatures that are computed with the sensors and measured like them, but at no place in the rubber.
OUTSIDE_THE_RUBBER = ("contained-air", "rim")
#: A CSV file, a pandas DataFrame with the same columns, a run already read, or several of these.
Table = Any


@dataclass(frozen=True, eq=False)
class Experiment:
    """A measured run and what the study says of it.

    Parameters
    ----------
    run : the measured histories, on the clock of the simulation.
    drive : dotted overrides of the study's drive for this run; empty = the study's own drive.
    noise : K, standard deviation of a reading; None = what each sensor's card says.
    hold_out : whether the run is kept from every fit.
    """

    run: MeasuredRun
    drive: Mapping[str, Any] = field(default_factory=dict)
    noise: float | None = None
    hold_out: bool = False

    @property
    def name(self) -> str:
        """The run's name."""
        return self.run.name


def experiments(
    study: StudyLike,
    table: Table | None = None,
    *,
    ignore: Iterable[str] = (),
    rename: Mapping[str, str] | None = None,
) -> tuple[Experiment, ...]:
    """The runs to compare with: those of ``table``, else of the study's own ``[[measured]]`` entries.

    A run of a given table takes drive, noise, offset and names of columns from the entry of the same file, or of the
    same run name; a run without an entry is compared with the study's own drive.

    Parameters
    ----------
    ignore : columns to leave out. rename : column -> sensor. Both act on every table, beside what its entry says.

    Raises
    ------
    InputError : no run; an entry names a run that the table lacks; columns that are no sensors of the study; a
        column to rename or to ignore that no table has.
    """
    given = ColumnNames(dict(rename or {}), tuple(ignore))
    entries = list(study.measured) if table is None else []
    runs: list[MeasuredRun] = []
    columns: list[str] = []
    for each in _listed(table):
        if isinstance(each, MeasuredRun):
            runs.append(each.renamed(given.rename))
            columns += each.sensors
            continue
        known = [entry for entry in study.measured if _is_file(each, entry.table)]
        entries += known
        if not known:
            whole = _whole(each, given)
            runs += whole.runs
            columns += [*whole.columns, *whole.headings]
    at_hand: dict[str, MeasuredTable] = {}
    tables = [(entry, _table(entry, given, at_hand)) for entry in entries]
    for entry, whole in tables:
        columns += [*whole.columns, *whole.headings, *entry.rename.values()]
    given.require(columns)
    planned = [experiment for entry, whole in tables for experiment in _of_entry(entry, whole)]
    planned += [_matched(run, study) for run in runs]
    if not planned:
        raise InputError("there is no measured run to compare with")
    planned = [_without(experiment, given.ignore) for experiment in planned]
    _known_sensors([experiment.run for experiment in planned], study)
    return _distinct(planned)


def _listed(table: Table | None) -> Sequence[Any]:
    """The tables and runs of what was given: one, several or none."""
    if table is None:
        return ()
    if isinstance(table, str | Path | MeasuredRun) or is_frame(table):
        return (table,)
    if isinstance(table, Sequence):
        return table
    raise _no_table(table)


def _is_file(table: Any, file: str | Path) -> bool:
    return isinstance(table, str | Path) and Path(table).absolute() == Path(file).absolute()


def _whole(table: Any, given: ColumnNames) -> MeasuredTable:
    """A file's or a frame's runs."""
    if is_frame(table):
        return frame_table(table, rename=given.rename, ignore=given.ignore)
    if isinstance(table, str | Path):
        return read(table, rename=given.rename, ignore=given.ignore)
    raise _no_table(table)


def _no_table(table: object) -> InputError:
    return InputError(
        f"a value of type {type(table).__name__} is no measured table; allowed: a CSV file's path, a pandas DataFrame "
        "with 'time [s]' and sensors like 'crown [degC]', a MeasuredRun, or a list of these"
    )


@dataclass(frozen=True)
class ColumnNames:
    """What the caller says of all tables: ``rename``, column -> sensor, and columns to ``ignore``."""

    rename: Mapping[str, str]
    ignore: tuple[str, ...]

    def require(self, columns: Sequence[str]) -> None:
        """Refuse names that no table has."""
        for names, purpose in ((self.rename, "to rename"), (self.ignore, "to ignore")):
            missing = [name for name in names if name not in {*columns, *self.rename.values()}]
            if missing:
                raise missing_columns_error(missing, purpose, dict.fromkeys(parts(name)[0] for name in columns))


def _table(entry: MeasuredEntryLike, given: ColumnNames, at_hand: dict[str, MeasuredTable]) -> MeasuredTable:
    """An entry's table, read once; its own names of columns must be there, those given for all tables may be."""
    rename, ignore = {**entry.rename, **given.rename}, (*entry.ignore, *given.ignore)
    key = repr((entry.table, entry.time_offset, rename, ignore))
    if key not in at_hand:
        at_hand[key] = read(entry.table, time_offset=entry.time_offset, rename=rename, ignore=ignore)
    whole = at_hand[key]
    for names, purpose in ((entry.rename, "to rename"), (entry.ignore, "to ignore")):
        missing = whole.missing(names)
        if missing:
            raise missing_columns_error(missing, purpose, whole.columns, whole.file)
    return whole


def _of_entry(entry: MeasuredEntryLike, whole: MeasuredTable) -> list[Experiment]:
    names = [run.name for run in whole.runs]
    if entry.run is not None and entry.run not in names:
        wrong = f"no run '{entry.run}'{nearest(entry.run, names)}"
        raise InputError(wrong, field="measured.run", file=entry.table)
    return [
        Experiment(run, dict(entry.drive), entry.noise, entry.hold_out)
        for run in whole.runs
        if entry.run in (None, run.name)
    ]


def _matched(run: MeasuredRun, study: StudyLike) -> Experiment:
    for entry in study.measured:
        if run.name == (entry.run or Path(entry.table).stem):
            shifted = run.shifted(entry.time_offset).renamed(entry.rename)
            return _without(Experiment(shifted, dict(entry.drive), entry.noise, entry.hold_out), tuple(entry.ignore))
    return Experiment(run)


def _without(experiment: Experiment, ignore: tuple[str, ...]) -> Experiment:
    kept = [sensor for sensor in experiment.run.sensors if sensor not in ignore]
    if not kept:
        raise InputError(f"run '{experiment.name}': every sensor is ignored", file=experiment.run.file)
    return replace(experiment, run=replace(experiment.run, temperatures=experiment.run.temperatures[kept]))


def _known_sensors(runs: Sequence[MeasuredRun], study: StudyLike) -> None:
    """Refuse columns that are no sensors, all of them at once, and a sensor's column in a unit of no temperature."""
    allowed = {*study.sensors, *OUTSIDE_THE_RUBBER}
    unknown: dict[str, list[MeasuredRun]] = {}
    for run in runs:
        for sensor in run.sensors:
            if sensor not in allowed:
                unknown.setdefault(sensor, []).append(run)
        for heading in run.channels:
            if parts(heading)[0] in allowed:
                raise InputError(f"column '{heading}': a sensor's unit is degC, degF or K", file=run.file)
    if not unknown:
        return
    files = {run.file for runs_with in unknown.values() for run in runs_with}
    file = next(iter(files)) if len(files) == 1 else None
    names = sorted(path.name for path in files if path is not None)
    where = f" (in {', '.join(names)})" if len(names) > 1 else ""
    if len(unknown) == 1:
        (column,) = unknown
        wrong = f"column '{column}'{where} is no sensor of study '{study.name}'{nearest(column, allowed)}"
        raise InputError(f"{wrong}; rename it, or ignore it", file=file)
    raise InputError(
        f"columns {quoted(unknown, allowed)}{where} are no sensors of study '{study.name}'; allowed: "
        f"{', '.join(sorted(allowed))}; rename them, or ignore them",
        file=file,
    )


def _distinct(experiments: Sequence[Experiment]) -> tuple[Experiment, ...]:
    """The same experiments with no run name twice: two loggers on one run are two runs."""
    taken: dict[str, int] = {}
    result = []
    for experiment in experiments:
        taken[experiment.name] = taken.get(experiment.name, 0) + 1
        name = experiment.name if taken[experiment.name] == 1 else f"{experiment.name} ({taken[experiment.name]})"
        result.append(replace(experiment, run=replace(experiment.run, name=name)))
    return tuple(result)
