"""Evidence of laws of missing heat: exact in the amplitude, by Laplace's approximation in the exponents."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from tyrefem.brief import Brief
from tyrefem.diagnose.heat.evidence import ProjectedData
from tyrefem.diagnose.heat.sources import SIZES
from tyrefem.diagnose.law.terms import NO_SWITCH, LawTerms, Switch

Array = NDArray[np.float64]
#: Largest exponent times logarithm: a law over the runs varies by no more than exp(2 x this).
STEEPEST = 12.0
#: Step of a difference of gradients, prior sd.
STEP = 1e-4


@dataclass(frozen=True, eq=False)
class LawData(Brief):
    """What the readings say of the strength q (m,) of a source at the knots of all fitted runs.

    With q = A u and A ~ N(0, s^2) the gain of ln evidence is s^2 o^2 / (2 (1 + s^2 g)) - ln(1 + s^2 g)/2, with
    g = u^T gram u and o = u^T overlap; sizes s of `SIZES` times ``sd`` are equally probable.

    Parameters
    ----------
    gram : (m, m). overlap : (m,). sd : of the amplitude, W/m3, W/m2 or 1. hats : (m, n) means over fine times.
    base : ln evidence of the data with the sources beside this one, and none here.
    """

    gram: Array
    overlap: Array
    sd: float
    hats: Array
    base: float = 0.0

    def over(self, inflation: float) -> LawData:
        """The same readings with this many times their variance."""
        return replace(self, gram=self.gram / inflation, overlap=self.overlap / inflation)

    def statistics(self, strength: Array) -> tuple[float, float]:
        """g and o of a strength (n,) at fine times."""
        u = self.hats @ strength
        return float(u @ self.gram @ u), float(u @ self.overlap)

    def gain(self, strength: Array) -> float:
        """ln p(data | this strength, of unknown amplitude) - ln p(data | no source here)."""
        return _gain(*self.statistics(strength), self.sizes)[0]

    def gains(self, strengths: Array) -> Array:
        """`gain` of many strengths (k, n)."""
        u = strengths @ self.hats.T
        g, o = np.einsum("ki,ij,kj->k", u, self.gram, u), u @ self.overlap
        return np.array([_gain(float(a), float(b), self.sizes)[0] for a, b in zip(g, o, strict=True)])

    @cached_property
    def sizes(self) -> Array:
        """Prior standard deviations of the amplitude, equally probable."""
        return np.asarray(self.sd * np.array(SIZES))

    def amplitude(self, strength: Array) -> tuple[float, float]:
        """Mean and standard deviation of the amplitude of a given strength."""
        g, o = self.statistics(strength)
        weights = _gain(g, o, self.sizes)[3]
        means, variances = self.sizes**2 * o / (1 + self.sizes**2 * g), self.sizes**2 / (1 + self.sizes**2 * g)
        mean = float(weights @ means)
        return mean, float(np.sqrt(weights @ (variances + (means - mean) ** 2)))


def law_data(data: ProjectedData, columns: Array, sd: float, hats: Array) -> LawData:
    """The statistics of one place; ``columns`` (n_data, m): responses to unit strength at every knot."""
    statistics = data.with_sources(columns)
    return LawData(statistics.gram, statistics.overlap, sd, hats, data.log_evidence)


def _gain(g: float, o: float, sizes: Array) -> tuple[float, float, float, Array]:
    """ln of the mean over sizes of the evidence gain, its derivatives by g and o, and the sizes' weights."""
    s2 = sizes**2
    whole = 1 + s2 * g
    each = s2 * o**2 / (2 * whole) - np.log(whole) / 2
    top = float(each.max())
    weights = np.exp(each - top)
    value = top + float(np.log(weights.mean()))
    weights = weights / weights.sum()
    by_g = float(weights @ (-(s2**2) * o**2 / (2 * whole**2) - s2 / (2 * whole)))
    return value, by_g, float(weights @ (s2 * o / whole)), weights


@dataclass(frozen=True, eq=False)
class LawFit(Brief):
    """A law of given terms and switch, fitted.

    Parameters
    ----------
    terms : names of its terms. switch : when it acts. mean, covariance : (k,), (k, k) of their exponents.
    log_evidence : gain of ln evidence over no source here, averaged over the exponents' prior.
    """

    terms: tuple[str, ...]
    switch: Switch
    mean: Array
    covariance: Array
    log_evidence: float

    @property
    def sd(self) -> Array:
        """Standard deviations of the exponents."""
        return np.sqrt(np.diag(self.covariance))

    def strength(self, features: dict[str, Array], exponents: Array | None = None) -> Array:
        """(n,) the law at fine times for unit amplitude."""
        return law_strength([features[name] for name in self.terms], self.mean if exponents is None else exponents,
                            self.switch)  # fmt: skip


def law_strength(features: Sequence[Array], exponents: Array, switch: Switch) -> Array:
    """exp(sum of exponent x feature) x switch, (n,)."""
    total = np.zeros(len(switch.on))
    for feature, exponent in zip(features, exponents, strict=True):
        total = total + exponent * feature
    return np.asarray(np.exp(np.clip(total, -STEEPEST, STEEPEST)) * switch.on)


def fitted_law(
    data: LawData, terms: LawTerms, names: Sequence[str], switch: Switch, start: Array | None = None
) -> LawFit:
    """The best exponents of a law with some of the terms, their covariance and its evidence.

    Maximises L(z) = gain(exponents = mean + sd z) - |z|^2/2; ln evidence = L - ln det(-L'')/2 (Laplace; the amplitude
    is integrated exactly). ``start``: exponents at which the search also begins.
    """
    middle, scale = (np.array([terms.prior(name)[which] for name in names]) for which in (0, 1))
    if not len(names):
        return LawFit((), switch, np.zeros(0), np.zeros((0, 0)), data.gain(switch.on))
    features = np.array([terms.features[name] for name in names])

    def slope(z: Array) -> tuple[float, Array]:
        strength = law_strength(list(features), middle + scale * z, switch)
        u = data.hats @ strength
        by_z = data.hats @ (strength * features * scale[:, None]).T
        turned = data.gram @ u
        value, by_g, by_o, _ = _gain(float(u @ turned), float(u @ data.overlap), data.sizes)
        gradient = 2 * by_g * (turned @ by_z) + by_o * (data.overlap @ by_z)
        return -value + float(z @ z) / 2, -gradient + z

    begins = [np.zeros(len(names)), *(1.5 * sign * row for row in np.eye(len(names)) for sign in (1, -1))]
    begins += [] if start is None else [(np.asarray(start) - middle) / scale]
    ranked = sorted(begins, key=lambda z: slope(z)[0])
    tried = [minimize(slope, z, jac=True, method="BFGS", options={"gtol": 1e-4}) for z in ranked[:2]]
    best = min(tried, key=lambda result: float(result.fun))
    z = np.asarray(best.x)
    hessian = np.array([(slope(z + STEP * row)[1] - slope(z - STEP * row)[1]) / (2 * STEP) for row in np.eye(len(z))])
    values, vectors = np.linalg.eigh((hessian + hessian.T) / 2)
    values = np.maximum(values, 1e-3)
    covariance = (vectors / values) @ vectors.T * np.outer(scale, scale)
    return LawFit(tuple(names), switch, middle + scale * z, covariance, float(-best.fun - np.log(values).sum() / 2))


def plain_switch(count: int) -> Switch:
    """A law that always acts, at ``count`` fine times."""
    return Switch(NO_SWITCH, np.ones(count))
