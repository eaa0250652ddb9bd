"""Leading fits with sensitivities at their points, so that their evidences can be compared."""

from __future__ import annotations

from collections.abc import Sequence

from tyrefem.diagnose.fits import FittedSet
from tyrefem.diagnose.selection import ScoredSet, SelectionProblem


def settled(problem: SelectionProblem, scored: Sequence[ScoredSet]) -> list[ScoredSet]:
    """Scored sets, best first, whose leading fits have converged with sensitivities taken at their points.

    The evidence of a fit rests on its sensitivities: those from another point are worth some nats for nothing. Fits
    within ``leading_score`` of the best are continued until they are settled, at most ``most_settlings`` times. A fit
    with a misfit that no further step can explain stays as it is. Estimates without a fit stay below the best fit.
    """
    settings = problem.settings
    rows = {problem.ordered(entry.members): entry for entry in scored}
    gap = scored[0].score - max((entry.score for entry in scored if entry.fit is None), default=float("-inf"))
    changed = False
    for _ in range(settings.most_settlings):
        top = max(entry.score for entry in rows.values() if entry.fit is not None)
        left = [
            entry.fit
            for entry in rows.values()
            if entry.fit is not None and entry.score > top - settings.leading_score and _worth_settling(entry.fit)
        ]
        if not left:
            break
        changed = True
        for fit in problem.continued(left):
            rows[problem.ordered(fit.members)] = ScoredSet(problem.score(fit), fit.members, fit)
    if not changed:
        return list(scored)
    highest = max(entry.score for entry in rows.values() if entry.fit is not None) - max(gap, 0.0)
    capped = (
        entry if entry.fit is not None else entry._replace(score=min(entry.score, highest)) for entry in rows.values()
    )
    return sorted(capped, key=lambda entry: -entry.score)


def settled_fit(problem: SelectionProblem, fit: FittedSet) -> FittedSet:
    """A fit continued until it has converged with sensitivities taken at its point, if it gets there."""
    for _ in range(problem.settings.most_settlings):
        if not _worth_settling(fit):
            break
        (fit,) = problem.continued([fit])
    return fit


def _worth_settling(fit: FittedSet) -> bool:
    return not fit.settled and fit.misfit < fit.state.settings.slow_misfit * fit.readings
