"""The Gaussian fit against integrals done point by point."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize
from scipy.stats import multivariate_normal, norm

from tyrefem.diagnose.inference.evidence import posterior

pytestmark = pytest.mark.fast

FREE = np.array([-np.inf]), np.array([np.inf])


def _problem(seed: int, k: int, n: int = 12) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(jacobian, data, prior standard deviations)."""
    rng = np.random.default_rng(seed)
    return rng.normal(size=(n, k)), 1.5 * rng.normal(size=n), rng.uniform(0.5, 2.0, size=k)


def _likelihood(J: np.ndarray, d: np.ndarray, x: np.ndarray) -> float:
    """p(d | x) over (2 pi)^(-n/2), times exp(|d|^2/2): what `log_evidence` leaves out."""
    r = d - J @ x
    return float(np.exp(-(r @ r) / 2 + d @ d / 2))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("low", "high"), [(-np.inf, np.inf), (0.0, np.inf), (-0.3, 0.4), (0.0, 9.0)])
def test_evidence_of_one_parameter_with_bounds(seed: int, low: float, high: float) -> None:
    J, d, sd = _problem(seed, 1)
    mass = norm.cdf(high / sd[0]) - norm.cdf(low / sd[0])
    ends = max(low, -12 * sd[0]), min(high, 12 * sd[0])
    wanted, _ = quad(lambda x: _likelihood(J, d, np.array([x])) * norm.pdf(x, scale=sd[0]) / mass, *ends, limit=200)
    fit = posterior(J.T @ J, J.T @ d, sd, np.array([low]), np.array([high]))
    assert fit.log_evidence == pytest.approx(np.log(wanted), abs=1e-6)


def test_evidence_mean_and_covariance_of_two_parameters() -> None:
    J, d, sd = _problem(7, 2)
    fit = posterior(J.T @ J, J.T @ d, sd, *(np.repeat(bound, 2) for bound in FREE))

    axes = [np.linspace(m - 9 * s, m + 9 * s, 501) for m, s in zip(fit.mean, fit.sd, strict=True)]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    r = d - x @ J.T
    density = np.exp(-(r**2).sum(axis=-1) / 2 + d @ d / 2) * norm.pdf(x, scale=sd).prod(axis=-1)
    cell = (axes[0][1] - axes[0][0]) * (axes[1][1] - axes[1][0])
    total = density.sum() * cell
    assert fit.log_evidence == pytest.approx(np.log(total), abs=1e-9)
    mean = (density[..., None] * x).sum(axis=(0, 1)) * cell / total
    np.testing.assert_allclose(fit.mean, mean, rtol=1e-9)
    apart = x - mean
    covariance = np.einsum("ij,ijk,ijl->kl", density, apart, apart) * cell / total
    np.testing.assert_allclose(fit.covariance, covariance, rtol=1e-8)


def test_evidence_is_that_of_the_data_themselves() -> None:
    # d ~ N(0, 1 + J S^2 J^T) when x is integrated out.
    J, d, sd = _problem(3, 5)
    fit = posterior(J.T @ J, J.T @ d, sd, *(np.repeat(bound, 5) for bound in FREE))
    wanted = multivariate_normal(cov=np.eye(len(d)) + (J * sd**2) @ J.T).logpdf(d)
    assert fit.log_evidence - d @ d / 2 - len(d) / 2 * np.log(2 * np.pi) == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_a_fit_within_bounds_is_the_best_there(seed: int) -> None:
    J, d, sd = _problem(seed, 3)
    low, high = np.array([0.0, -0.2, -np.inf]), np.array([np.inf, 0.2, 0.1])
    fit = posterior(J.T @ J, J.T @ d, sd, low, high)

    def misfit(x: np.ndarray) -> float:
        return float(((d - J @ x) ** 2).sum() + ((x / sd) ** 2).sum())

    wanted = minimize(misfit, np.zeros(3), bounds=list(zip(low, high, strict=True)), tol=1e-14)
    assert misfit(fit.mean) == pytest.approx(wanted.fun, rel=1e-6)
    on_bound = np.isclose(fit.mean, low) | np.isclose(fit.mean, high)
    np.testing.assert_array_equal(fit.at_bound, on_bound)


def test_a_needless_parameter_costs_what_occam_says() -> None:
    # Without any pull from the data: -ln(1 + (sd/sigma)^2)/2.
    gram, sd = np.array([[4.0]]), np.array([3.0])
    assert posterior(gram, np.zeros(1), sd, *FREE).log_evidence == pytest.approx(-np.log(1 + 4 * 9) / 2)


@pytest.mark.parametrize("beyond", [0.5, 3.0])
def test_beyond_says_how_far_the_data_want_a_parameter_off_its_bound(beyond: float) -> None:
    J, _, sd = _problem(2, 3)
    free = posterior(J.T @ J, np.zeros(3), sd, *(np.repeat(bound, 3) for bound in FREE))
    # Data whose best place is so many of its standard deviations above the bound 1 of the first parameter.
    wanted = np.array([1.0 + beyond * free.sd[0], 0.3, -0.2])
    overlap = (J.T @ J + np.diag(sd**-2.0)) @ wanted
    high = np.array([1.0, np.inf, np.inf])
    fit = posterior(J.T @ J, overlap, sd, np.full(3, -np.inf), high)
    np.testing.assert_allclose(fit.beyond, [beyond, 0.0, 0.0], rtol=1e-9)


@pytest.mark.parametrize(("low", "high"), [(-np.inf, np.inf), (-0.5, np.inf), (0.0, 0.9), (1.7, 4.0), (-3.0, -1.0)])
@pytest.mark.parametrize("overlap", [8.0, -8.0, 0.0])
def test_one_unknown_is_as_beside_another_that_the_data_do_not_know(low: float, high: float, overlap: float) -> None:
    alone = posterior(np.array([[4.0]]), np.array([overlap]), np.array([0.7]), np.array([low]), np.array([high]))
    wide = np.array([np.inf])
    both = posterior(
        np.diag([4.0, 0.0]),
        np.array([overlap, 0.0]),
        np.array([0.7, 1.3]),
        np.concatenate([[low], -wide]),
        np.concatenate([[high], wide]),
    )
    assert alone.log_evidence == pytest.approx(both.log_evidence, rel=1e-12, abs=1e-12)
    assert alone.mean[0] == pytest.approx(both.mean[0], rel=1e-12, abs=1e-12)
    assert alone.sd[0] == pytest.approx(both.sd[0], rel=1e-12)
    assert alone.at_bound[0] == both.at_bound[0]
    assert alone.beyond[0] == pytest.approx(both.beyond[0], rel=1e-12, abs=1e-12)
