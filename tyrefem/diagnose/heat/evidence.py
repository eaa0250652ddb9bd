"""Evidence and posterior of heat sources over time in a linear model whose nuisance unknowns are integrated out."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from tyrefem.brief import Brief

Array = NDArray[np.float64]
Key = TypeVar("Key")


class PlaceResponses(Protocol):
    """Whitened responses ``columns`` (n, m) to heat at one place. It is hashed by identity."""

    @property
    def columns(self) -> Array:
        """(n, m)."""


@dataclass(frozen=True, eq=False)
class ProjectedData(Brief):
    """Whitened data d = J x + e, e ~ N(0, 1), x ~ N(0, sd^2), with x integrated out: d ~ N(0, P^-1).

    P = (1/weight + J S^2 J^T)^-1. A ``weight`` below 1 makes the noise larger, by what a linear model cannot explain.

    Parameters
    ----------
    data : (n,). jacobian : (n, k). sd : (k,).

    >>> projected = ProjectedData(np.array([2.0]), np.array([[1.0]]), np.array([1.0]))
    >>> round(projected.log_evidence, 6)  # -2^2/2/2 - ln(2)/2
    -1.346574
    """

    data: Array
    jacobian: Array
    sd: Array
    weight: float = 1.0

    @cached_property
    def _scaled(self) -> Array:
        return self.jacobian * (self.sd * np.sqrt(self.weight))

    @cached_property
    def _factor(self) -> tuple[Array, bool]:
        factor: tuple[Array, bool] = cho_factor(np.eye(len(self.sd)) + self._scaled.T @ self._scaled, lower=True)
        return factor

    def times(self, columns: Array) -> Array:
        """P times columns (n, ...)."""
        left = columns - self._scaled @ cho_solve(self._factor, self._scaled.T @ columns)
        return np.asarray(self.weight * left)

    @cached_property
    def log_evidence(self) -> float:
        """ln p(data | no heat), without -n ln(2 pi)/2."""
        half = float(np.log(np.diag(self._factor[0])).sum())
        return len(self.data) * float(np.log(self.weight)) / 2 - self.misfit / 2 - half

    @cached_property
    def misfit(self) -> float:
        """d^T P d: |r|^2 + |x/sd|^2 at the best x, without any heat."""
        return float(self.data @ self.times(self.data))

    @cached_property
    def _overlaps(self) -> dict[PlaceResponses, Array]:
        return {}

    @cached_property
    def _grams(self) -> dict[tuple[PlaceResponses, PlaceResponses], Array]:
        return {}

    def overlap(self, place: PlaceResponses) -> Array:
        """(m,) Phi^T P d of a place's responses; kept."""
        if place not in self._overlaps:
            self._overlaps[place] = place.columns.T @ self.times(self.data)
        return self._overlaps[place]

    def gram(self, first: PlaceResponses, second: PlaceResponses) -> Array:
        """(m_1, m_2) Phi_1^T P Phi_2 of two places' responses; kept."""
        if (first, second) not in self._grams:
            matrix = first.columns.T @ self.times(second.columns)
            self._grams[first, second], self._grams[second, first] = matrix, matrix.T
        return self._grams[first, second]

    def with_sources(self, columns: Array) -> HeatData:
        """The statistics of sources with responses ``columns`` (n, m)."""
        projected = self.times(columns)
        return HeatData(columns.T @ projected, projected.T @ self.data)


@dataclass(frozen=True, eq=False)
class HeatData(Brief):
    """Statistics of the coefficients c of heat sources: ``gram`` Phi^T P Phi (m, m), ``overlap`` Phi^T P d (m,).

    A prior of c is given by a factor L (m, r): c = L z, z ~ N(0, 1).
    """

    gram: Array
    overlap: Array

    def gain(self, factor: Array) -> float:
        """ln p(data | heat with this prior) - ln p(data | no heat)."""
        matrix, right, _ = self._solved(factor)
        return float(right @ cho_solve(matrix, right) / 2 - np.log(np.diag(matrix[0])).sum())

    def explained(self, factor: Array) -> float:
        """Part of the misfit that the heat explains, at the best x and c."""
        matrix, right, _ = self._solved(factor)
        return float(right @ cho_solve(matrix, right))

    def posterior(self, factor: Array) -> tuple[Array, Array]:
        """Mean (m,) and covariance (m, m) of c."""
        matrix, right, L = self._solved(factor)
        return L @ cho_solve(matrix, right), L @ cho_solve(matrix, L.T)

    def _solved(self, factor: Array) -> tuple[tuple[Array, bool], Array, Array]:
        right = factor.T @ self.overlap
        return cho_factor(np.eye(len(right)) + factor.T @ self.gram @ factor, lower=True), right, factor


def log_mean_exp(values: list[float] | Array) -> float:
    """ln of the mean of exp(values)."""
    array = np.asarray(values, dtype=float)
    top = float(array.max())
    return top + float(np.log(np.exp(array - top).mean()))


def mean_time(times: Sequence[float | None], gains: Array) -> tuple[float, float]:
    """Mean and standard deviation, s, of the time of a switch by ln evidence (n,) at evenly spaced times; NaN without.

    Within the spacing of the times the time is uniform: its variance spacing^2 / 12 is added.

    >>> [round(value, 3) for value in mean_time([10.0, 20.0], np.zeros(2))]
    [15.0, 5.774]
    """
    if any(time is None for time in times):
        return math.nan, math.nan
    at = np.array(times, dtype=float)
    weights = np.exp(gains - gains.max())
    weights /= weights.sum()
    mean = float(weights @ at)
    spacing = float(np.diff(at).min()) if len(at) > 1 else 0.0
    return mean, math.sqrt(float(weights @ (at - mean) ** 2) + spacing**2 / 12)


def shares(logs: Mapping[Key, float]) -> dict[Key, float]:
    """exp(values), scaled to the sum 1, largest first."""
    top = max(logs.values())
    weights = {key: float(np.exp(value - top)) for key, value in logs.items()}
    total = sum(weights.values())
    return {key: weight / total for key, weight in sorted(weights.items(), key=lambda item: -item[1])}
