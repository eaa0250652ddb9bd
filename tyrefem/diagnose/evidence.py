"""All trials stacked and whitened: evidence of any set of candidates, from Gram matrices alone.

The Gaussian fit under everything: posterior and evidence of a linear model with priors and bounds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.special import log_ndtr

from tyrefem.brief import Brief
from tyrefem.diagnose.unknowns import Candidate, Unknown

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Fit(Brief):
    """A fit: ``mean`` (k,) within the bounds, ``covariance`` (k, k), log evidence, and which are at a bound.

    ``log_evidence`` leaves out -(1/2) |d|^2 and the constants that every model on the same data shares. ``beyond``
    (k,): by how many standard deviations the data want a parameter beyond the bound that it is at; 0 elsewhere.
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


def fit(gram: Array, overlap: Array, sd: Array, low: Array, high: Array) -> Fit:
    """Fit d = J x + e, e ~ N(0, 1), x ~ N(0, sd^2) cut to [low, high].

    Evidence of the model without bounds, ln Z = b^T (G + S^-2)^-1 b / 2 - ln det(1 + S G S) / 2, times the posterior
    mass of the bounds over their prior mass, each taken parameter by parameter.

    Parameters
    ----------
    gram : G = J^T J (k, k); overlap : b = J^T d (k,); sd, low, high : (k,).

    >>> one = fit(np.array([[4.0]]), np.array([8.0]), np.array([1.0]), np.array([-np.inf]), np.array([np.inf]))
    >>> one.mean.round(3), round(one.log_evidence, 3)      # 8/5, 64/(2 x 5) - ln(5)/2
    (array([1.6]), 5.595)
    """
    k = len(sd)
    if k == 0:
        return Fit(np.zeros(0), np.zeros((0, 0)), 0.0, np.zeros(0, dtype=bool), np.zeros(0))
    scaled = gram * sd[:, None] * sd[None, :]
    matrix = np.eye(k) + scaled
    factor = cho_factor(matrix, lower=True)
    right = sd * overlap
    z = cho_solve(factor, right)
    covariance_z = cho_solve(factor, np.eye(k))
    log_evidence = float(right @ z / 2 - np.log(np.diag(factor[0])).sum())
    low_z, high_z = low / sd, high / sd
    spread = np.sqrt(np.diag(covariance_z))
    for i in np.flatnonzero(np.isfinite(low) | np.isfinite(high)):
        log_evidence += _log_mass((low_z[i] - z[i]) / spread[i], (high_z[i] - z[i]) / spread[i])
        log_evidence -= _log_mass(low_z[i], high_z[i])
    held = np.zeros(k, dtype=bool)
    for _ in range(k):
        beyond = (z < low_z - 1e-12) | (z > high_z + 1e-12)
        if not beyond.any():
            break
        # Hold the one that is farthest out, in its own standard deviations, on its bound, and fit the rest again.
        worst = int(np.argmax(np.maximum(low_z - z, z - high_z) / spread))
        held[worst] = True
        z = _held(matrix, right, np.clip(z, low_z, high_z), held)
    # The slope of the misfit at a bound, over what it would be one standard deviation off the best place.
    beyond = np.where(held, np.abs(right - matrix @ z) * spread, 0.0)
    return Fit(z * sd, covariance_z * sd[:, None] * sd[None, :], log_evidence, held, beyond)


def _held(matrix: Array, right: Array, z: Array, held: NDArray[np.bool_]) -> Array:
    free = ~held
    result = z.copy()
    if free.any():
        rest = right[free] - matrix[np.ix_(free, held)] @ z[held]
        result[free] = np.linalg.solve(matrix[np.ix_(free, free)], rest)
    return result


def _log_mass(low: float, high: float) -> float:
    """ln P(low < x < high) of a standard normal, stable in the tails."""
    if low > 0:
        low, high = -high, -low
    upper, lower = log_ndtr(high), log_ndtr(low)
    return float(upper + np.log1p(-np.exp(min(lower - upper, -1e-300)))) if lower > -np.inf else float(upper)


Members = tuple[Candidate, ...]


@dataclass(frozen=True, eq=False)
class Linear:
    """d = J x + e about x = 0, whitened: ``data`` (n,), ``jacobian`` (n, k) of ``unknowns``; ``nuisance``: how many of
    them, the first, belong to every model.
    """

    unknowns: tuple[Unknown, ...]
    nuisance: int
    data: Array
    jacobian: Array

    def with_data(self, data: Array) -> Linear:
        """The same model of other data; what does not depend on them is kept."""
        _ = self._marginal
        other = Linear(self.unknowns, self.nuisance, data, self.jacobian)
        for name in ("place", "gram", "sd", "_inverse", "_marginal"):
            if name in self.__dict__:
                other.__dict__[name] = self.__dict__[name]
        return other

    @cached_property
    def place(self) -> dict[Unknown, int]:
        """Unknown -> its column."""
        return {one: column for column, one in enumerate(self.unknowns)}

    @cached_property
    def gram(self) -> Array:
        """J^T J."""
        return np.asarray(self.jacobian.T @ self.jacobian)

    @cached_property
    def overlap(self) -> Array:
        """J^T d."""
        return np.asarray(self.jacobian.T @ self.data)

    @cached_property
    def sd(self) -> Array:
        """Prior standard deviations."""
        return np.array([one.sd for one in self.unknowns])

    @cached_property
    def _marginal(self) -> tuple[Array, Array, float]:
        """With the nuisance integrated out: Gram of the others, G_en (G_nn + S^-2)^-1, and ln det(1 + S G S) / 2."""
        n = self.nuisance
        sd = self.sd[:n]
        projection = self.gram[n:, :n] @ self._inverse
        gram = self.gram[n:, n:] - projection @ self.gram[:n, n:]
        return gram, projection, float(np.linalg.slogdet(np.eye(n) + self.gram[:n, :n] * np.outer(sd, sd))[1] / 2)

    @cached_property
    def _inverse(self) -> Array:
        """(G + S^-2)^-1 of the nuisance."""
        n = self.nuisance
        sd = self.sd[:n]
        return np.asarray(np.linalg.inv(np.eye(n) + self.gram[:n, :n] * sd[:, None] * sd[None, :]) * np.outer(sd, sd))

    def columns(self, unknowns: Sequence[Unknown]) -> NDArray[np.intp]:
        """Columns of unknowns."""
        return np.array([self.place[one] for one in unknowns], dtype=np.intp)

    def log_evidence(self, members: Members) -> float:
        """ln p(d | the members' amplitudes and the nuisance), up to a constant of the data."""
        n = self.nuisance
        overlap, fixed = self.overlap, 0.0
        present = self.columns([one for member in members for one in member.presence])
        if len(present):
            # What is simply there is taken off the data: d' = d - J 1.
            overlap = overlap - self.gram[:, present].sum(axis=1)
            fixed = float(self.overlap[present].sum() - self.gram[np.ix_(present, present)].sum() / 2)
        gram, projection, half = self._marginal
        own = fixed - half + float(overlap[:n] @ self._inverse @ overlap[:n]) / 2
        unknowns = [one for member in members for one in member.amplitudes]
        if not unknowns:
            return own
        at = self.columns(unknowns) - n
        limits = np.array([(one.low, one.high) for one in unknowns])
        reduced = overlap[n:][at] - projection[at] @ overlap[:n]
        return own + fit(gram[np.ix_(at, at)], reduced, self.sd[n:][at], *limits.T).log_evidence

    def fit(self, unknowns: Sequence[Unknown]) -> Fit:
        """Posterior of the given unknowns, all others null."""
        at = self.columns(unknowns)
        limits = np.array([(one.low, one.high) for one in unknowns]).reshape(-1, 2)
        return fit(self.gram[np.ix_(at, at)], self.overlap[at], self.sd[at], *limits.T)

    @property
    def constant(self) -> float:
        """-|d|^2/2, which evidences about other points need."""
        return float(-self.data @ self.data / 2)
