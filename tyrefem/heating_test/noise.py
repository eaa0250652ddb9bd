"""Covariance of the residuals: noise of the instrument, and model error.

The model error is a random process proportional to the rise, eps g(t) z(t), with z an Ornstein-Uhlenbeck process of
correlation time tau: neighbouring readings are correlated, and narrow the intervals less than independent ones.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve, cholesky, solve_triangular

from tyrefem.brief import Brief
from tyrefem.heating_test.readings import SensorReadings

Array = NDArray[Any]
#: Allowed correlation times, s.
SHORTEST, LONGEST = 5.0, 1000.0
#: Largest relative model error of the estimate.
LARGEST = 0.1
_GROUPS = 110
#: Model error, relative to the rise, from which on it is reported; in noises of a reading, from which on it is clear.
ASTRAY, CLEAR = 0.01, 2.0


@dataclass(frozen=True)
class Noise:
    """Standard deviations by sensor: of a reading, K, and of the model error relative to the rise; tau in s."""

    reading: Mapping[str, float]
    model: Mapping[str, float]
    tau: float = 200.0

    def factor(self, series: SensorReadings, rise: Array) -> Array:
        """Lower Cholesky factor of the covariance of a series, `rise` (n,) in K."""
        gap = np.abs(series.times[:, None] - series.times[None, :])
        g = self.model[series.sensor] * rise
        covariance = np.outer(g, g) * np.exp(-gap / self.tau)
        covariance[np.diag_indices_from(covariance)] += self.reading[series.sensor] ** 2 / series.counts
        return np.asarray(cholesky(covariance, lower=True, check_finite=False))


def missed(noise: Noise, blocks: Sequence[Block]) -> list[str]:
    """Sensors that the model misses: by more than 1 % of the rise, and by more than twice the noise of a reading.

    The intervals allow for an error that varies by chance, not for a wrong number of the card such as the spot's size,
    whose error goes the way of the properties.
    """
    return [
        sensor
        for sensor, error in noise.model.items()
        if error > ASTRAY and error * highest_rise(blocks, sensor) > CLEAR * noise.reading[sensor]
    ]


def highest_rise(blocks: Sequence[Block], sensor: str) -> float:
    """Highest computed rise of a sensor in any test, K."""
    return max(float(block.rise.max()) for block in blocks if block.series.sensor == sensor)


@dataclass(frozen=True, eq=False)
class Block(Brief):
    """A series with computed readings, residual (measured - computed), sensitivities (n, parameters) and rise (n,)."""

    series: SensorReadings
    computed: Array
    slopes: Array
    rise: Array

    @property
    def residual(self) -> Array:
        """measured - computed, K."""
        return np.asarray(self.series.readings - self.computed)


@dataclass(frozen=True, eq=False)
class Normal:
    """Normal equations of whitened blocks: J^T J, J^T r, r^T r, ln det C."""

    matrix: Array
    right: Array
    square: float
    log_det: float
    count: int


def normal(blocks: Sequence[Block], noise: Noise) -> Normal:
    """Normal equations of all blocks, whitened."""
    n = blocks[0].slopes.shape[1]
    matrix, right, square, log_det, count = np.zeros((n, n)), np.zeros(n), 0.0, 0.0, 0
    for block in blocks:
        L = noise.factor(block.series, block.rise)
        both = np.column_stack([block.slopes, block.residual])
        white = solve_triangular(L, both, lower=True, check_finite=False)
        J, r = white[:, :-1], white[:, -1]
        matrix += J.T @ J
        right += J.T @ r
        square += float(r @ r)
        log_det += 2 * float(np.log(np.diag(L)).sum())
        count += r.size
    return Normal(matrix, right, square, log_det, count)


def log_evidence(eq: Normal, x: Array, kept: Array | None = None) -> float:
    """ln p(readings) of the problem linearised at x, parameters not `kept` held at 0; priors are N(0, 1).

    With the residual r0 = r + J x at the centre of the prior: -1/2 [n ln 2 pi + ln det C + r0^T r0 + ln det(1 + J^T J)
    - b^T (1 + J^T J)^-1 b], b = J^T r0. Other parameters must be 0 in x, or are set to 0 in the linear problem.
    """
    right = eq.right + eq.matrix @ x
    square = eq.square + 2 * float(x @ eq.right) + float(x @ eq.matrix @ x)
    chosen = np.arange(x.size) if kept is None else kept
    A = np.eye(chosen.size) + eq.matrix[np.ix_(chosen, chosen)]
    L = cholesky(A, lower=True)
    b = right[chosen]
    log_det = 2 * float(np.log(np.diag(L)).sum())
    gain = float(b @ cho_solve((L, True), b))
    return -0.5 * (eq.count * np.log(2 * np.pi) + eq.log_det + square + log_det - gain)


def _thinned(block: Block) -> Block:
    """Average neighbours to about a hundred groups: the model error varies slowly, and a covariance costs n^3."""
    whole = block.series
    size = int(np.ceil(whole.times.size / _GROUPS))
    if size == 1:
        return block
    starts = np.arange(0, whole.times.size, size)
    counts = np.add.reduceat(whole.counts, starts)

    def mean(values: Array) -> Array:
        weights = whole.counts if values.ndim == 1 else whole.counts[:, None]
        total = np.add.reduceat(values * weights, starts)
        return np.asarray(total / (counts if values.ndim == 1 else counts[:, None]))

    series = replace(whole, times=mean(whole.times), readings=mean(whole.readings), counts=counts)
    return Block(series, mean(block.computed), mean(block.slopes), mean(block.rise))


def estimated(blocks: Sequence[Block], x: Array, noise: Noise, floor: float) -> Noise:
    """Model error and correlation time of greatest evidence, with the parameters integrated out.

    By Nelder-Mead in logarithms, between the floor and 10 %, and between 5 s and 1000 s.
    """
    from scipy.optimize import minimize

    thin = [_thinned(block) for block in blocks]
    sensors = list(noise.model)
    low, high = np.log(max(floor, 1e-5)), np.log(LARGEST)

    def of(p: Array) -> Noise:
        errors = np.exp(np.clip(p[:-1], low, high))
        tau = float(np.exp(np.clip(p[-1], np.log(SHORTEST), np.log(LONGEST))))
        return replace(noise, model=dict(zip(sensors, map(float, errors), strict=True)), tau=tau)

    def cost(p: Array) -> float:
        # A weak prior towards the floor and 200 s, for readings that do not determine them.
        pull = 0.05 * float(np.sum(np.maximum(p[:-1] - low, 0.0))) + 0.05 * float(p[-1] - np.log(200.0)) ** 2
        outside = np.concatenate([np.maximum(low - p[:-1], 0), np.maximum(p[:-1] - high, 0)])
        return pull + 10 * float(outside @ outside) - log_evidence(normal(thin, of(p)), x)

    start = np.log(np.append([max(noise.model[s], 1.5 * floor, 1e-5) for s in sensors], noise.tau))
    simplex = np.vstack([start, start + 0.7 * np.eye(start.size)])
    options = {"xatol": 0.05, "fatol": 0.05, "maxfev": 60 * start.size, "initial_simplex": simplex}
    return of(minimize(cost, start, method="Nelder-Mead", options=options).x)
