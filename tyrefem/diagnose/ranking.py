"""Residuals to a ranking: the search of one look at the data, heat of unknown origin beside it, and the verdict."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from tyrefem.brief import Brief
from tyrefem.diagnose.candidates import CandidateSpace, Members, SetPrior, catalogue_candidates
from tyrefem.diagnose.criterion import Criterion, LogEvidence
from tyrefem.diagnose.fits import FittedSet, first_fits
from tyrefem.diagnose.forward_selection import ForwardSelection
from tyrefem.diagnose.heat_patches import patches
from tyrefem.diagnose.missing_heat import UnknownHeat, missing_heat, missing_heat_fitted
from tyrefem.diagnose.multifidelity import Predictions
from tyrefem.diagnose.residuals import Residuals
from tyrefem.diagnose.selection import SelectionProblem, Strategy
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.verdict import Judgement, judge, ranked


@dataclass(frozen=True)
class Method:
    """The parts of a diagnosis, each of which may be replaced.

    Parameters
    ----------
    candidates : study -> the effects that it may lack. criterion : how well a set explains the data.
    strategy : which sets are fitted, in which order. settings : every number that steers the diagnosis.
    """

    candidates: CandidateSpace = catalogue_candidates
    criterion: Criterion = field(default_factory=LogEvidence)
    strategy: Strategy = field(default_factory=ForwardSelection)
    settings: DiagnosisSettings = DEFAULT


@dataclass(frozen=True, eq=False)
class Ranking(Brief):
    """What the search of one look comes to.

    Parameters
    ----------
    judgement : verdict, and sets with their probabilities. best, null : fits with the most probable set and with none.
    missing : heat of unknown origin. fit_of : the fit of a set, made if it has none.
    """

    judgement: Judgement
    best: FittedSet
    null: FittedSet
    missing: UnknownHeat
    fit_of: Callable[[Members], FittedSet]


def rank(
    residuals: Residuals,
    predictions: Predictions,
    candidates: Members,
    method: Method,
    tick: Callable[[str], None] | None = None,
) -> Ranking:
    """Search the sets that explain the residuals, and judge them against each other and against an unknown cause."""
    settings, expected = residuals.settings, residuals.study.card.diagnosis.effects_expected
    prior = SetPrior(candidates, expected, settings.size_shares)
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
    scored = method.strategy.search(problem)
    fits = {problem.ordered(entry.fit.members): entry.fit for entry in scored if entry.fit is not None}
    null = fits[()]

    def fit_of(members: Members) -> FittedSet:
        if members not in fits:
            (fits[members],) = first_fits(residuals, predictions, [members])
        return fits[members]

    missing, best = origin.of(null), scored[0]
    doubtful = best.fit is None or min(best.fit.p_value, best.fit.held_out_p) < settings.improbable
    if doubtful or origin.score(null, missing) > best.score - settings.missing_near:
        missing = missing_heat_fitted(
            residuals,
            predictions,
            origin.patches,
            null,
            lambda: tick("fitting heat of unknown origin") if tick else None,
        )
    judgement = judge(ranked(scored, origin.score(null, missing)), fit_of, settings)
    ahead = judgement.best
    return Ranking(judgement, ahead.fit or (null if ahead.outside else fit_of(ahead.members)), null, missing, fit_of)


class _UnknownOrigin:
    """Heat of unknown origin as a rival of all sets of the catalogue; ``prior``: ln of its prior probability."""

    def __init__(self, residuals: Residuals, predictions: Predictions, criterion: Criterion, prior: float) -> None:
        self.residuals, self.criterion, self.prior = residuals, criterion, prior
        self.patches = patches(residuals.study, residuals.settings)

    def of(self, null: FittedSet) -> UnknownHeat:
        """In the linear model about the fit of no effect."""
        return missing_heat(self.residuals, self.patches, null)

    def score(self, null: FittedSet, heat: UnknownHeat) -> float:
        """ln(prior) + criterion: of no effect, and what the evidence gains by the heat."""
        return self.prior + self.criterion.of_fit(null) + (heat.log_evidence - null.log_evidence)
