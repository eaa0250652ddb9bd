"""The ranking of one look: sets of effects, heat of unknown origin, and effects beside discrepancy models."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from tyrefem.brief import Brief
from tyrefem.diagnose.candidates import Candidate, Members, SetPrior
from tyrefem.diagnose.criterion import Criterion
from tyrefem.diagnose.fits import FittedSet, first_fits, fitted_beside
from tyrefem.diagnose.free_heat import free_heat
from tyrefem.diagnose.heat_over_time import heat_over_time
from tyrefem.diagnose.heat_patches import patches
from tyrefem.diagnose.materiality import Movements, movements
from tyrefem.diagnose.missing_heat import UnknownHeat, missing_heat, missing_heat_fitted, with_course
from tyrefem.diagnose.multifidelity import Predictions
from tyrefem.diagnose.options import Method
from tyrefem.diagnose.partly import beside_discrepancies
from tyrefem.diagnose.ranked_beside import beside_strain_laws, fit_beside, robustness
from tyrefem.diagnose.residuals import Residuals
from tyrefem.diagnose.robustness import LEAST_P, Robustness
from tyrefem.diagnose.selection import SelectionProblem
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.support import Support, supports
from tyrefem.diagnose.verdict import (
    IDENTIFIED,
    NO_GAP,
    PARTLY,
    UNEXPLAINED,
    Judgement,
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
    supports : effect of the best set -> its support by the sensors and runs, if the verdict names it.
    """

    judgement: Judgement
    best: FittedSet
    null: FittedSet
    missing: UnknownHeat
    fit_of: Callable[[Members], FittedSet]
    movements: Movements
    robustness: Robustness | None = None
    supports: Mapping[Candidate, Support] = field(default_factory=dict)


def rank(
    residuals: Residuals,
    predictions: Predictions,
    candidates: Members,
    method: Method,
    tick: Callable[[str], None] | None = None,
    *,
    law_replaced: bool = False,
) -> Ranking:
    """Search for sets that explain the residuals, and rank them with heat of unknown origin.

    ``law_replaced``: see `beside_discrepancies`.
    """
    settings, expected = residuals.settings, residuals.study.card.diagnosis.effects_expected
    prior = SetPrior(candidates, expected, settings.size_shares, settings.odd_run_share)
    origin = _UnknownOrigin(residuals, predictions, method.criterion, math.log(expected * settings.outside_share))
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
    null = fits[()]

    def fit_of(members: Members) -> FittedSet:
        if members not in fits:
            (first,) = first_fits(residuals, predictions, [members])
            fits[members] = problem.settled_fit(first)
        return fits[members]

    missing, best = origin.of(null), scored[0]
    doubtful = best.fit is None or bool(rejection("", best.fit, settings))
    doubtful = doubtful or origin.score(null, missing) > best.score - settings.missing_near

    def fitting() -> None:
        if tick:
            tick("fitting heat of unknown origin")

    if doubtful:
        missing = missing_heat_fitted(residuals, predictions, origin.patches, null, fitting)
    # Several effects may imitate heat that acts during a part of a run only.
    if doubtful or len(best.members) > 1:
        missing = with_course(missing, heat_over_time(residuals, predictions.evaluations, null, fitting))
    sizes: dict[Members, Movements] = {}

    def movements_of(fit: FittedSet) -> Movements:
        if fit.members not in sizes:
            sizes[fit.members] = movements(residuals, predictions, fit)
        return sizes[fit.members]

    floor = residuals.study.card.diagnosis.discrepancy
    ranked_sets = ranked(scored, origin.score(null, missing), missing.held_out)
    ranking, left_out = without_immaterial(ranked_sets, movements_of, floor)
    if left_out and not ranking[0].outside:
        # The set without them was no leading one, so its fit may be a rough one.
        fit = problem.settled_fit(ranking[0].fit or fit_of(ranking[0].members))
        ranking = (replace(ranking[0], fit=fit), *ranking[1:])
    judgement = judge(ranking, fit_of, settings)
    probable = inclusion(ranked_sets)
    small = tuple(
        f"{member.key} is not named: it {move.words}; the discrepancy is {floor:g} K"
        for member, move in left_out.items()
        if probable[member.key] >= settings.alone_probability
    )
    judgement = replace(judgement, reasons=(*judgement.reasons, *small))
    ahead = judgement.best
    best_fit = ahead.fit or (null if ahead.outside else fit_of(ahead.members))
    if judgement.verdict == NO_GAP:
        return Ranking(judgement, best_fit, null, missing, fit_of, movements_of(best_fit))
    robust = robustness(
        problem,
        scored,
        certain=judgement.verdict == IDENTIFIED and not law_replaced,
        explained=judgement.verdict != UNEXPLAINED,
    )
    revision, heat = beside_discrepancies(judgement, robust, settings, law_replaced=law_replaced), None
    if revision.members:
        heat = free_heat(problem, problem.ordered(revision.members), robust.models[0].size)
        revision = beside_discrepancies(judgement, robust, settings, law_replaced=law_replaced, heat=heat)
    if partly := revision.members:
        if tick:
            tick("trying other strain laws")
        sets = dict.fromkeys(problem.ordered(each) for each in ((), *((member,) for member in partly), partly))
        robust = beside_strain_laws(problem, robust, [fit_of(members) for members in sets])
        revision = beside_discrepancies(judgement, robust, settings, law_replaced=law_replaced, heat=heat)
    judgement = judgement.revised(revision.verdict, revision.reasons, revision.doubts)
    partly = revision.members
    if not partly:
        of_effects = {}
        if judgement.verdict == IDENTIFIED:
            of_effects = supports(residuals, best_fit, fits, candidates, prior)
        return Ranking(judgement, best_fit, null, missing, fit_of, movements_of(best_fit), robust, of_effects)
    alone = fit_of(problem.ordered(partly))
    best_fit = fit_beside(problem, robust.models[0], alone)
    over_time = heat_over_time(residuals, predictions.evaluations, alone, fitting)
    missing = with_course(missing_heat(residuals, origin.patches, alone), over_time)
    moved = movements(residuals, predictions, best_fit)
    leading = robust.models[0]
    of_effects = supports(leading.residuals or residuals, best_fit, leading.fits, candidates, prior)
    return Ranking(judgement, best_fit, null, missing, fit_of, moved, robust, of_effects)


def allowed_error(ranking: Ranking, settings: DiagnosisSettings) -> float:
    """Largest error of the reduced models at the best fit, as a whitened norm, that cannot change the verdict.

    An error e shifts the ln evidence by e sqrt(misfit / readings) times a standard normal number. Missing heat is often
    ahead by hundreds of nats. Effects that are named beside every discrepancy model bear the error of another one;
    their fit is then simulated. Other verdicts need the usual accuracy.
    """
    judgement = ranking.judgement
    if judgement.verdict not in (UNEXPLAINED, PARTLY) or not judgement.best.outside:
        return settings.reduced_allowed
    if judgement.verdict == PARTLY:
        return settings.reduced_allowed_far
    lead = judgement.best.score - judgement.ranking[1].score
    shift = math.sqrt(max(ranking.best.misfit / ranking.best.readings, 1.0))
    far = min(lead / (settings.reduced_shift * shift), settings.reduced_allowed_far)
    return max(far, settings.reduced_allowed)


def beside_other_models(ranking: Ranking) -> Ranking:
    """The ranking; identified effects get standard deviations over all discrepancy models, see `Robustness.spread`."""
    if ranking.judgement.verdict != IDENTIFIED or ranking.robustness is None:
        return ranking
    return replace(ranking, best=replace(ranking.best, spread=ranking.robustness.spread(ranking.best)))


def simulated_best(ranking: Ranking, predictions: Predictions) -> Ranking | None:
    """The ranking with the fit of named effects continued by simulations; None if it no longer explains the data."""
    robust = ranking.robustness
    if ranking.judgement.verdict != PARTLY or robust is None or (beside := robust.models[0].residuals) is None:
        return ranking
    (fit,) = fitted_beside(predictions, [(ranking.best, beside)])
    return replace(ranking, best=fit) if fit.p_value > LEAST_P else None


class _UnknownOrigin:
    """Heat of unknown origin as an alternative to all sets of the catalogue; ``prior``: ln of its prior probability."""

    def __init__(self, residuals: Residuals, predictions: Predictions, criterion: Criterion, prior: float) -> None:
        self.residuals, self.criterion, self.prior = residuals, criterion, prior
        self.patches = patches(residuals.study, residuals.settings)

    def of(self, null: FittedSet) -> UnknownHeat:
        """The heat, estimated in the linear model about the fit of no effect."""
        return missing_heat(self.residuals, self.patches, null)

    def score(self, null: FittedSet, heat: UnknownHeat) -> float:
        """ln(prior) + criterion of no effect + gain of ln evidence by the heat."""
        return self.prior + self.criterion.of_fit(null) + (heat.log_evidence - null.log_evidence)
