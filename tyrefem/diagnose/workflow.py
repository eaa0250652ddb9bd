"""The diagnosis step by step: readings, residuals, candidates, fits, ranking, verdict, amended study."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Unpack

from tyrefem.compare.experiment import Experiment, Table, driven_as, experiments
from tyrefem.compare.uncertain_drives import check_uncertain_drives
from tyrefem.diagnose.amend import Change, amended, changes
from tyrefem.diagnose.beside.law_trials import LawTrial, law_trials
from tyrefem.diagnose.better_law import by_better_law
from tyrefem.diagnose.data.residuals import Residuals, residuals_of
from tyrefem.diagnose.data.runs import MeasuredDrive, measured_drives
from tyrefem.diagnose.data.sensitivities import responses, responses_like, sensitivities, shared_responses, unknowns_of
from tyrefem.diagnose.diagnosis import DiagnosisData
from tyrefem.diagnose.forward.drive_response import DriveResponse
from tyrefem.diagnose.forward.effort import check_effort
from tyrefem.diagnose.forward.evaluations import Evaluations, evaluating, worker_models
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.forward.multifidelity import Predictions
from tyrefem.diagnose.forward.strain_law_study import by_law
from tyrefem.diagnose.forward.worker_queues import number_of
from tyrefem.diagnose.heat.acting import as_it_acts, where_it_acts
from tyrefem.diagnose.heat.over_time import HeatOverTime
from tyrefem.diagnose.law.search import HeatLaw, heat_law
from tyrefem.diagnose.law.signatures import law_signatures
from tyrefem.diagnose.layout.conformal import read_calibration
from tyrefem.diagnose.next_experiment import next_experiment
from tyrefem.diagnose.options import DiagnosisOptions, Method, SimulationWork, grouped
from tyrefem.diagnose.ranking import Ranking, beside_other_models, lacking_unknowns, rank
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import (
    Members,
    beside_rolling,
    in_single_runs,
    possible,
    simulated,
)
from tyrefem.diagnose.unknowns.computed_wave import WithWave, computed_wave
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.diagnose.verdicts.verdict import (
    CONFOUNDED,
    IDENTIFIED,
    NO_GAP,
    PARTLY,
    UNEXPLAINED,
)
from tyrefem.inputs.study import StudyData
from tyrefem.requirements import Requirements
from tyrefem.threads import one_thread

#: What a study must have for a diagnosis.
NEEDS = Requirements("a diagnosis", measured=True, fitted=True)


def diagnose(study: StudyData, table: Table | None = None, **options: Unpack[DiagnosisOptions]) -> DiagnosisData:
    """Compare a study with data, find the missing effects and add them to the study.

    If effects are identified, the amended study is diagnosed with the same data. This repeats until no further effect
    is identified: see `DiagnosisData.again`.

    Parameters
    ----------
    study : the study. Its cards and sensors state the uncertainties, its ``[diagnosis]`` table the other assumptions.
    table : see `compare`; None = the study's ``[[measured]]`` entries. ignore, rename : see `compare`.
    settings : numerical parameters of the diagnosis, see `DiagnosisSettings`.
    largest, looks, reduced : values that replace those of ``settings``: most effects in a set; most diagnoses; "auto"
        or "never" for certified reduced models in the fits.
    candidates : function: study -> effects that it may lack; default: the whole catalogue.
    criterion : quality of a set's explanation of the data: `LogEvidence` (default), `BIC`, or any `Criterion`.
    strategy : search over sets of effects: `ForwardSelection` (default), `Exhaustive`, or any `Strategy`.
    workers : number of processes, or `started_workers`. progress : called with (description, number of the step, number
        of steps).
    known : responses of the runs' drives (see `responses`), for many diagnoses of one layout.
    rerun : run the amended study on its mesh at the end; otherwise ``after`` is the prediction of the fit.
    verdict_only : leave out what follows from a verdict: the law of the missing heat, and the next experiment.
    effects : folder with further effects, as ``TYREFEM_PLUGINS`` names them; they stay in the catalogue afterwards.
    store : store of finished simulations, from which an interrupted diagnosis continues.
    calibration : folder or ``calibration.json`` of ``tyrefem isolability --calibrate`` for this layout; the first look
        then has a conformal set.

    Raises
    ------
    InputError : as `compare`; or every run is held out, or no reading is within the simulated drive; or the calibration
        belongs to another layout.
    TypeError : a keyword that is none of these.
    """
    columns, method, work = grouped(options)
    NEEDS.check(study, table)
    planned = experiments(study, table, ignore=columns.ignore, rename=columns.rename)
    NEEDS.check_fitted(study, [experiment.hold_out for experiment in planned])
    check_uncertain_drives(study, planned)
    runs, _ = measured_drives(study, planned, method.settings)
    conformal = None
    if method.calibration is not None:
        sensors = dict.fromkeys(name for run in runs for name in run.parts())
        conformal = read_calibration(method.calibration, study.name, list(sensors), [run.name for run in runs])
    driven = [study.with_drive(dict(run.drive)) for run in runs]
    wave = computed_wave(driven, method.candidates(study), work.tick)
    if wave.onset is not None:
        method = replace(method, candidates=WithWave(method.candidates, wave))
    looks: list[DiagnosisData] = []
    # The matrices are small: further threads of this process would only take time from the workers.
    with one_thread(), worker_models(work.workers) as pool:
        work = replace(work, pool=pool)
        while not looks or (looks[-1].verdict == IDENTIFIED and len(looks) < method.settings.looks):
            further = work.look(len(looks))
            if looks:
                looks.append(_further_look(looks[-1], driven_as(planned, looks[-1].study), method, further))
            else:
                looks.append(_look_by_laws(study, planned, method, further))
    result = looks.pop()
    while looks:
        result = replace(looks.pop(), again=result)
    return replace(result, conformal=conformal, notes=(*((wave.note,) if wave.note else ()), *result.notes))


def _look_by_laws(
    study: StudyData, planned: Sequence[Experiment], method: Method, work: SimulationWork
) -> DiagnosisData:
    """One diagnosis; by another strain law if the study's does not explain the data and they clearly prefer it.

    The law that leaves the smallest rms comes first.
    """
    stated = _look(study, planned, method, work)
    for trial in sorted((each for each in stated.law_trials if each.promising), key=lambda each: each.rms):
        replaced = by_law(study, trial.law, trial.level)
        other = _look(replaced, planned, method.by_law(trial.law), work.by_law(trial.law), law_replaced=True)
        result = by_better_law(stated, other, trial)
        if result.better_law is not None:
            return result
    return stated


def _further_look(
    before: DiagnosisData, planned: Sequence[Experiment], method: Method, work: SimulationWork
) -> DiagnosisData:
    """The diagnosis of a study that another diagnosis has amended.

    Usually no gap is left. The sensitivities of the look before are accurate enough to see this; a further effect is
    named with those of the amended study only.
    """
    at_hand = before.gap.responses
    quick = _look(before.study, planned, method, replace(work, rerun=False), like=at_hand)
    if quick.verdict == NO_GAP and quick.gap.responses[0].modes is at_hand[0].modes:
        return quick
    return _look_by_laws(before.study, planned, method, work)


def _look(
    study: StudyData,
    planned: Sequence[Experiment],
    method: Method,
    work: SimulationWork,
    *,
    law_replaced: bool = False,
    like: Sequence[DriveResponse] = (),
) -> DiagnosisData:
    """One diagnosis, from the measured runs to the amended study.

    ``law_replaced``: the strain law is not the one of the study that was given. ``like``: responses of a similar study,
    for their sensitivities.
    """
    began = time.perf_counter()
    settings = method.settings
    runs, notes = measured_drives(study, planned, settings)
    in_all_runs, impossible = possible(study, method.candidates(study))
    notes = (*notes, *impossible, *beside_rolling(study, in_all_runs))
    in_one_run = _in_single_runs(study, in_all_runs, runs, settings)
    candidates = (*in_all_runs, *in_one_run)
    method.strategy.check(study, candidates, settings)
    model = ForwardModel(study, tuple(run.sampling for run in runs), settings=settings)
    if work.known is None:
        check_effort(model, f"the diagnosis of {study.name}", 1.0, number_of(work.workers))
    if work.store is not None and work.store.open(model):
        work.tick(f"resuming with {work.store.resumed} finished simulations")
    unknowns, nuisance = unknowns_of(study, {name for run in runs for name in run.parts()}, in_all_runs, settings)
    with evaluating(model, work.workers, work.store, work.pool) as evaluations:
        # By a better strain law, all blind cases of a layout have the same study.
        computed = shared_responses if law_replaced else responses
        at_hand = work.known or responses_like(evaluations, unknowns, like)
        known = tuple(at_hand or computed(evaluations, unknowns, work.tick))
        of_single_runs = [unknown for each in in_one_run for unknown in (*each.amplitudes, *each.presence)]
        sensitive = sensitivities(model.drives, unknowns, nuisance, known).in_single_runs(of_single_runs)
        candidates, further_notes = simulated(candidates, sensitive.failed)
        sensitive = sensitive.without(sensitive.failed)
        residuals = residuals_of(study, runs, sensitive, settings)
        predictions = Predictions(
            evaluations, [response.modes for response in known] if settings.reduced == "auto" else ()
        )

        tick = _SimulationCounter(work.tick)
        ranking = rank(residuals, predictions, candidates, method, tick, law_replaced=law_replaced)
        ranking = beside_other_models(ranking)
        follows = _what_follows(residuals, evaluations, ranking, work, law_replaced=law_replaced)
    return DiagnosisData(
        original=study,
        judgement=ranking.judgement,
        gap=residuals,
        candidates=candidates,
        null=ranking.null,
        best=ranking.best,
        before={number: residuals.corrected(number, computed) for number, computed in enumerate(residuals.computed)},
        predictions=predictions.to_dict(),
        seconds=time.perf_counter() - began,
        notes=(*notes, *further_notes),
        movements=ranking.movements,
        robustness=ranking.robustness,
        supports=ranking.supports,
        signatures=() if follows["law"] is None else law_signatures(residuals, follows["law"], candidates),
        **follows,
    )


def _what_follows(
    residuals: Residuals, evaluations: Evaluations, ranking: Ranking, work: SimulationWork, *, law_replaced: bool
) -> dict[str, Any]:
    """What follows from a ranking, as fields of `DiagnosisData`: missing heat with its law, amended study, next
    experiment, other strain laws."""
    verdict, law = ranking.judgement.verdict, None
    if not work.verdict_only and verdict in (UNEXPLAINED, PARTLY) and ranking.missing.over_time is not None:
        ranking, law = _with_law(residuals, evaluations, ranking, ranking.missing.over_time, work)
    values, sd, lacking = lacking_unknowns(residuals, ranking)
    change = changes(residuals, values, sd, lacking)
    work.tick("running the amended study")
    after = _after(residuals, evaluations, change if work.rerun else None, values)
    further: Mapping[str, Any] = {}
    if verdict == CONFOUNDED and not work.verdict_only:
        work.tick("ranking next experiments")
        further = next_experiment(evaluations.model, ranking.judgement, ranking.fit_of)
    trials: tuple[LawTrial, ...] = ()
    if not law_replaced and verdict == UNEXPLAINED:
        work.tick("trying other strain laws")
        trials = law_trials(residuals, evaluations)
    return {
        "missing": ranking.missing,
        "study": amended(residuals.study, change),
        "changes": change,
        "after": after,
        "law": law,
        "next_experiment": further,
        "law_trials": trials,
    }


def _in_single_runs(
    study: StudyData, candidates: Members, runs: Sequence[MeasuredDrive], settings: DiagnosisSettings
) -> Members:
    """The candidates that depend on the day, each in one of the fitted runs."""
    if not settings.odd_run_share:
        return ()
    return in_single_runs(study, candidates, list(dict.fromkeys(run.run for run in runs if not run.hold_out)))


class _SimulationCounter:
    """Counts the simulations of the fits; their total number is not known in advance."""

    def __init__(self, tick: Callable[[str, int, int], None]) -> None:
        self.tick, self.done = tick, 0

    def __call__(self, what: str) -> None:
        self.done += 1
        self.tick(what, self.done, 0)


def _with_law(
    residuals: Residuals, evaluations: Evaluations, ranking: Ranking, heat: HeatOverTime, work: SimulationWork
) -> tuple[Ranking, HeatLaw | None]:
    """The law of the missing heat, and the ranking with times and amounts of its sources from where they act."""
    work.tick("inferring the law of the missing heat")
    law = heat_law(residuals, evaluations, heat)
    acting = where_it_acts(residuals, evaluations, heat)
    if acting is None:
        return ranking, law
    over_time = as_it_acts(residuals.study, residuals.settings, heat, acting)
    return replace(ranking, missing=replace(ranking.missing, over_time=over_time)), law and law.as_it_acts(acting.data)


def _after(
    residuals: Residuals, evaluations: Evaluations, change: tuple[Change, ...] | None, values: Mapping[Unknown, float]
) -> dict[int, Any]:
    """Block means of every run: full runs with the changes, or predictions of the fit if ``change`` is None."""
    numbers = range(len(residuals.runs))
    if change is None:
        answers = evaluations.of("predict", [(number, values) for number in numbers])
        return {number: residuals.corrected(number, answer) for number, answer in enumerate(answers)}
    histories = evaluations.histories([amended(residuals.driven(number), change) for number in numbers])
    return {number: evaluations.model.blocks_of(number, history) for number, history in enumerate(histories)}
