"""Pulls: by how many prior standard deviations a fit corrects base numbers, films and sensors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from tyrefem.brief import Brief
from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.numbers import correction_words
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.unknown import Unknown

#: Largest number of pulls in a sentence.
SHOWN = 4


@dataclass(frozen=True)
class Pull(Brief):
    """A correction ``x`` with its posterior ``sd``; ``pull`` = x over the prior standard deviation."""

    unknown: Unknown
    x: float
    sd: float
    pull: float

    def _title(self) -> str:
        return self.words

    @property
    def words(self) -> str:
        """The correction with its unit, and its pull."""
        return f"{correction_words(self.unknown, self.x, self.sd)}, {self.pull:+z.1f} prior standard deviations"


def _nuisance(fit: FittedSet) -> list[int]:
    """Places of the unknowns that belong to every set."""
    effects = {unknown for member in fit.members for unknown in member.unknowns}
    return [place for place, unknown in enumerate(fit.unknowns) if unknown not in effects]


def pulls(fit: FittedSet) -> tuple[Pull, ...]:
    """The pulls of a fit, largest first."""
    mean, sd = fit.posterior.mean, fit.posterior.sd
    each = [
        Pull(fit.unknowns[k], float(mean[k]), float(sd[k]), float(mean[k] / fit.unknowns[k].sd)) for k in _nuisance(fit)
    ]
    return tuple(sorted(each, key=lambda pull: -abs(pull.pull)))


def pulls_p(fit: FittedSet) -> float:
    """Probability of a sum of squared pulls at least as large, if the set is right.

    The posterior means z, in prior standard deviations, scatter over right data sets with covariance A = 1 - C, C the
    posterior covariance in the same unit: what the data do not tell stays at 0. The sum z^T z is a chi-squared sum with
    the weights eig(A), here by Satterthwaite: scale tr A^2 / tr A, (tr A)^2 / tr A^2 degrees of freedom.
    """
    places = _nuisance(fit)
    if not places:
        return 1.0
    sd = np.array([fit.unknowns[k].sd for k in places])
    z = fit.posterior.mean[places] / sd
    covariance = fit.posterior.covariance[np.ix_(places, places)] / np.outer(sd, sd)
    return float(pulls_probability(np.array(float(z @ z)), covariance))


def pulls_probability(squares: NDArray[np.float64], covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Probability of sums of squared pulls at least as large; ``covariance``: posterior, in prior sd. See `pulls_p`."""
    A = np.eye(len(covariance)) - covariance
    first, second = float(np.trace(A)), float((A * A).sum())
    if first <= 0 or second <= 0:
        return np.ones_like(squares)
    return np.asarray(chdtrc(first**2 / second, squares * first / second))


def improbable_pulls(key: str, fit: FittedSet, settings: DiagnosisSettings) -> str:
    """The reason why a fit with such corrections is no explanation; empty if the corrections are usual ones.

    ``key``: name of the set.
    """
    each = pulls(fit)
    far = [pull for pull in each if abs(pull.pull) > settings.largest_pull]
    subject = f"{key} explains the data" if fit.members else "base numbers and sensors explain the data"
    if far:
        more = f"; and {len(far) - SHOWN} more" if len(far) > SHOWN else ""
        return f"{subject} only with improbable corrections: {'; '.join(pull.words for pull in far[:SHOWN])}{more}"
    p = pulls_p(fit)
    if p < settings.rejected_p:
        shown = "; ".join(pull.words for pull in each[:SHOWN])
        return f"{subject} only with corrections that are improbable together (probability {p:.1g}): {shown}"
    return ""
