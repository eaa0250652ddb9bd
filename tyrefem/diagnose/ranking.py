"""Sets of effects of one diagnosis: searched, judged, and ranked beside what else may be wrong."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from tyrefem.brief import Brief
from tyrefem.diagnose.beside.best_fit import fit_beside, not_asked_for
from tyrefem.diagnose.beside.free_heat import free_heat
from tyrefem.diagnose.beside.ranked_beside import nearest
from tyrefem.diagnose.beside.ranking import robustness
from tyrefem.diagnose.beside.robustness import Robustness
from tyrefem.diagnose.beside.strain_laws import beside_strain_laws
from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.fitting.fits import FittedSet, first_fits
from tyrefem.diagnose.fitting.materiality import Movements, movements
from tyrefem.diagnose.fitting.selection import ScoredSet, SelectionProblem
from tyrefem.diagnose.fitting.support import Support, supports
from tyrefem.diagnose.forward.multifidelity import Predictions
from tyrefem.diagnose.heat.missing_heat import UnknownHeat, missing_heat, missing_heat_fitted, with_course
from tyrefem.diagnose.heat.over_time import HeatOverTime, heat_over_time
from tyrefem.diagnose.heat.unknown_origin import UnknownOrigin
from tyrefem.diagnose.options import Method
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import (
    Candidate,
    Members,
    SetPrior,
)
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
    """The ranking; named effects get standard deviations over all discrepancy models, see `Robustness.spread`."""
    if ranking.judgement.verdict not in (IDENTIFIED, PARTLY) or ranking.robustness is None:
        return ranking
    return replace(ranking, best=replace(ranking.best, spread=ranking.robustness.spread(ranking.best)))


def lacking_unknowns(
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
