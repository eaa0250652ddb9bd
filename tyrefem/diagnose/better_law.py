"""A diagnosis by another strain law, taken in place of that by the study's law if the data clearly prefer it."""

from __future__ import annotations

import math
from dataclasses import replace

from tyrefem.diagnose.beside.law_trials import BetterLaw, LawTrial, stated_law
from tyrefem.diagnose.beside.robustness import LEAST_P
from tyrefem.diagnose.diagnosis import DiagnosisData
from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.verdicts.verdict import NO_GAP, UNEXPLAINED

#: Another law is taken if its ln evidence is ahead by this, over all sets of effects and discrepancies.
CLEARLY = 10.0


def by_better_law(stated: DiagnosisData, other: DiagnosisData, trial: LawTrial) -> DiagnosisData:
    """The diagnosis of a study by the better of two strain laws; ``other``: by the law of ``trial``.

    The other law is taken if its evidence is ahead by `CLEARLY` and it predicts the held-out runs better. Where noise
    explains the fitted runs by the other law only, it is enough that noise explains its held-out runs, too. Without a
    gap by this law the verdict is "unexplained": a strain law is no effect of the catalogue.
    """
    log_odds, lead = evidence(other) - evidence(stated), held_out(other) - held_out(stated)
    if log_odds < CLEARLY or (lead < 0 and not (_refuted(stated) and _explains(other))):
        return stated
    alone = other.verdict == NO_GAP
    judgement = other.judgement
    if alone:
        reason = f"with the strain law {trial.law} no effect is missing"
        judgement = judgement.revised(UNEXPLAINED, (*judgement.reasons, reason), ())
    return replace(
        other,
        original=stated.original,
        judgement=judgement,
        before=stated.before,
        seconds=stated.seconds + other.seconds,
        law_trials=stated.law_trials,
        better_law=BetterLaw(stated_law(stated.gap), trial, log_odds, lead, alone),
    )


def evidence(d: DiagnosisData) -> float:
    """ln evidence of a diagnosis over all sets of effects and discrepancies; without a gap that of no effect alone."""
    if d.robustness is not None:
        return d.robustness.log_evidence
    return d.prior(()) + d.null.log_evidence + math.log(d.gap.settings.right_model)


def held_out(d: DiagnosisData) -> float:
    """ln p(held-out data | fitted data) of the best fitted set beside the most probable discrepancy."""
    return _leading(d).held_out


def _leading(d: DiagnosisData) -> FittedSet:
    """The best fitted set beside the most probable discrepancy."""
    if d.robustness is None:
        return d.null
    fits = d.robustness.models[0].fits
    return max(fits.values(), key=lambda fit: d.prior(fit.members) + fit.log_evidence)


def _refuted(d: DiagnosisData) -> bool:
    """Whether noise cannot explain the fitted runs, not even beside the most probable discrepancy."""
    return d.robustness is not None and d.robustness.models[0].refuted


def _explains(d: DiagnosisData) -> bool:
    """Whether noise explains what the best set leaves, of the fitted and of the held-out runs."""
    fit, least = _leading(d), d.gap.settings.rejected_p
    return fit.p_value > LEAST_P and fit.held_out_p > least
