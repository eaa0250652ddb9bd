"""The fit of the effects that act, beside the model of what else is wrong."""

from __future__ import annotations

import math
from dataclasses import replace

from tyrefem.diagnose.beside.discrepancy import without
from tyrefem.diagnose.beside.ranked_beside import evidence, evidence_without, is_good, nearest
from tyrefem.diagnose.beside.robustness import UnderDiscrepancy
from tyrefem.diagnose.fitting.fits import FittedSet, continued, fitted_beside
from tyrefem.diagnose.fitting.selection import SelectionProblem
from tyrefem.diagnose.unknowns.candidates import Members


def fit_beside(problem: SelectionProblem, model: UnderDiscrepancy, fit: FittedSet) -> FittedSet:
    """The fit of a set beside a model; ``fit``: its fit without a discrepancy.

    It is continued with new sensitivities if it has not converged and noise does not explain its misfit. Effects that
    the model allows for by itself are fitted as effects, and not allowed for a second time.
    """
    known = model.fits.get(problem.ordered(fit.members))
    if model.residuals is None or (known is not None and is_good(known)):
        return known or fit
    members = tuple(member for member in fit.members if member in model.allowed)
    others = problem.ordered(tuple(member for member in fit.members if member not in members))
    start = nearest(model.fits, others, lambda part: model.fits[part].log_evidence)
    here, joining, predictions = model.residuals, members, problem.predictions
    if members and model.discrepancy is not None:
        left = without(model.discrepancy, [member.amplitudes[0] for member in members])
        here = replace(here, shared_error=left.shared_error)
    if start is None or not set(others) <= set(start.members):
        start, joining = fit, ()
    first = known
    if first is None:
        (first,) = fitted_beside(predictions, [(start, here)], problem._count, joining)
    if is_good(first) or not first.worth_continuing:
        return first
    (further,) = continued(here, predictions, [first], problem._count)
    return max(first, further, key=lambda each: each.log_evidence)


def not_asked_for(problem: SelectionProblem, fit: FittedSet) -> Members:
    """Effects of a fit that are not needed in the linear model about it, with the probability of a name.

    Where speed laws of films are fitted as effects, they bend; another effect may have stood in for that.
    """
    least = problem.settings.named_probability
    whole = problem.prior(problem.ordered(fit.members)) + evidence(fit.state, 0.0)
    idle = []
    for member in fit.members:
        part = problem.ordered(each for each in fit.members if each != member)
        if whole - problem.prior(part) - evidence_without(fit, member, 0.0) < math.log(least / (1 - least)):
            idle.append(member)
    return tuple(idle)
