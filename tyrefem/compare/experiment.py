"""The experiments of a comparison: each measured run with the drive it was driven at."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from tyrefem.compare.interface import MeasuredEntry, StudyLike
from tyrefem.errors import InputError, nearest
from tyrefem.measured import MeasuredRun, read_table

#: Temperatures that are computed with the sensors and measured like them, but at no place in the rubber.
OUTSIDE_THE_RUBBER = ("contained-air", "rim")
Table = str | Path | MeasuredRun | Sequence[MeasuredRun]


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

    A run of a given table takes drive, noise and offset from the entry of the same file, or of the same run
    name; a run without an entry is compared with the study's own drive.

    Raises
    ------
    InputError : no table; an entry names a run that the table lacks; a column is no sensor of the study.
    """
    ignored = tuple(ignore)
    if table is None and not study.measured:
        raise InputError(f"study '{study.name}' has no [[measured]] table; name a table to compare with")
    own = list(study.measured) if table is None else []
    runs: Sequence[MeasuredRun] = ()
    if isinstance(table, str | Path):
        own = [entry for entry in study.measured if Path(entry.table).absolute() == Path(table).absolute()]
        runs = () if own else read_table(table, rename=rename, ignore=ignored)
    elif table is not None:
        runs = [table] if isinstance(table, MeasuredRun) else table
    found = [one for entry in own for one in _of_entry(entry, ignored, rename)]
    found += [_matched(run, study) for run in runs]
    if not found:
        raise InputError("there is no measured run to compare with")
    found = [_without(one, ignored) for one in found]
    for one in found:
        _known_sensors(one.run, study)
    return _distinct(found)


def _of_entry(entry: MeasuredEntry, ignore: tuple[str, ...], rename: Mapping[str, str] | None) -> list[Experiment]:
    runs = read_table(entry.table, time_offset=entry.time_offset, rename=rename, ignore=ignore)
    names = [run.name for run in runs]
    if entry.run is not None and entry.run not in names:
        wrong = f"no run '{entry.run}'{nearest(entry.run, names)}"
        raise InputError(wrong, field="measured.run", file=entry.table)
    return [
        Experiment(run, dict(entry.drive), entry.noise, entry.hold_out) for run in runs if entry.run in (None, run.name)
    ]


def _matched(run: MeasuredRun, study: StudyLike) -> Experiment:
    for entry in study.measured:
        if run.name == (entry.run or Path(entry.table).stem):
            shifted = run.shifted(entry.time_offset)
            return Experiment(shifted, dict(entry.drive), entry.noise, entry.hold_out)
    return Experiment(run)


def _without(one: Experiment, ignore: tuple[str, ...]) -> Experiment:
    kept = [sensor for sensor in one.run.sensors if sensor not in ignore]
    if not kept:
        raise InputError(f"run '{one.name}': every sensor is ignored", file=one.run.file)
    return replace(one, run=replace(one.run, temperatures=one.run.temperatures[kept]))


def _known_sensors(run: MeasuredRun, study: StudyLike) -> None:
    allowed = {*study.sensors, *OUTSIDE_THE_RUBBER}
    for sensor in run.sensors:
        if sensor not in allowed:
            raise InputError(
                f"column '{sensor}' is no sensor of study '{study.name}'{nearest(sensor, allowed)}; "
                "rename it, or ignore it",
                file=run.file,
            )


def _distinct(found: Sequence[Experiment]) -> tuple[Experiment, ...]:
    """The same experiments with no run name twice: two loggers on one run are two runs."""
    taken: dict[str, int] = {}
    result = []
    for one in found:
        taken[one.name] = taken.get(one.name, 0) + 1
        name = one.name if taken[one.name] == 1 else f"{one.name} ({taken[one.name]})"
        result.append(replace(one, run=replace(one.run, name=name)))
    return tuple(result)
