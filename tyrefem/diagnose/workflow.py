"""The diagnosis step by step: readings, residuals, candidates, fits, ranking, verdict, amended study."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Unpack

from tyrefem.brief import Brief
from tyrefem.compare.experiment import Experiment, Table, driven_as, experiments
from tyrefem.compare.omitted import ERROR, columns_note, outside_notes, start_notes
from tyrefem.compare.uncertain_drives import check_uncertain_drives
from tyrefem.diagnose.amend import Change, amended, changes
from tyrefem.diagnose.beside.best_fit import fit_beside, not_asked_for
from tyrefem.diagnose.beside.free_heat import free_heat
from tyrefem.diagnose.beside.law_trials import LawTrial, law_trials
from tyrefem.diagnose.beside.ranked_beside import nearest
from tyrefem.diagnose.beside.ranking import robustness
from tyrefem.diagnose.beside.robustness import Robustness
from tyrefem.diagnose.beside.strain_laws import beside_strain_laws
from tyrefem.diagnose.better_law import by_better_law
from tyrefem.diagnose.data.residuals import Residuals, residuals_of
from tyrefem.diagnose.data.runs import MeasuredDrive, measured_drive, with_noise_of_data
from tyrefem.diagnose.data.sensitivities import responses, responses_like, sensitivities, shared_responses, unknowns_of
from tyrefem.diagnose.diagnosis import DiagnosisData
from tyrefem.diagnose.fitting.fits import FittedSet, first_fits
from tyrefem.diagnose.fitting.materiality import Movements, movements
from tyrefem.diagnose.fitting.selection import ScoredSet, SelectionProblem
from tyrefem.diagnose.fitting.support import Support, supports
from tyrefem.diagnose.forward.effort import check_effort
from tyrefem.diagnose.forward.evaluations import Evaluations, evaluating, worker_models
from tyrefem.diagnose.forward.forward_model import DriveResponse, ForwardModel
from tyrefem.diagnose.forward.multifidelity import Predictions
from tyrefem.diagnose.forward.strain_law_study import by_law
from tyrefem.diagnose.heat.missing_heat import UnknownHeat, missing_heat, missing_heat_fitted, with_course
from tyrefem.diagnose.heat.over_time import HeatOverTime, heat_over_time
from tyrefem.diagnose.heat.unknown_origin import UnknownOrigin
from tyrefem.diagnose.law.search import HeatLaw, heat_law
from tyrefem.diagnose.law.signatures import law_signatures
from tyrefem.diagnose.layout.conformal import read_calibration
from tyrefem.diagnose.next_experiment import next_experiment
from tyrefem.diagnose.options import DiagnosisOptions, Method, SimulationWork, grouped
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import (
    Candidate,
    Members,
    SetPrior,
    beside_rolling,
    in_single_runs,
    possible,
    simulated,
)
from tyrefem.diagnose.unknowns.computed_wave import WithWave, computed_wave
from tyrefem.diagnose.unknowns.energy_shapes import SHAPE
from tyrefem.diagnose.unknowns.heat_patches import patches
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.diagnose.verdicts.partly import beside_discrepancies
from tyrefem.diagnose.verdicts.verdict import (
    CONFOUNDED,
    IDENTIFIED,
    NO_GAP,
    PARTLY,
    UNEXPLAINED,
    Judgement,
    certain_members,
    inclusion,
    judge,
    ranked,
    rejection,
    without_immaterial,
)
from tyrefem.errors import InputError
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
    planned = experiments(study, table, ignore=columns.ignore, rename=columns.rename)
    NEEDS.check_fitted(study, [experiment.hold_out for experiment in planned])
    check_uncertain_drives(study, planned)
    runs, _ = _measured_drives(study, planned, method.settings)
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
    runs, notes = _measured_drives(study, planned, settings)
    in_all_runs, impossible = possible(study, method.candidates(study))
    notes = (*notes, *impossible, *beside_rolling(study, in_all_runs))
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

        tick = _SimulationCounter(work.tick)
        ranking = rank(residuals, predictions, candidates, method, tick, law_replaced=law_replaced)
        ranking = beside_other_models(ranking)
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
    study: StudyData, planned: Sequence[Experiment], settings: DiagnosisSettings
) -> tuple[tuple[MeasuredDrive, ...], tuple[str, ...]]:
    """The measured runs as blocks of readings within the simulated drives, and notes on what is left out.

    A held-out run with readings at 0 s only is left out: they are the initial temperature, and test nothing.
    """
    runs = [run for run in (measured_drive(experiment, study, settings) for experiment in planned) if run.sensors]
    fitted = [run for run in runs if not run.hold_out]
    if not fitted:
        outside = "; ".join(outside_notes(study, planned)).replace(ERROR, "")
        message = f"no fitted run has a reading within the simulated drive: {outside}"
        raise InputError(message, field="measured", file=study.file)
    for run in fitted:
        if run.last <= 0:
            raise InputError(f"run '{run.name}' has readings at 0 s only", field="measured", file=study.file)
    empty = [run for run in runs if run.last <= 0]
    notes = (*outside_notes(study, planned), *start_notes(study, planned), *columns_note(planned))
    return with_noise_of_data(tuple(run for run in runs if run not in empty), settings), (
        *(f"held-out run '{run.name}' was left out: it has readings at 0 s only, which test nothing" for run in empty),
        *(note.removeprefix("Note: ") for note in notes),
    )


def _in_single_runs(
    study: StudyData, candidates: Members, runs: Sequence[MeasuredDrive], settings: DiagnosisSettings
) -> Members:
    """The candidates that depend on the day, each in one of the fitted runs."""
    if not settings.odd_run_share:
        return ()
    return in_single_runs(study, candidates, list(dict.fromkeys(run.run for run in runs if not run.hold_out)))


@dataclass(frozen=True, eq=False)
class Ranking(Brief):
    """Result of the search of one look.

    Parameters
    ----------
    judgement : verdict, and sets with their probabilities. best, null : fits of the most probable and of the empty set.
    missing : heat of unknown origin. fit_of : set -> its fit, made if there is none.
    movements : what each effect of the best set moves at the sensors.
    robustness : effects beside discrepancy models; None if there is no gap. If the verdict is "partly identified",
        ``best`` is the fit of the effects that act whatever else is wrong, and ``missing`` is the heat beside them.
    supports : effect of the best set -> its support by the sensors and runs, if the verdict names it or it is certain.
    """

    judgement: Judgement
    best: FittedSet
    null: FittedSet
    missing: UnknownHeat
    fit_of: Callable[[Members], FittedSet]
    movements: Movements
    robustness: Robustness | None = None
    supports: Mapping[Candidate, Support] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Searched(Brief):
    """Sets of effects that a look has searched and fitted.

    Parameters
    ----------
    problem : the search's problem. origin : heat of unknown origin as an alternative. scored : the sets, best first.
    fits : set -> its fit; further ones join. tick : called with what is being done.
    """

    problem: SelectionProblem
    origin: UnknownOrigin
    scored: Sequence[ScoredSet]
    fits: dict[Members, FittedSet]
    tick: Callable[[str], None]
    _sizes: dict[Members, Movements] = field(default_factory=dict)

    @property
    def null(self) -> FittedSet:
        """The fit of no effect."""
        return self.fits[()]

    def fit_of(self, members: Members) -> FittedSet:
        """The fit of a set, made if there is none: from that of its best part near the data, else from x = 0."""
        if members not in self.fits:
            close = {part: fit for part, fit in self.fits.items() if fit.close}
            start = nearest(close, members, lambda part: self.problem.score(close[part]))
            starts = {} if start is None else {members: start}
            (first,) = first_fits(self.problem.residuals, self.problem.predictions, [members], starts)
            self.fits[members] = self.problem.settled_fit(first)
        return self.fits[members]

    def movements_of(self, fit: FittedSet) -> Movements:
        """What each effect of a fit moves at the sensors."""
        if fit.members not in self._sizes:
            self._sizes[fit.members] = movements(self.problem.residuals, self.problem.predictions, fit)
        return self._sizes[fit.members]

    def over_time(self, fit: FittedSet) -> HeatOverTime:
        """Heat of unknown origin over time beside a fit."""
        return heat_over_time(self.problem.residuals, self.problem.predictions.evaluations, fit, self.fitting_heat)

    def fitting_heat(self) -> None:
        """Tell that heat of unknown origin is fitted."""
        self.tick("fitting heat of unknown origin")

    def missing_heat(self) -> UnknownHeat:
        """Heat of unknown origin, fitted with the full model if it may be more probable than every set."""
        residuals, predictions, best = self.problem.residuals, self.problem.predictions, self.scored[0]
        missing = self.origin.of(self.null)
        doubtful = best.fit is None or bool(rejection("", best.fit, residuals.settings))
        ahead = self.origin.score(self.null, missing) > best.score - residuals.settings.missing_near
        if doubtful or ahead:
            missing = missing_heat_fitted(residuals, predictions, self.origin.patches, self.null, self.fitting_heat)
        # Several effects may imitate heat that acts during a part of a run only.
        if doubtful or ahead or len(best.members) > 1:
            missing = with_course(missing, self.over_time(self.null))
        return missing


def rank(
    residuals: Residuals,
    predictions: Predictions,
    candidates: Members,
    method: Method,
    tick: Callable[[str], None],
    *,
    law_replaced: bool = False,
) -> Ranking:
    """Search for sets that explain the residuals, and rank them with heat of unknown origin.

    ``law_replaced``: see `beside_discrepancies`.
    """
    searched, ranking = _without_discrepancy(residuals, predictions, candidates, method, tick)
    if predictions.error_at(ranking.best.members, ranking.best.values) > allowed_error(ranking, residuals.settings):
        tick("reduced models are not accurate at the best fit: repeating with simulations")
        predictions.give_up()
        searched, ranking = _without_discrepancy(residuals, predictions, candidates, method, tick)
    if ranking.judgement.verdict == NO_GAP:
        return ranking
    ranking, beside = _beside_discrepancies(searched, ranking, law_replaced=law_replaced)
    if beside is not None:
        return _partly_identified(searched, ranking, beside)
    judgement = ranking.judgement
    if judgement.verdict in (IDENTIFIED, CONFOUNDED) and (sure := certain_members(judgement, residuals.settings)):
        every = supports(residuals, ranking.best, searched.fits, candidates, searched.problem.prior)
        ranking = replace(ranking, supports={member: every[member] for member in sure})
    return ranking


def _without_discrepancy(
    residuals: Residuals, predictions: Predictions, candidates: Members, method: Method, tick: Callable[[str], None]
) -> tuple[Searched, Ranking]:
    """The search, and the ranking before what else may be wrong."""
    searched = _searched(residuals, predictions, candidates, method, tick)
    missing = searched.missing_heat()
    judgement = _judged(searched, missing)
    ahead = judgement.best
    best = ahead.fit or (searched.null if ahead.outside else searched.fit_of(ahead.members))
    moved = searched.movements_of(best)
    return searched, Ranking(judgement, best, searched.null, missing, searched.fit_of, moved)


def _searched(
    residuals: Residuals, predictions: Predictions, candidates: Members, method: Method, tick: Callable[[str], None]
) -> Searched:
    """Sets of effects without a discrepancy, fitted."""
    settings, expected = residuals.settings, residuals.study.card.diagnosis.effects_expected
    prior = SetPrior(candidates, expected, settings.size_shares, settings.odd_run_share)
    origin = UnknownOrigin(residuals, method.criterion, math.log(expected * settings.outside_share))
    problem = SelectionProblem(
        residuals,
        predictions,
        candidates,
        prior,
        method.criterion,
        lambda null: origin.score(null, origin.of(null)),
        tick,
    )
    scored = problem.settled(method.strategy.search(problem))
    fits = {problem.ordered(entry.fit.members): entry.fit for entry in scored if entry.fit is not None}
    return Searched(problem, origin, scored, fits, tick)


def _judged(searched: Searched, missing: UnknownHeat) -> Judgement:
    """The verdict without a discrepancy; sets with effects that move readings by less than the floor are left out."""
    residuals = searched.problem.residuals
    floor = residuals.study.card.diagnosis.discrepancy
    ranked_sets = ranked(searched.scored, searched.origin.score(searched.null, missing), missing.held_out)
    ranking, left_out = without_immaterial(ranked_sets, searched.movements_of, floor)
    if left_out and not ranking[0].outside:
        # The set without them was no leading one, so its fit may be a rough one.
        fit = searched.problem.settled_fit(ranking[0].fit or searched.fit_of(ranking[0].members))
        ranking = (replace(ranking[0], fit=fit), *ranking[1:])
    judgement = judge(ranking, searched.fit_of, residuals.settings)
    probable = inclusion(ranked_sets)
    small = tuple(
        f"{member.key} is not named: it {move.words}; the discrepancy is {floor:g} K"
        for member, move in left_out.items()
        if probable[member.key] >= residuals.settings.alone_probability
    )
    return replace(judgement, reasons=(*judgement.reasons, *small))


@dataclass(frozen=True, eq=False)
class Partly(Brief):
    """Effects that act whatever else is wrong.

    ``problem``: by simulations only. ``members``: the effects. ``robust``: sets beside the discrepancies.
    ``together``: the fit of the effects beside the most probable discrepancy; None: not made.
    """

    problem: SelectionProblem
    members: Members
    robust: Robustness
    together: FittedSet | None


def _beside_discrepancies(searched: Searched, ranking: Ranking, *, law_replaced: bool) -> tuple[Ranking, Partly | None]:
    """The ranking revised beside every discrepancy; effects that act whatever else is wrong, None without any."""
    settings, judgement = searched.problem.settings, ranking.judgement
    problem = replace(searched.problem, predictions=searched.problem.predictions.simulating)
    robust = robustness(
        problem,
        searched.scored,
        certain=judgement.verdict == IDENTIFIED and not law_replaced,
        explained=judgement.verdict != UNEXPLAINED,
    )
    revised = partial(beside_discrepancies, judgement, settings=settings, law_replaced=law_replaced)
    revision, heat = revised(robust), None
    if revision.members:
        leading = robust.models[0]
        heat = free_heat(problem, leading.size, leading.log_evidence(revision.members))
        robust = replace(robust, heat=heat)
        revision = revised(robust, heat=heat)
    if members := revision.members:
        searched.tick("trying other strain laws")
        sets = dict.fromkeys(problem.ordered(each) for each in ((), *((member,) for member in members), members))
        robust = beside_strain_laws(problem, robust, [searched.fit_of(each) for each in sets])
        revision = revised(robust, heat=heat)
    together: FittedSet | None = None
    allowed = robust.models[0].allowed
    if len(revision.members) > 1 and set(revision.members) & set(allowed):
        together = fit_beside(problem, robust.models[0], searched.fit_of(problem.ordered(revision.members)))
        idle = tuple(each for each in not_asked_for(problem, together) if each not in allowed)
        robust = replace(robust, idle=idle)
        revision = revised(robust, heat=heat)
    judgement = judgement.revised(revision.verdict, revision.reasons, revision.doubts)
    ranking = replace(ranking, judgement=judgement, robustness=robust)
    return ranking, Partly(problem, revision.members, robust, together) if revision.members else None


def _partly_identified(searched: Searched, ranking: Ranking, beside: Partly) -> Ranking:
    """The ranking with the fit of the effects that act whatever else is wrong, and the heat beside them."""
    problem, leading = beside.problem, beside.robust.models[0]
    residuals = problem.residuals
    alone, best = searched.fit_of(problem.ordered(beside.members)), beside.together
    if best is None or set(best.members) != set(beside.members):
        best = fit_beside(problem, leading, alone)
    missing = with_course(missing_heat(residuals, searched.origin.patches, alone), searched.over_time(alone))
    # Fits beside a model that allows for a member by itself do not tell what speaks for it.
    comparable = {} if set(best.members) & set(leading.allowed) else leading.fits
    of_effects = supports(leading.residuals or residuals, best, comparable, problem.candidates, problem.prior)
    moved = movements(residuals, searched.problem.predictions, best)
    return replace(ranking, best=best, missing=missing, movements=moved, supports=of_effects)


def allowed_error(ranking: Ranking, settings: DiagnosisSettings) -> float:
    """Largest error of the reduced models at the best fit, as a whitened norm, that cannot change the verdict.

    An error e shifts the ln evidence by e sqrt(misfit / readings) times a standard normal number. Missing heat is often
    ahead by hundreds of nats. Other verdicts need the usual accuracy. Beside a discrepancy all points are simulated.
    """
    judgement = ranking.judgement
    if judgement.verdict != UNEXPLAINED or not judgement.best.outside:
        return settings.reduced_allowed
    lead = judgement.best.score - judgement.ranking[1].score
    shift = math.sqrt(max(ranking.best.misfit / ranking.best.readings, 1.0))
    far = min(lead / (settings.reduced_shift * shift), settings.reduced_allowed_far)
    return max(far, settings.reduced_allowed)


def beside_other_models(ranking: Ranking) -> Ranking:
    """The ranking; identified effects get standard deviations over all discrepancy models, see `Robustness.spread`."""
    if ranking.judgement.verdict != IDENTIFIED or ranking.robustness is None:
        return ranking
    return replace(ranking, best=replace(ranking.best, spread=ranking.robustness.spread(ranking.best)))


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
    if ranking.judgement.verdict != UNEXPLAINED:
        named = [unknown for member in best.members for unknown in member.unknowns]
        if ranking.judgement.verdict == PARTLY:
            named += [unknown for unknown in best.unknowns if unknown.effect == SHAPE and unknown.origin is None]
        values, sd = ({unknown: each[place] for unknown, each in best.totals.items()} for place in (0, 1))
        return values, sd, named
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
    return {number: evaluations.model.blocks_of(number, history) for number, history in enumerate(histories)}
