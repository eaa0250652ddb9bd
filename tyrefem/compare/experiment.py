"""The experiments of a comparison: each measured run with the drive it was driven at."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, cast

from tyrefem.compare.interface import SensorLike, StudyLike
from tyrefem.compare.records import Record, Table, records
from tyrefem.errors import InputError, nearest, quoted
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.study_card import Sensor
from tyrefem.inputs.study_effects import check_runs
from tyrefem.measured import MeasuredRun
from tyrefem.measured.columns import parts
from tyrefem.measured.names import ColumnNames

#: Temperatures that are computed with the sensors and measured like them, but at no place in the rubber.
OUTSIDE_THE_RUBBER = ("contained-air", "rim")


@dataclass(frozen=True)
class SensorWithoutCard:
    """Standard uncertainties of a reading outside the rubber: the defaults of a sensor's card, and no position."""

    noise: float = Sensor.model_fields["noise"].default
    accuracy: float = Sensor.model_fields["accuracy"].default
    position_sd: float = 0.0


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
    """

    run: MeasuredRun
    origin: str
    drive: Mapping[str, Any] = field(default_factory=dict)
    noise: Mapping[str, float] = field(default_factory=dict)
    hold_out: bool = False

    @classmethod
    def of(cls, record: Record) -> Experiment:
        """The experiment of a run and its entry."""
        run, entry = record.run, record.entry
        if not run.sensors:
            raise InputError(f"run '{run.name}': every sensor is ignored", file=run.file)
        if entry is None:
            return cls(run, run.name)
        noise = {} if entry.noise is None else dict.fromkeys(run.sensors, entry.noise)
        return cls(run, run.name, dict(entry.drive), noise, entry.hold_out)

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
    planned = [Experiment.of(record) for record in records(study.measured, table, given)]
    if not planned:
        raise InputError("there is no measured run to compare with")
    _check_sensors([experiment.run for experiment in planned], study)
    distinct = _with_distinct_names(_joined(planned))
    if table is None and isinstance(study, StudyData):
        check_runs(study, [experiment.origin for experiment in distinct])
    return distinct


def sensor_of(study: StudyLike, name: str) -> SensorLike:
    """Standard uncertainties of a sensor; those of contained air and rim, if the study gives them no card."""
    return study.sensors.get(name, SensorWithoutCard())


def driven(study: StudyLike, experiment: Experiment) -> StudyLike:
    """The study at the drive of an experiment, with the effects that act in its run."""
    if acting_in(study, experiment) or (isinstance(study, StudyData) and study.card.run is not None):
        return cast(StudyData, study).at_run(experiment.origin, experiment.drive)
    return study.with_drive(dict(experiment.drive)) if experiment.drive else study


def acting_in(study: StudyLike, experiment: Experiment) -> tuple[int, ...]:
    """Numbers of the study's effects that act in some runs only, and in that of the experiment."""
    effects = study.card.effects if isinstance(study, StudyData) else ()
    return tuple(i for i, effect in enumerate(effects) if effect.runs and effect.acts_in(experiment.origin))


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
