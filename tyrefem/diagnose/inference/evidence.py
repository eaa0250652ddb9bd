"""Posterior and evidence of a linear model with priors and bounds, from Gram matrices alone."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.special import log_ndtr

from tyrefem.brief import Brief

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Posterior(Brief):
    """Posterior of the unknowns: ``mean`` (k,) within the bounds, ``covariance`` (k, k), ``at_bound`` (k,).

    ``log_evidence`` is without -(1/2) |d|^2 and without the constants that all models of the same data share.
    ``beyond`` (k,): distance of the best value beyond the active bound, in standard deviations; 0 for other parameters.
    """

    mean: Array
    covariance: Array
    log_evidence: float
    at_bound: NDArray[np.bool_]
    beyond: Array

    @property
    def sd(self) -> Array:
        """(k,) standard deviations."""
        return np.sqrt(np.diag(self.covariance))


def posterior(gram: Array, overlap: Array, sd: Array, low: Array, high: Array) -> Posterior:
    """The posterior of d = J x + e, e ~ N(0, 1), x ~ N(0, sd^2) cut to [low, high].

    Evidence of the model without bounds, ln Z = b^T (G + S^-2)^-1 b / 2 - ln det(1 + S G S) / 2, times the posterior
    mass of the bounds over their prior mass, each taken parameter by parameter.

    Parameters
    ----------
    gram : G = J^T J (k, k); overlap : b = J^T d (k,); sd, low, high : (k,).

    >>> wide = np.array([np.inf])
    >>> solved = posterior(np.array([[4.0]]), np.array([8.0]), np.array([1.0]), -wide, wide)
    >>> solved.mean.round(3), round(solved.log_evidence, 3)      # 8/5, 64/(2 x 5) - ln(5)/2
    (array([1.6]), 5.595)
    """
    k = len(sd)
    if k == 0:
        return Posterior(np.zeros(0), np.zeros((0, 0)), 0.0, np.zeros(0, dtype=bool), np.zeros(0))
    if k == 1:
        return _of_one(float(gram[0, 0]), float(overlap[0]), float(sd[0]), float(low[0]), float(high[0]))
    scaled = gram * sd[:, None] * sd[None, :]
    matrix = np.eye(k) + scaled
    factor = cho_factor(matrix, lower=True)
    right = sd * overlap
    z = cho_solve(factor, right)
    covariance_z = cho_solve(factor, np.eye(k))
    log_evidence = float(right @ z / 2 - np.log(np.diag(factor[0])).sum())
    low_z, high_z = low / sd, high / sd
    spread = np.sqrt(np.diag(covariance_z))
    bounded = np.isfinite(low) | np.isfinite(high)
    log_evidence += float(bounds_mass(z[bounded], spread[bounded], low_z[bounded], high_z[bounded]).sum())
    held = np.zeros(k, dtype=bool)
    for _ in range(k):
        beyond = (z < low_z - 1e-12) | (z > high_z + 1e-12)
        if not beyond.any():
            break
        # Fix the parameter that is farthest (in standard deviations) beyond its bound; fit the others again.
        worst = int(np.argmax(np.maximum(low_z - z, z - high_z) / spread))
        held[worst] = True
        z = _held(matrix, right, np.clip(z, low_z, high_z), held)
    # The slope of the misfit at a bound, divided by its slope one standard deviation from the best point.
    beyond = np.where(held, np.abs(right - matrix @ z) * spread, 0.0)
    return Posterior(z * sd, covariance_z * sd[:, None] * sd[None, :], log_evidence, held, beyond)


def _of_one(gram: float, overlap: float, sd: float, low: float, high: float) -> Posterior:
    """`posterior` of one unknown; searches ask for hundreds of thousands."""
    slope, right, low, high = 1 + gram * sd**2, sd * overlap, low / sd, high / sd
    best, spread = right / slope, 1 / math.sqrt(slope)
    log_evidence = right * best / 2 - math.log(slope) / 2
    if math.isfinite(low) or math.isfinite(high):
        log_evidence += _log_mass((low - best) / spread, (high - best) / spread) - _log_mass(low, high)
    held = best < low - 1e-12 or best > high + 1e-12
    z = min(max(best, low), high) if held else best
    beyond = abs(right - slope * z) * spread if held else 0.0
    covariance = np.array([[(spread * sd) ** 2]])
    return Posterior(np.array([z * sd]), covariance, log_evidence, np.array([held]), np.array([beyond]))


def _held(matrix: Array, right: Array, z: Array, held: NDArray[np.bool_]) -> Array:
    free = ~held
    result = z.copy()
    if free.any():
        rest = right[free] - matrix[np.ix_(free, held)] @ z[held]
        result[free] = np.linalg.solve(matrix[np.ix_(free, free)], rest)
    return result


def bounds_mass(mean: Array, spread: Array, low: Array, high: Array) -> Array:
    """ln of the posterior mass within bounds over the prior's, for posteriors N(mean, spread^2) and priors N(0, 1).

    >>> float(bounds_mass(np.array(-3.0), np.array(0.5), np.array(-1.0), np.array(np.inf)).round(2))    # 4 sd beyond
    -10.19
    """
    return _log_masses((low - mean) / spread, (high - mean) / spread) - _log_masses(low, high)


def _log_masses(low: Array, high: Array) -> Array:
    """ln P(low < x < high) of a standard normal, stable in the tails."""
    flip = low > 0
    low, high = np.where(flip, -high, low), np.where(flip, -low, high)
    upper = log_ndtr(high)
    return np.asarray(upper + np.log1p(-np.exp(np.minimum(log_ndtr(low) - upper, -1e-300))))


def _log_mass(low: float, high: float) -> float:
    """ln P(low < x < high) of a standard normal, stable in the tails."""
    if low > 0:
        low, high = -high, -low
    upper, lower = log_ndtr(high), log_ndtr(low)
    return float(upper + np.log1p(-np.exp(min(lower - upper, -1e-300)))) if lower > -np.inf else float(upper)
