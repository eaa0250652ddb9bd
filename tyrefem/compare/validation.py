"""The comparison step by step: experiments, simulations, histories, deviations."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from numbers import Real
from typing import Any, TypedDict, Unpack

import numpy as np

from tyrefem.compare.between_readings import interpolation_note
from tyrefem.compare.comparison import ComparisonData, comparison_of
from tyrefem.compare.experiment import Experiment, Table, acting_in, driven, experiments
from tyrefem.compare.history import histories
from tyrefem.compare.interface import ResultLike, StudyLike, computed_of
from tyrefem.compare.omitted import ERROR, columns_note, outside_note, outside_notes, start_notes, table_notes, within
from tyrefem.compare.reduced_inputs import (
    DEFAULT,
    ReducedInputCertificate,
    ReducedInputRuns,
    ReducedInputSettings,
    enough_changed_runs,
    reducible,
)
from tyrefem.compare.runs import Runs, store_key
from tyrefem.compare.uncertain_drives import check_uncertain_drives
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.inputs.study_plugins import plugin_summary
from tyrefem.inputs.uncertain_numbers import left_out
from tyrefem.measured.names import ColumnNames
from tyrefem.requirements import Requirements
from tyrefem.simulation.result import ResultData
from tyrefem.simulation.run import run
from tyrefem.variants.answer_store import AnswerStore

#: What a study must have for a comparison.
NEEDS = Requirements("a comparison", measured=True)


class ComparisonOptions(TypedDict, total=False):
    """Keywords of `compare`."""

    inputs: bool
    ignore: Iterable[str]
    rename: Mapping[str, str] | None
    k: float
    executor: Executor | None
    progress: Callable[[int, int], object] | None
    reduced: str
    store: AnswerStore | None
    begin: Callable[[str], object] | None
    settings: ReducedInputSettings


def compare(
    study: StudyLike,
    table: Table | None = None,
    result: ResultLike | None = None,
    **options: Unpack[ComparisonOptions],
) -> ComparisonData:
    """Deviations between a study and measured temperature histories, E = computed - measured.

    Parameters
    ----------
    study : the study; its sensors give names, noise, accuracy and uncertainty of position.
    table : CSV file or workbook (see `tyrefem.measured.read_table`), pandas DataFrame with the same columns, runs
        already read, or a list of these; None = the study's ``[[measured]]`` entries, with their drives, noise and
        offsets.
    result : the study's result if it is known; used for every run at the study's drive, and for a single run in any
        case if it is the result of another study (amended, or with another drive).
    inputs : run the study with each number of ``study.uncertainty`` one standard deviation higher. These are the
        relevant numbers of its cards and of ``[uncertainty]``; a number of a card changes in all its regions.
    ignore : columns of the tables to leave out. ``rename`` : column name -> sensor name; both in addition to the
        ``[[measured]]`` entries.
    k : coverage factor of the verdict; 2 for about 95 %.
    executor : runs the simulations in parallel (`concurrent.futures.ProcessPoolExecutor` or alike).
    progress : called with (simulations done, simulations in all) after each.
    reduced : "auto": with at least 12 changed runs, a reduced model computes them if three or more full runs confirm
        it. "never": all runs are full runs.
    store : store of finished simulations, from which an interrupted comparison continues.
    settings : numerical parameters of the reduced models.
    begin : called before the first simulation with a sentence on the number of simulations.

    Raises
    ------
    InputError : a campaign; no measured runs; the table cannot be read; a column is no sensor; no measured time is
        within the simulated span.
    TypeError : a keyword that is none of these.

    Source: ASME V&V 20-2009; equations and simplifications in docs/method/validation.md.
    """
    columns, judged, work = _grouped(options)
    NEEDS.check(study, table)
    judged.check()
    work.check()
    if result is not None and not all(hasattr(result, name) for name in ("study", "readings")):
        raise InputError(f"must be the result of a run, not {result!r:.60}", field="result")
    planned = experiments(study, table, ignore=columns.ignore, rename=columns.rename)
    if result is None and isinstance(study, StudyData):
        _check_times(study, planned)
    if judged.inputs and isinstance(study, StudyData):
        check_uncertain_drives(study, planned)
    keys = dict(study.uncertainty) if judged.inputs else {}
    solved, certificate, model_notes = _solved(study, planned, result, keys, work)
    all_histories, curves, notes = [], {}, []
    for experiment in planned:
        computed, perturbed = solved[_drive(study, experiment)]
        of_experiment, outside = histories(experiment, study, computed, perturbed)
        all_histories += of_experiment
        curves[experiment.name] = computed.readings
        first, last = computed.readings["time_s"].iloc[[0, -1]]
        notes += outside_note(experiment, first, last, outside)
        notes += interpolation_note(experiment.name, computed, of_experiment)
    if not all_histories:
        raise InputError("; ".join(["no sensor has a reading within the simulated span", *notes]))
    if isinstance(study, StudyData):
        notes += start_notes(study, planned)
    notes += [
        *model_notes,
        *columns_note(planned),
        *table_notes(planned),
        *_uncertainty_notes(study, planned, judged.inputs),
    ]
    numbers = {number.key: number for number in getattr(study, "uncertain_numbers", ())}
    comparison = comparison_of(
        study.name, all_histories, curves=curves, relative_sd=keys, numbers=numbers, notes=tuple(notes), k=judged.k,
        reduced=certificate,
    )  # fmt: skip
    used = plugin_summary(study if isinstance(study, StudyData) else None)["plugins"]
    return replace(comparison, plugins=tuple(used))


def _drive(study: StudyLike, experiment: Experiment) -> str:
    """Experiments at the same drive, with the same effects, share their simulations."""
    acting = acting_in(study, experiment)
    return repr(sorted(experiment.drive.items())) + (f" effects {acting}" if acting else "")


#: Drive and changed input; None: as the study has it.
Key = tuple[str, str | None]
Solved = tuple[dict[Key, ResultLike], ReducedInputCertificate | None, list[str]]


def _grouped(options: Mapping[str, Any]) -> tuple[ColumnNames, _Judged, _Work]:
    """The keywords of `compare` in groups."""
    given = dict(options)
    columns = ColumnNames.of(ignore=given.pop("ignore", ()), rename=given.pop("rename", None))
    judged = {name: given.pop(name) for name in ("inputs", "k") if name in given}
    return columns, _Judged(**judged), _Work(**given)


@dataclass(frozen=True)
class _Judged:
    """Uncertainties that a deviation is compared with, see `compare`."""

    inputs: bool = True
    k: float = 2.0

    def check(self) -> None:
        """Raises InputError for a coverage factor out of range."""
        if not isinstance(self.k, Real) or not 0.0 < self.k < 100.0:
            raise InputError(f"the coverage factor k must be more than 0 and less than 100, not {self.k!r}")


@dataclass(frozen=True, eq=False)
class _Work:
    """Execution of the simulations, see `compare`."""

    executor: Executor | None = None
    progress: Callable[[int, int], object] | None = None
    reduced: str = "auto"
    store: AnswerStore | None = None
    begin: Callable[[str], object] | None = None
    settings: ReducedInputSettings = DEFAULT

    def check(self) -> None:
        """Raises InputError for another word than "auto" or "never"."""
        if not isinstance(self.reduced, str) or self.reduced not in ("auto", "never"):
            raise InputError(f"must be 'auto' or 'never', not {self.reduced!r:.60}", field="reduced")
        if not isinstance(self.settings, ReducedInputSettings):
            raise InputError(f"must be ReducedInputSettings, not {self.settings!r:.60}", field="settings")

    def done(self, total: int) -> Callable[[int], object]:
        """Function to be called with the number of finished simulations."""
        return lambda count: self.progress(count, total) if self.progress is not None else None


def _solved(
    study: StudyLike,
    planned: Sequence[Experiment],
    result: ResultLike | None,
    keys: Mapping[str, float],
    work: _Work,
) -> tuple[dict[str, tuple[ResultLike, dict[str, ResultLike]]], ReducedInputCertificate | None, list[str]]:
    """Drive -> its result and its results with each uncertain input one sd higher; certificate; notes."""
    known: dict[str, ResultLike] = {}
    studies: dict[Key, StudyLike] = {}
    for experiment in planned:
        drive = _drive(study, experiment)
        if (drive, None) in studies:
            continue
        at_drive = driven(study, experiment)
        amended = result is not None and len(planned) == 1 and result.study is not study
        if result is not None and (at_drive is study or amended):
            known[drive] = result
            at_drive = result.study
        studies[drive, None] = at_drive
        studies |= {(drive, key): at_drive.scaled(key, 1.0 + sd) for key, sd in keys.items()}
    as_data = {key: driven for key, driven in studies.items() if isinstance(driven, StudyData)}
    at_hand = {drive: given for drive, given in known.items() if isinstance(given, ResultData)}
    if len(as_data) == len(studies) and len(at_hand) == len(known):
        solutions, certificate, notes = _by_runs(as_data, at_hand, keys, work)
    else:
        solutions, certificate, notes = _by_full_runs(studies, known, work)
    together = {
        drive: (solution, {key: solutions[drive, key] for key in keys})
        for (drive, name), solution in solutions.items()
        if not name
    }
    return together, certificate, notes


def _by_full_runs(studies: Mapping[Key, StudyLike], known: Mapping[str, ResultLike], work: _Work) -> Solved:
    """Full runs of studies of any kind."""
    each: Any = work.executor.map if work.executor is not None else map
    results: dict[Key, ResultLike] = {(drive, None): result for drive, result in known.items()}
    missing, done = [key for key in studies if key not in results], work.done(len(studies))
    for key, computed in zip(missing, each(_run, [studies[key] for key in missing]), strict=True):
        results[key] = computed
        done(len(results))
    return results, None, []


def _run(study: StudyLike) -> ResultLike:
    other: Any = study
    return computed_of(run(study) if isinstance(study, StudyData) else other.run())


def _by_runs(
    studies: Mapping[Key, StudyData], known: Mapping[str, ResultData], keys: Mapping[str, float], work: _Work
) -> Solved:
    """The runs of studies; a certified reduced model computes runs with a changed input."""
    model = work.reduced == "auto" and enough_changed_runs(reducible(studies), work.settings)
    if work.store is not None:
        work.store.resume(store_key(next(iter(studies.values()))))
    with Runs(studies, keys, known, work.executor, work.store, work.done(len(studies))) as runs:
        verdict = runs.kept_verdict if model else None
        refused = verdict is not None and verdict.dtype.kind == "U"
        certified = verdict is not None and not refused
        complete = work.store is not None and runs.resume_all(reduced=certified)
        if work.begin is not None:
            work.begin(runs.workload(model=model))
        if complete:
            certificate = ReducedInputCertificate.of(verdict) if certified else None
            why = str(verdict) if refused else ""
            return dict(runs.computed), certificate, [*runs.cost, *_model_notes(model, certificate, why)]
        certificate, why = None, str(verdict) if refused else ""
        # All of them are needed, whether a model holds or not.
        runs.begin([key for key in reducible(studies) if key[1] is not None] if model and not why else [])
        if model and not why:
            certificate, why = _certified(runs, work.settings)
            runs.keep_verdict(why if certificate is None else certificate.values)
        runs.fill()
    return dict(runs.computed), certificate, [*runs.cost, *_model_notes(model, certificate, why)]


def _certified(runs: Runs, settings: ReducedInputSettings) -> tuple[ReducedInputCertificate | None, str]:
    """Compute runs by a reduced model, or the reason why there is none.

    A model that does not hold for runs with changed strain cycles may hold for the others.
    """
    taught, why = list(runs.training), ""
    attempts = [reducible(runs.studies, nearby=nearby) for nearby in (True, False)]
    for nearby in (True, False) if len(attempts[0]) > len(attempts[1]) else (True,):
        runs.training[:] = taught
        try:
            return ReducedInputRuns(runs, settings, nearby).solve(), ""
        except (InputError, np.linalg.LinAlgError) as error:
            # An error of the study itself appears in its full run.
            why = str(error)
    return None, why


def _model_notes(model: bool, certificate: ReducedInputCertificate | None, why: str) -> list[str]:
    """Notes on the reduced model."""
    if certificate is not None:
        return [certificate.sentence]
    return [f"Note: all runs with a changed input are full runs: {why}"] if model else []


def _check_times(study: StudyData, planned: Sequence[Experiment]) -> None:
    """Raises InputError before the simulations if all readings are outside the drives of their runs."""
    if not any(within(study, experiment).any() for experiment in planned):
        notes = "; ".join(outside_notes(study, planned)).replace(ERROR, "")
        raise InputError(f"no measured time is within the simulated span: {notes}")


def _uncertainty_notes(study: StudyLike, planned: Sequence[Experiment], inputs: bool) -> list[str]:
    """Notes on uncertainties that are not stated."""
    notes = []
    if not study.uncertainty:
        notes.append("Note: the study states no uncertainty of its inputs, so u_input is 0")
    elif not inputs:
        notes.append("Note: the uncertainty of the inputs is left out, so u_input is 0")
    if inputs:
        notes += [f"Note: inputs {line}" for line in left_out(getattr(study, "uncertain_numbers", ()))]
    silent = {
        sensor: None
        for experiment in planned
        for sensor in experiment.run.sensors
        if not experiment.noise_of(sensor, study)
    }
    if silent:
        notes.append(f"Note: no measurement noise is stated for {', '.join(silent)}")
    return notes
