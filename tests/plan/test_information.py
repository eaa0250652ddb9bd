"""Expected information between Gaussian sets: closed forms, quadrature, and what cannot tell anything."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tyrefem.plan.information import Gaussians, entropy, information, projected

pytestmark = pytest.mark.fast
HALF = np.array([0.5, 0.5])


def shifted(distance: float, probabilities: np.ndarray = HALF) -> Gaussians:
    """Two sets of unit variance whose means are ``distance`` apart."""
    return Gaussians(probabilities, np.array([[0.0], [distance]]), np.zeros((2, 1, 1)))


def exact(distance: float) -> float:
    """ln 2 - E[ln(1 + exp(-distance^2/2 - distance z))], z ~ N(0, 1), by Gauss-Hermite quadrature."""
    z, weight = np.polynomial.hermite_e.hermegauss(80)
    return math.log(2.0) - float(weight @ np.logaddexp(0.0, -(distance**2) / 2 - distance * z)) / math.sqrt(2 * math.pi)


@pytest.mark.parametrize("distance", [0.3, 1.0, 2.5, 5.0])
def test_two_linear_models_have_the_gain_of_quadrature(distance: float) -> None:
    result = information(shifted(distance), 40_000)
    assert result.gain == pytest.approx(exact(distance), abs=4 * result.sd)
    assert result.sd < 0.005


def test_close_models_have_the_gain_of_the_closed_form() -> None:
    # To second order I = p (1 - p) D^2 / 2, here D^2 / 8.
    result = information(shifted(0.2), 400_000)
    assert result.gain == pytest.approx(0.2**2 / 8, abs=4 * result.sd)


def test_ln_odds_rise_by_half_the_squared_distance() -> None:
    result = information(shifted(1.5, np.array([0.8, 0.2])), 40_000)
    odds = (result.after[0, 0] - result.after[1, 0]).mean() - math.log(4.0)
    assert odds == pytest.approx(1.5**2 / 2, abs=0.03)


def test_common_unknowns_are_marginalised() -> None:
    # d = b u + (0 or c) + e with u ~ N(0, 2^2): the distance is c^T (1 + 4 b b^T)^-1 c.
    b, c = np.array([1.0, 0.5, -0.3]), np.array([1.0, 1.0, 0.0])
    A = np.column_stack([b, np.zeros(3), c])
    expected = projected(A.T @ A, 1, [np.array([[2.0]])] * 2, HALF)
    distance = math.sqrt(c @ np.linalg.solve(np.eye(3) + 4 * np.outer(b, b), c))
    result = information(expected, 40_000)
    assert result.gain == pytest.approx(exact(distance), abs=4 * result.sd)


def test_a_set_of_larger_variance_is_told_by_the_spread_of_its_data() -> None:
    wide = 4.0
    y = np.linspace(-40.0, 40.0, 200_001)
    densities = [np.exp(-(y**2) / 2 / v) / np.sqrt(2 * np.pi * v) for v in (1.0, 1.0 + wide**2)]
    mixture = sum(densities) / 2
    step = y[1] - y[0]
    quadrature = sum(float((p * np.log(np.maximum(p, 1e-300) / mixture)).sum()) * step for p in densities) / 2
    expected = Gaussians(HALF, np.zeros((2, 1)), np.array([[[0.0]], [[wide]]]))
    result = information(expected, 40_000)
    assert result.gain == pytest.approx(quadrature, abs=4 * result.sd)


def test_readings_that_nothing_changes_gain_nothing() -> None:
    expected = projected(np.zeros((3, 3)), 1, [np.array([[1.0]])] * 2, np.array([0.7, 0.3]))
    result = information(expected, 100)
    assert (result.gain, result.sd) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert result.right == pytest.approx(0.7**2 + 0.3**2)
    assert result.named == 0.0


def test_the_gain_is_at_most_the_doubt() -> None:
    probabilities = np.array([0.6, 0.3, 0.1])
    apart = Gaussians(probabilities, np.array([[0.0], [30.0], [-30.0]]), np.zeros((3, 1, 1)))
    result = information(apart, 50)
    assert result.gain == pytest.approx(entropy(probabilities))
    assert (result.right, result.named) == pytest.approx((1.0, 1.0))
    assert result.between(0, 2) == pytest.approx(1.0)


def test_the_probability_between_two_sets_leaves_the_others_out() -> None:
    three = Gaussians(np.array([0.25, 0.25, 0.5]), np.array([[0.0], [1.0], [50.0]]), np.zeros((3, 1, 1)))
    of_two = information(shifted(1.0), 40_000)
    assert information(three, 40_000).between(0, 1) == pytest.approx(of_two.right, abs=0.01)
