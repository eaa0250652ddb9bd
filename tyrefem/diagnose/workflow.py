"""The diagnosis step by step: readings, residuals, candidates, fits, ranking, verdict, amended study."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Unpack

from tyrefem.compare.experiment import ColumnNames, Table, experiments
from tyrefem.diagnose.amend import Change, amended, changes
from tyrefem.diagnose.better_law import by_better_law
from tyrefem.diagnose.candidates import Members, beside_rolling, in_single_runs, possible, simulated
from tyrefem.diagnose.computed_wave import WithWave, computed_wave
from tyrefem.diagnose.conformal import read_calibration
from tyrefem.diagnose.diagnosis import DiagnosisData
from tyrefem.diagnose.effort import check_effort
from tyrefem.diagnose.energy_shapes import SHAPE
from tyrefem.diagnose.evaluations import Evaluations, evaluating, worker_models
from tyrefem.diagnose.forward_model import DriveResponse, ForwardModel
from tyrefem.diagnose.heat_patches import patches
from tyrefem.diagnose.law_search import HeatLaw, heat_law
from tyrefem.diagnose.law_signatures import law_signatures
from tyrefem.diagnose.law_trials import LawTrial, law_trials
from tyrefem.diagnose.multifidelity import Predictions
from tyrefem.diagnose.next_experiment import next_experiment
from tyrefem.diagnose.options import DiagnosisOptions, Method, SimulationWork, grouped
from tyrefem.diagnose.ranking import Ranking, allowed_error, beside_other_models, rank, simulated_best
from tyrefem.diagnose.residuals import Residuals, residuals_of
from tyrefem.diagnose.runs import MeasuredDrive, measured_drive, with_noise_of_data
from tyrefem.diagnose.sensitivities import responses, responses_like, sensitivities, shared_responses, unknowns_of
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.strain_law_study import by_law
from tyrefem.diagnose.unknowns import Unknown
from tyrefem.diagnose.verdict import CONFOUNDED, IDENTIFIED, NO_GAP, PARTLY, UNEXPLAINED
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.requirements import Requirements

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
    workers : number of processes. progress : called with (description, number of the step, number of steps).
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
    conformal = None
    if method.calibration is not None:
        runs = _measured_drives(study, table, columns, method.settings)
        sensors = dict.fromkeys(name for run in runs for name in run.parts())
        conformal = read_calibration(method.calibration, study.name, list(sensors), [run.name for run in runs])
    driven = [study.with_drive(dict(run.drive)) for run in _measured_drives(study, table, columns, method.settings)]
    wave = computed_wave(driven or [study], method.candidates(study), work.tick)
    if wave.onset is not None:
        method = replace(method, candidates=WithWave(method.candidates, wave))
    looks: list[DiagnosisData] = []
    with worker_models(work.workers) as pool:
        work = replace(work, pool=pool)
        while not looks or (looks[-1].verdict == IDENTIFIED and len(looks) < method.settings.looks):
            further = work.look(len(looks))
            if looks:
                looks.append(_further_look(looks[-1], table, columns, method, further))
            else:
                looks.append(_look_by_laws(study, table, columns, method, further))
    result = looks.pop()
    while looks:
        result = replace(looks.pop(), again=result)
    return replace(result, conformal=conformal, notes=(*((wave.note,) if wave.note else ()), *result.notes))


def _look_by_laws(
    study: StudyData, table: Table | None, columns: ColumnNames, method: Method, work: SimulationWork
) -> DiagnosisData:
    """One diagnosis; by another strain law if the study's does not explain the data and they clearly prefer it."""
    stated = _look(study, table, columns, method, work)
    trial = next((each for each in stated.law_trials if each.promising), None)
    if trial is None:
        return stated
    replaced = by_law(study, trial.law, trial.level)
    other = _look(replaced, table, columns, method.by_law(trial.law), work.by_law(trial.law), law_replaced=True)
    return by_better_law(stated, other, trial)


def _further_look(
    before: DiagnosisData, table: Table | None, columns: ColumnNames, method: Method, work: SimulationWork
) -> DiagnosisData:
    """The diagnosis of a study that another diagnosis has amended.

    Usually no gap is left. The sensitivities of the look before are accurate enough to see this; a further effect is
    named with those of the amended study only.
    """
    at_hand = before.gap.responses
    quick = _look(before.study, table, columns, method, replace(work, rerun=False), like=at_hand)
    if quick.verdict == NO_GAP and quick.gap.responses[0].modes is at_hand[0].modes:
        return quick
    return _look_by_laws(before.study, table, columns, method, work)


def _look(
    study: StudyData,
    table: Table | None,
    columns: ColumnNames,
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
    runs = _measured_drives(study, table, columns, settings)
    in_all_runs, notes = possible(study, method.candidates(study))
    notes = (*notes, *beside_rolling(study, in_all_runs))
    in_one_run = _in_single_runs(study, in_all_runs, runs, settings)
    candidates = (*in_all_runs, *in_one_run)
    method.strategy.check(study, candidates, settings)
    model = ForwardModel(study, tuple(run.sampling for run in runs), settings=settings)
    if work.known is None:
        check_effort(model, f"the diagnosis of {study.name}", 1.0, work.workers)
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

        def ranked_with(predictions: Predictions) -> Ranking:
            tick = _SimulationCounter(work.tick)
            return rank(residuals, predictions, candidates, method, tick, law_replaced=law_replaced)

        ranking = ranked_with(predictions)
        error = predictions.error_at(ranking.best.members, ranking.best.values)
        confirmed: Ranking | None = ranking if error <= allowed_error(ranking, settings) else None
        if confirmed is not None and error > settings.reduced_allowed:
            confirmed = simulated_best(ranking, replace(predictions, modes=()))
        if confirmed is None:
            work.tick("reduced models are not accurate at the best fit: repeating with simulations")
            predictions = replace(predictions, modes=(), given_up=True)
            confirmed = ranked_with(predictions)
        ranking = beside_other_models(confirmed)
        values, sd, missing_unknowns = _missing_unknowns(residuals, ranking)
        change = changes(residuals, values, sd, missing_unknowns)
        work.tick("running the amended study")
        after = _after(residuals, evaluations, change if work.rerun else None, values)
        law = None if work.verdict_only else _law(residuals, evaluations, ranking, work)
        signatures = () if law is None else law_signatures(residuals, law, candidates)
        further: Mapping[str, Any] = {}
        if ranking.judgement.verdict == CONFOUNDED and not work.verdict_only:
            work.tick("ranking next experiments")
            further = next_experiment(evaluations.model, ranking.judgement, ranking.fit_of)
        trials: tuple[LawTrial, ...] = ()
        if not law_replaced and ranking.judgement.verdict == UNEXPLAINED:
            work.tick("trying other strain laws")
            trials = law_trials(residuals, evaluations)
    return DiagnosisData(
        original=study,
        study=amended(study, change),
        judgement=ranking.judgement,
        gap=residuals,
        candidates=candidates,
        null=ranking.null,
        best=ranking.best,
        missing=ranking.missing,
        changes=change,
        before={number: residuals.corrected(number, computed) for number, computed in enumerate(residuals.computed)},
        after=after,
        next_experiment=further,
        predictions=predictions.to_dict(),
        seconds=time.perf_counter() - began,
        notes=(*notes, *further_notes),
        movements=ranking.movements,
        law=law,
        signatures=signatures,
        robustness=ranking.robustness,
        supports=ranking.supports,
        law_trials=trials,
    )


def _measured_drives(
    study: StudyData, table: Table | None, columns: ColumnNames, settings: DiagnosisSettings
) -> tuple[MeasuredDrive, ...]:
    """The measured runs as blocks of readings within the simulated drives."""
    planned = experiments(study, table, ignore=columns.ignore, rename=columns.rename)
    NEEDS.check_fitted(study, [experiment.hold_out for experiment in planned])
    runs = tuple(run for run in (measured_drive(experiment, study, settings) for experiment in planned) if run.sensors)
    if all(run.hold_out for run in runs):
        message = "no fitted run has a reading within the simulated drive"
        raise InputError(message, field="measured", file=study.file)
    return with_noise_of_data(runs, settings)


def _in_single_runs(
    study: StudyData, candidates: Members, runs: Sequence[MeasuredDrive], settings: DiagnosisSettings
) -> Members:
    """The candidates that depend on the day, each in one of the fitted runs."""
    if not settings.odd_run_share:
        return ()
    return in_single_runs(study, candidates, [run.name for run in runs if not run.hold_out])


class _SimulationCounter:
    """Counts the simulations of the fits; their total number is not known in advance."""

    def __init__(self, tick: Callable[[str, int, int], None]) -> None:
        self.tick, self.done = tick, 0

    def __call__(self, what: str) -> None:
        self.done += 1
        self.tick(what, self.done, 0)


def _missing_unknowns(
    residuals: Residuals, ranking: Ranking
) -> tuple[Mapping[Unknown, float], Mapping[Unknown, float], list[Unknown]]:
    """Values and sd of the unknowns, and the unknowns that the study lacks."""
    best, missing = ranking.best, ranking.missing
    if ranking.judgement.verdict == PARTLY:
        shapes = [unknown for unknown in best.unknowns if unknown.effect == SHAPE and unknown.origin is None]
        return best.values, best.sd, [*(unknown for member in best.members for unknown in member.unknowns), *shapes]
    if ranking.judgement.verdict != UNEXPLAINED:
        return best.values, best.sd, [unknown for member in best.members for unknown in member.unknowns]
    if missing.over_time is not None and missing.over_time.values:
        return missing.over_time.values, missing.over_time.sd, list(missing.over_time.unknowns)
    # No effect is named: the amended study gets the patches of heat that differ from 0 by more than two sd.
    heat = patches(residuals.study, residuals.settings)
    missing_unknowns = [patch for patch in heat if abs(missing.values.get(patch, 0.0)) > 2 * missing.sd.get(patch, 1.0)]
    values = {unknown: x for unknown, x in missing.values.items() if unknown in missing_unknowns or unknown not in heat}
    return values, missing.sd, missing_unknowns


def _law(residuals: Residuals, evaluations: Evaluations, ranking: Ranking, work: SimulationWork) -> HeatLaw | None:
    """The law of the missing heat, if the verdict leaves some."""
    if ranking.judgement.verdict not in (UNEXPLAINED, PARTLY):
        return None
    work.tick("inferring the law of the missing heat")
    return heat_law(residuals, evaluations, ranking.missing.over_time)


def _after(
    residuals: Residuals, evaluations: Evaluations, change: tuple[Change, ...] | None, values: Mapping[Unknown, float]
) -> dict[int, Any]:
    """Block means of every run: full runs with the changes, or predictions of the fit if ``change`` is None."""
    numbers = range(len(residuals.runs))
    if change is None:
        answers = evaluations.of("predict", [(number, values) for number in numbers])
        return {number: residuals.corrected(number, answer) for number, answer in enumerate(answers)}
    histories = evaluations.histories([amended(residuals.driven(number), change) for number in numbers])
    sensors = evaluations.model.sensors
    return {
        number: evaluations.model.blocks(number, times, dict(zip(sensors, readings, strict=True)))
        for number, (times, *readings) in enumerate(histories)
    }
