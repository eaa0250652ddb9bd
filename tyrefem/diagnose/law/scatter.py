"""Intervals of a law's exponents from the scatter of what the law leaves, series by series."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.heat.evidence import ProjectedData
from tyrefem.diagnose.law.evidence import LawFit
from tyrefem.diagnose.law.terms import LawTerms

Array = NDArray[np.float64]
#: Step of a difference quotient of the law's response, standard deviations of the exponents.
STEP = 0.01


@dataclass(frozen=True, eq=False)
class SeriesScatter(Brief):
    """Readings of each sensor in each run, whose residuals may be alike in time.

    The intervals of independent noise are too narrow where the place has another shape, or a response is not linear:
    neighbours in time then share their residuals. With G the responses' derivatives by ln(amplitude) and exponents, r
    the residuals at the best base numbers and sensors, H = G^T P G + S^-2 (S: prior sd) and s_c = (P G)_c^T r_c of each
    series c,

        covariance = n/(n - 1) H^-1 (sum of s_c s_c^T) H^-1,

    the estimate for n series that are independent of each other (Huber 1967, White 1980; from memory).

    Parameters
    ----------
    data : the data, base numbers and sensors integrated out. columns : (n_data, m) responses to hats at the knots.
    series : rows of each sensor in each run.
    """

    data: ProjectedData
    columns: Array
    series: tuple[slice, ...]

    def widened(self, fit: LawFit, amplitude: float, terms: LawTerms, hats: Array) -> LawFit:
        """The law with the larger of two sd of every exponent: that of independent noise, and that of the scatter."""
        if not len(fit.mean) or len(self.series) < 2:
            return fit
        scatter, _ = self._variances(fit, amplitude, terms, hats)
        factor = np.maximum(np.sqrt(scatter[1:]) / fit.sd, 1.0)
        return replace(fit, covariance=fit.covariance * np.outer(factor, factor))

    def inflation(self, fit: LawFit, amplitude: float, terms: LawTerms, hats: Array) -> float:
        """Mean ratio of the variance of the scatter to that of independent noise, of ln(amplitude) and exponents."""
        if len(self.series) < 2:
            return 1.0
        scatter, independent = self._variances(fit, amplitude, terms, hats)
        return max(float(np.mean(scatter / independent)), 1.0)

    def _variances(self, fit: LawFit, amplitude: float, terms: LawTerms, hats: Array) -> tuple[Array, Array]:
        """Variances of ln(amplitude) and of the exponents: of the scatter, and of independent noise."""
        known, count = dict(terms.features), len(self.series)

        def response(exponents: Array) -> Array:
            return np.asarray(self.columns @ (hats @ (amplitude * fit.strength(known, exponents))))

        steps = STEP * np.diag(fit.sd)
        slopes = [(response(fit.mean + step) - response(fit.mean - step)) / (2 * step.sum()) for step in steps]
        G = np.column_stack([response(fit.mean), *slopes])
        turned = self.data.times(G)
        left = self.data.times(self.data.data - G[:, 0]) / self.data.weight
        scores = np.array([turned[rows].T @ left[rows] for rows in self.series])
        prior = np.diag([0.0, *(1 / terms.prior(name)[1] ** 2 for name in fit.terms)])
        inverse = np.linalg.pinv(G.T @ turned + prior)
        scatter = inverse @ (scores.T @ scores) @ inverse * count / (count - 1)
        return np.maximum(np.diag(scatter), 0.0), np.diag(inverse)
