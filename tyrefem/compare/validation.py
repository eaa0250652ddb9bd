"""Simulate what was measured and compare: the way from a study and a table to a `Comparison`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING

from tyrefem.compare.comparison import Comparison, comparison_of
from tyrefem.compare.experiment import Experiment, Table, experiments
from tyrefem.compare.history import histories
from tyrefem.compare.interface import PhaseLike, ResultLike, StudyLike
from tyrefem.errors import InputError

if TYPE_CHECKING:
    import pandas as pd


def compare(
    study: StudyLike,
    table: Table | None = None,
    result: ResultLike | None = None,
    *,
    inputs: bool = True,
    ignore: Iterable[str] = (),
    rename: Mapping[str, str] | None = None,
    k: float = 2.0,
    executor: Executor | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Comparison:
    """Deviations between a study and measured temperature histories, E = computed - measured.

    Parameters
    ----------
    study : the study; its sensors give names, noise, accuracy and uncertainty of position.
    table : CSV file (see `tyrefem.measured.read_table`) or runs already read; None = the study's own
        ``[[measured]]`` entries, with their drives, noise and offsets.
    result : the study's result if it is known; used for every run that was driven at the study's own drive,
        and for a single run in any case if it comes from another (amended, other drive) study.
    inputs : run the study again with each quantity of ``study.uncertainty`` one standard deviation higher.
    ignore : columns of the table to leave out. ``rename`` : column name -> sensor name.
    k : coverage factor of the verdict; 2 for about 95 %.
    executor : runs the simulations side by side (`concurrent.futures.ProcessPoolExecutor` or alike).
    progress : called with (simulations done, simulations in all) after each.

    Raises
    ------
    InputError : the table cannot be read, a column is no sensor, no measured time is within the simulated span.

    Source: ASME V&V 20-2009; equations and simplifications in docs/validation.md.
    """
    if not 0.0 < k < 100.0:
        raise InputError(f"the coverage factor k must be more than 0 and less than 100, not {k!r}")
    planned = experiments(study, table, ignore=ignore, rename=rename)
    keys = dict(study.uncertainty) if inputs else {}
    solved = _solved(study, planned, result, keys, executor, progress)
    found, curves, notes = [], {}, []
    for experiment in planned:
        computed, perturbed = solved[_drive(experiment)]
        own, outside = histories(experiment, study, computed, perturbed)
        found += own
        curves[experiment.name] = computed.readings
        notes += _outside(experiment, computed, outside)
    if not found:
        raise InputError("no measured time is within the simulated span: " + "; ".join(notes))
    notes += _unstated(study, planned, inputs)
    return comparison_of(study.name, found, curves=curves, relative_sd=keys, notes=tuple(notes), k=k)


def _drive(experiment: Experiment) -> str:
    """Experiments at the same drive share their simulations."""
    return repr(sorted(experiment.drive.items()))


@dataclass(frozen=True, eq=False)
class Computed:
    """What a comparison needs of a result; unlike a result, small enough to come from another process."""

    study: StudyLike
    readings: pd.DataFrame
    gradient_at_sensors: pd.DataFrame
    phases: Sequence[PhaseLike]


def _run(study: StudyLike) -> ResultLike:
    result = study.run()
    return Computed(study, result.readings, result.gradient_at_sensors, result.phases)


def _solved(
    study: StudyLike,
    planned: Sequence[Experiment],
    result: ResultLike | None,
    keys: Mapping[str, float],
    executor: Executor | None,
    progress: Callable[[int, int], None] | None,
) -> dict[str, tuple[ResultLike, dict[str, ResultLike]]]:
    """Drive -> its result, and its results with each uncertain input one sd higher."""
    known: dict[str, ResultLike] = {}
    studies: dict[tuple[str, str | None], StudyLike] = {}
    for experiment in planned:
        drive = _drive(experiment)
        if drive in known or (drive, None) in studies:
            continue
        driven = study.with_drive(dict(experiment.drive)) if experiment.drive else study
        amended = result is not None and len(planned) == 1 and result.study is not study
        if result is not None and (not experiment.drive or amended):
            known[drive] = result
            driven = result.study
        else:
            studies[drive, None] = driven
        studies |= {(drive, key): driven.scaled(key, 1.0 + sd) for key, sd in keys.items()}
    each = executor.map if executor is not None else map
    results: dict[tuple[str, str | None], ResultLike] = {}
    for what, computed in zip(studies, each(_run, studies.values()), strict=True):
        results[what] = computed
        if progress is not None:
            progress(len(results), len(studies))
    known |= {drive: found for (drive, key), found in results.items() if key is None}
    return {drive: (computed, {key: results[drive, key] for key in keys}) for drive, computed in known.items()}


def _outside(experiment: Experiment, computed: ResultLike, outside: int) -> list[str]:
    if not outside:
        return []
    total = len(experiment.run.times)
    first, last = computed.readings["time_s"].iloc[[0, -1]]
    level = "ERROR" if 2 * outside > total else "Note"
    return [
        f"{level}: run '{experiment.name}': {outside} of {total} measured times lie outside the simulated span "
        f"{first:g} to {last:g} s and are not compared"
    ]


def _unstated(study: StudyLike, planned: Sequence[Experiment], inputs: bool) -> list[str]:
    """What the uncertainty leaves out, because nobody stated it."""
    notes = []
    if not study.uncertainty:
        notes.append("Note: the study states no uncertainty of its inputs, so u_input is 0")
    elif not inputs:
        notes.append("Note: the uncertainty of the inputs was left out, so u_input is 0")
    silent = {
        sensor: None
        for experiment in planned
        for sensor in experiment.run.sensors
        if not experiment.noise
        and (experiment.noise is not None or not getattr(study.sensors.get(sensor), "noise", 0.0))
    }
    if silent:
        notes.append(f"Note: no measurement noise stated for {', '.join(silent)}")
    return notes
