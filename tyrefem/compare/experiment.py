"""The experiments of a comparison: each measured run with the drive it was driven at."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, cast

from tyrefem.compare.interface import MeasuredEntryLike, SensorLike, StudyLike
from tyrefem.errors import InputError, nearest, quoted
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.study_card import Sensor
from tyrefem.inputs.study_effects import check_runs
from tyrefem.measured import MeasuredRun
from tyrefem.measured.columns import parts
from tyrefem.measured.frame import frame_table, is_frame
from tyrefem.measured.names import ColumnNames, missing_columns_error
from tyrefem.measured.table import MeasuredTable, read

#: Temperatures that are computed with the sensors and measured like them, but at no place in the rubber.
OUTSIDE_THE_RUBBER = ("contained-air", "rim")


@dataclass(frozen=True)
class SensorWithoutCard:
    """Standard uncertainties of a reading outside the rubber: the defaults of a sensor's card, and no position."""

    noise: float = Sensor.model_fields["noise"].default
    accuracy: float = Sensor.model_fields["accuracy"].default
    position_sd: float = 0.0


#: A CSV file, a pandas DataFrame with the same columns, a run already read, or several of these.
Table = Any


@dataclass(frozen=True, eq=False)
class Experiment:
    """A measured run and the data of its ``[[measured]]`` entry.

    Parameters
    ----------
    run : the measured histories, on the clock of the simulation.
    drive : dotted overrides of the study's drive for this run; empty = the study's own drive.
    noise : K, standard deviation of a reading; None = the noise of each sensor's card.
    hold_out : whether no fit may use the run.
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
    """The runs to compare with: those of ``table``, or else of the study's ``[[measured]]`` entries.

    A run of a given table has the drive, noise, offset and column names of the entry with the same file or run name. A
    run without an entry is compared with the study's drive.

    Parameters
    ----------
    ignore : columns to leave out. rename : column -> sensor. Both act on every table, in addition to its entry.

    Raises
    ------
    InputError : no run; an effect is in a run that the study's tables do not have; an entry names a run that is not in
        the table; a column is no sensor of the study; no table has a column that is to be renamed or ignored.
    """
    given = ColumnNames.of(ignore=ignore, rename=rename)
    entries = list(study.measured) if table is None else []
    runs: list[MeasuredRun] = []
    columns: list[str] = []
    for each in _listed(table):
        if isinstance(each, MeasuredRun):
            runs.append(each.renamed(given.rename))
            columns += [*each.sensors, *each.channels, *(parts(heading)[0] for heading in each.channels)]
            continue
        known = [entry for entry in study.measured if _is_file(each, entry.table)]
        entries += known
        if not known:
            measured = _measured_table(each, given)
            runs += measured.runs
            columns += [*measured.columns, *measured.headings]
    at_hand: dict[str, MeasuredTable] = {}
    tables = [(entry, _table(entry, given, at_hand)) for entry in entries]
    for entry, measured in tables:
        columns += [*measured.columns, *measured.headings, *entry.rename.values()]
    given.require(columns)
    planned = [experiment for entry, measured in tables for experiment in _of_entry(entry, measured)]
    planned += [_with_entry(run, study) for run in runs]
    if not planned:
        raise InputError("there is no measured run to compare with")
    planned = [_without_columns(experiment, given.ignore) for experiment in planned]
    _check_sensors([experiment.run for experiment in planned], study)
    distinct = _with_distinct_names(planned)
    if table is None and isinstance(study, StudyData):
        check_runs(study, [experiment.name for experiment in distinct])
    return distinct


def sensor_of(study: StudyLike, name: str) -> SensorLike:
    """Standard uncertainties of a sensor; those of contained air and rim, if the study gives them no card."""
    return study.sensors.get(name, SensorWithoutCard())


def driven(study: StudyLike, experiment: Experiment) -> StudyLike:
    """The study at the drive of an experiment, with the effects that act in its run."""
    if acting_in(study, experiment) or (isinstance(study, StudyData) and study.card.run is not None):
        return cast(StudyData, study).at_run(experiment.name, experiment.drive)
    return study.with_drive(dict(experiment.drive)) if experiment.drive else study


def acting_in(study: StudyLike, experiment: Experiment) -> tuple[int, ...]:
    """Numbers of the study's effects that act in some runs only, and in that of the experiment."""
    effects = study.card.effects if isinstance(study, StudyData) else ()
    return tuple(i for i, effect in enumerate(effects) if effect.runs and effect.acts_in(experiment.name))


def _listed(table: Table | None) -> Sequence[Any]:
    """The given tables and runs as a sequence."""
    if table is None:
        return ()
    if isinstance(table, str | Path | MeasuredRun) or is_frame(table):
        return (table,)
    if isinstance(table, Sequence):
        return table
    raise _no_table(table)


def _is_file(table: Any, file: str | Path) -> bool:
    return isinstance(table, str | Path) and Path(table).absolute() == Path(file).absolute()


def _measured_table(table: Any, given: ColumnNames) -> MeasuredTable:
    """The table of a file or a data frame."""
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


def _table(entry: MeasuredEntryLike, given: ColumnNames, at_hand: dict[str, MeasuredTable]) -> MeasuredTable:
    """The table of an entry, read once; it must have the columns that the entry names."""
    rename, ignore = {**entry.rename, **given.rename}, (*entry.ignore, *given.ignore)
    key = repr((entry.table, entry.time_offset, rename, ignore))
    if key not in at_hand:
        at_hand[key] = read(entry.table, time_offset=entry.time_offset, rename=rename, ignore=ignore)
    measured = at_hand[key]
    for names, purpose in ((entry.rename, "to rename"), (entry.ignore, "to ignore")):
        missing = measured.missing(names)
        if missing:
            raise missing_columns_error(missing, purpose, measured.columns, measured.file)
    return measured


def _of_entry(entry: MeasuredEntryLike, measured: MeasuredTable) -> list[Experiment]:
    names = [run.name for run in measured.runs]
    if entry.run is not None and entry.run not in names:
        wrong = f"no run '{entry.run}'{nearest(entry.run, names)}"
        raise InputError(wrong, field="measured.run", file=entry.table)
    return [
        Experiment(run, dict(entry.drive), entry.noise, entry.hold_out)
        for run in measured.runs
        if entry.run in (None, run.name)
    ]


def _with_entry(run: MeasuredRun, study: StudyLike) -> Experiment:
    for entry in study.measured:
        if run.name == (entry.run or Path(entry.table).stem):
            shifted = run.shifted(entry.time_offset).renamed(entry.rename)
            return _without_columns(
                Experiment(shifted, dict(entry.drive), entry.noise, entry.hold_out), tuple(entry.ignore)
            )
    return Experiment(run)


def _without_columns(experiment: Experiment, ignore: tuple[str, ...]) -> Experiment:
    kept = [sensor for sensor in experiment.run.sensors if sensor not in ignore]
    if not kept:
        raise InputError(f"run '{experiment.name}': every sensor is ignored", file=experiment.run.file)
    channels = tuple(text for text in experiment.run.channels if not {text, parts(text)[0]} & set(ignore))
    run = replace(experiment.run, temperatures=experiment.run.temperatures[kept], channels=channels)
    return replace(experiment, run=run)


def _check_sensors(runs: Sequence[MeasuredRun], study: StudyLike) -> None:
    """Raises InputError for all columns that are no sensors, and for a sensor's column without a temperature unit."""
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


def _with_distinct_names(experiments: Sequence[Experiment]) -> tuple[Experiment, ...]:
    """The experiments with distinct run names; the records of two loggers of one run are two runs."""
    taken: dict[str, int] = {}
    result = []
    for experiment in experiments:
        taken[experiment.name] = taken.get(experiment.name, 0) + 1
        name = experiment.name if taken[experiment.name] == 1 else f"{experiment.name} ({taken[experiment.name]})"
        result.append(replace(experiment, run=replace(experiment.run, name=name)))
    return tuple(result)
