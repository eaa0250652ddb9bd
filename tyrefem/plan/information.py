"""Expected information of new data about which set of effects acts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.diagnose.settings import DEFAULT

Array = NDArray[np.float64]
#: A set counts as named with at least this probability.
NAMED = DEFAULT.named_probability
#: Directions of the data with less information than this are left out, nats.
NEGLIGIBLE = 1e-4
#: Seed of the sampled data.
SEED = 0


@dataclass(frozen=True, eq=False)
class Gaussians:
    """Readings to come as each set predicts them: y ~ N(``means[k]``, 1 + ``factors[k]`` ``factors[k]``^T).

    Readings are whitened by their noise and discrepancy. Base numbers, sensors and amplitudes are marginalised.

    Parameters
    ----------
    probabilities : (K,) of the sets. means : (K, d). factors : (K, d, r).
    """

    probabilities: Array
    means: Array
    factors: Array


@dataclass(frozen=True, eq=False)
class Information:
    """What new data are expected to tell.

    Parameters
    ----------
    gain, sd : mutual information of set and data, nats, and the standard deviation of its estimate.
    right : expected probability of the true set after the data. named : share of cases in which the true set then has
        at least 95 %. probabilities : (K,) before the data. after : (K, K, n), ln p(set | data) by set, true set, draw.
    """

    gain: float
    sd: float
    right: float
    named: float
    probabilities: Array
    after: Array

    def between(self, first: int, second: int) -> float:
        """Expected probability of the true one of two sets, if one of the two is true."""
        p, expected = self.probabilities, 0.0
        for true, other in ((first, second), (second, first)):
            odds = self.after[other, true] - self.after[true, true]
            expected += p[true] / (p[first] + p[second]) * float(np.exp(-np.logaddexp(0.0, odds)).mean())
        return expected


def entropy(probabilities: Array) -> float:
    """-sum p ln p, nats: the doubt between sets.

    >>> round(entropy(np.array([0.5, 0.5])), 4)
    0.6931
    """
    p = probabilities[probabilities > 0]
    return float(-(p * np.log(p)).sum())


def information(expected: Gaussians, draws: int, seed: int = SEED) -> Information:
    """Mutual information of set and data, I = sum_k p_k E_k[ln p(k | y) - ln p_k], by sampled data y of every set.

    The probabilities p(k | y) are exact for the Gaussians, so the samples are not nested: the estimate has no bias, and
    ``sd`` is its standard error. Equal seeds draw the same numbers for different experiments.

    Source: Lindley, Annals of Mathematical Statistics 27 (1956) 986-1005.

    >>> two = Gaussians(np.array([0.5, 0.5]), np.array([[0.0], [20.0]]), np.zeros((2, 1, 1)))
    >>> round(information(two, 8).gain, 4)      # data that decide give all of ln 2
    0.6931
    """
    p, means = expected.probabilities, expected.means
    count, d = means.shape
    covariances = np.eye(d) + expected.factors @ np.swapaxes(expected.factors, 1, 2)
    roots = np.linalg.cholesky(covariances) if d else covariances
    inverses = np.linalg.inv(roots) if d else roots
    half = np.log(np.einsum("kii->ki", roots)).sum(axis=1)
    # Directions are drawn one after the other, so that experiments share the numbers of their strongest directions.
    normal = np.random.default_rng(seed).normal(size=(d, count, draws))
    data = means[:, :, None] + roots @ np.moveaxis(normal, 1, 0)
    columns = np.moveaxis(data, 1, 0).reshape(d, count * draws)
    log_p = np.empty((count, count * draws))
    for k in range(count):
        z = inverses[k] @ (columns - means[k][:, None])
        log_p[k] = math.log(max(p[k], 1e-300)) - half[k] - (z**2).sum(axis=0) / 2
    log_p -= np.logaddexp.reduce(log_p, axis=0)
    after = log_p.reshape(count, count, draws)
    of_true = np.array([after[k, k] for k in range(count)])
    rise = of_true - np.log(np.maximum(p, 1e-300))[:, None]
    spread = rise.var(axis=1, ddof=1) if draws > 1 else np.zeros(count)
    return Information(
        gain=float(p @ rise.mean(axis=1)),
        sd=float(np.sqrt((p**2 * spread / draws).sum())),
        right=float(p @ np.exp(of_true).mean(axis=1)),
        named=float(p @ (of_true >= math.log(NAMED)).mean(axis=1)),
        probabilities=p,
        after=after,
    )


def projected(gram: Array, unknowns: int, factors: Sequence[Array], probabilities: Array) -> Gaussians:
    """The readings on the directions in which the sets can differ.

    With the columns A = [J, D] of all readings, J (n, ``unknowns``) slopes and D (n, K) means of the sets, the
    statistic Q^T y with A = Q R holds all information: noise orthogonal to A is the same for every set.

    Parameters
    ----------
    gram : A^T A (m, m). factors : of each set, L with covariance L L^T of the unknowns (``unknowns``, r).
    """
    scale = np.ones(len(gram))
    spread = np.max([np.sqrt((L**2).sum(axis=1)) for L in factors], axis=0)
    scale[:unknowns] = spread
    value, vector = np.linalg.eigh(gram * scale[:, None] * scale[None, :])
    kept = np.flatnonzero(value > NEGLIGIBLE)[::-1]
    # An eigenvector has either sign: with the same one, rounding errors do not mirror what is drawn.
    largest = np.take_along_axis(vector, np.abs(vector).argmax(axis=0)[None, :], axis=0)
    vector = vector * np.where(largest < 0, -1.0, 1.0)
    R = np.sqrt(value[kept])[:, None] * vector[:, kept].T
    R_unknowns = np.divide(R[:, :unknowns], spread, out=np.zeros((len(kept), unknowns)), where=spread > 0)
    ranks = max(L.shape[1] for L in factors)
    padded = np.stack([np.pad(R_unknowns @ L, ((0, 0), (0, ranks - L.shape[1]))) for L in factors])
    return Gaussians(probabilities, np.ascontiguousarray(R[:, unknowns:].T), padded)
