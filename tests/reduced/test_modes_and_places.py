"""Modes, sample places, and how a decaying mode answers to heat."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tyrefem.reduced.exponential import relaxed, responses
from tyrefem.reduced.pod import modes, sample_nodes

pytestmark = pytest.mark.fast


def test_modes_keep_what_they_are_asked_to_keep() -> None:
    rng = np.random.default_rng(3)
    shapes, weight = rng.standard_normal((5, 300)), rng.random(300) + 0.1
    fields = 20.0 + (rng.standard_normal((40, 5)) * [30.0, 10.0, 3.0, 1.0, 0.3]) @ shapes
    V = modes(fields, weight, 1e-6, 20)
    assert V.shape == (300, 6)
    mean = weight / weight.sum()
    assert np.allclose(V.T @ (mean[:, None] * V), np.eye(6), atol=1e-10)
    assert np.ptp(V[:, 0]) < 1e-12
    assert np.abs(fields - (fields * mean) @ V @ V.T).max() < 1e-5
    coarse = modes(fields, weight, 2.0, 20)
    left = fields - (fields * mean) @ coarse @ coarse.T
    assert coarse.shape[1] < 6
    assert np.sqrt((left**2 @ mean).mean()) <= 2.0


def test_a_few_places_tell_the_whole_field() -> None:
    x = np.linspace(0.0, 1.0, 400)
    fields = np.array([np.exp(-((x - c) ** 2) / 0.5) * (1 + 0.1 * c) for c in np.linspace(0, 1, 30)])
    chosen, everywhere = sample_nodes(fields, 1e-6, 30)
    fresh = np.exp(-((x - 0.4321) ** 2) / 0.5)
    assert len(chosen) < 20
    assert np.abs(everywhere @ fresh[chosen] - fresh).max() < 1e-5


@pytest.mark.parametrize("x", [0.0, 1e-7, 0.3, 1.99, 2.01, 7.0, 60.0])
def test_a_mode_relaxes_as_its_equation_says(x: float) -> None:
    heat, start, theta = np.array([1.0, -2.0, 0.5, 3.0, -1.0, 0.7]), 0.4, np.array([0.0, 0.2, 0.7, 1.0])
    powers = np.arange(6)

    def slope(t: float, y: np.ndarray) -> list[float]:
        return [-x * y[0] + float(heat @ t**powers), y[0]]

    true = solve_ivp(slope, (0, 1), [start, 0.0], "Radau", theta, rtol=1e-11, atol=1e-13).y
    z, whole = relaxed(np.array([x]), np.array([start]), heat[None], theta)
    assert np.allclose(z[0], true[0], atol=1e-8)
    assert np.allclose(whole[0], true[1], atol=1e-8)
    E, answers = responses(np.array([x]), theta, 6)
    assert np.allclose(start * E[0] + heat @ answers[:, 0], z[0], atol=1e-9)
    # What is stored is what came in less what decayed: budgets close by this.
    came = heat @ (1 / (powers + 1))
    assert z[0, -1] - start == pytest.approx(came - x * whole[0, -1], abs=1e-12)


def test_the_sign_of_a_mode_does_not_hang_on_rounding() -> None:
    rng = np.random.default_rng(5)
    weight = rng.uniform(0.5, 2.0, 40)
    fields = rng.standard_normal((6, 4)) @ rng.standard_normal((4, 40))
    V = modes(fields, weight, 1e-6, 20)
    turned = modes(fields[:, ::-1] * (1 + 1e-13), weight[::-1], 1e-6, 20)[::-1]
    assert V.shape[1] > 3
    assert turned == pytest.approx(V, abs=1e-8)
