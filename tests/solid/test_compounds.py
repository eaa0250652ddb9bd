"""Compounds and cords: energy, stress and tangent belong together; limits are the textbook's."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem.errors import InputError
from tyrefem.mechanics.solid.compounds import Compound, mooney_rivlin, neo_hookean, yeoh
from tyrefem.mechanics.solid.cords import CordLayer, lifted_angle, lifted_ends
from tyrefem.mechanics.solid.six_components import SYMMETRIC_UNIT, UNIT

pytestmark = pytest.mark.fast

LAWS = {"neo-hookean": neo_hookean(1e6), "mooney-rivlin": mooney_rivlin(3e5, 2e5), "yeoh": yeoh(5e5, -5e4, 2e4)}
RANDOM = np.random.default_rng(3)
GRADIENT = np.eye(3)[..., None] + 0.3 * RANDOM.uniform(-1, 1, (3, 3, 5))
PLY = CordLayer(np.full(5, 0.6), np.array([[0.8], [0.6]]) * np.ones(5), np.full(5, 1e9), 0.1, 1e4)


def stirred(direction: int, size: float) -> np.ndarray:
    """1 + size e, e the symmetric tensor of one engineering strain."""
    strain = np.zeros((3, 3))
    i, j = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)][direction]
    strain[i, j] += 0.5
    strain[j, i] += 0.5
    return np.eye(3) + size * strain


@pytest.mark.parametrize("material", [*LAWS.values(), PLY], ids=[*LAWS, "cords"])
def test_stress_is_the_slope_of_the_energy(material: Compound) -> None:
    h = 1e-6
    for k in range(6):
        up, down = (np.einsum("ij,jk...->ik...", stirred(k, s * h), GRADIENT) for s in (1, -1))
        slope = (material.energy(up) - material.energy(down)) / (2 * h)
        np.testing.assert_allclose(slope, material.stress(GRADIENT)[k], rtol=1e-5, atol=1.0)


@pytest.mark.parametrize("material", [*LAWS.values(), PLY], ids=[*LAWS, "cords"])
def test_tangent_is_the_stretching_rate_of_the_stress(material: Compound) -> None:
    """tau(exp(h e) F) = tau + h (c : e + e tau + tau e) to first order: the Truesdell rate."""
    h, at = 1e-6, [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
    tau = material.stress(GRADIENT)
    full = np.zeros((3, 3, 5))
    for k, (i, j) in enumerate(at):
        full[i, j] = full[j, i] = tau[k]
    for k in range(6):
        e = (stirred(k, 1.0) - np.eye(3))[..., None]
        up, down = (np.einsum("ij,jk...->ik...", stirred(k, s * h), GRADIENT) for s in (1, -1))
        rate = (material.stress(up) - material.stress(down)) / (2 * h)
        turned = np.einsum("ij...,jk...->ik...", e, full) + np.einsum("ij...,jk...->ik...", full, e)
        expected = rate - np.array([turned[i, j] for i, j in at])
        scale = np.abs(material.tangent(GRADIENT)).max()
        np.testing.assert_allclose(material.tangent(GRADIENT)[:, k], expected, atol=1e-6 * scale)


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_small_strains_see_the_shear_modulus(law: Compound) -> None:
    deviator = SYMMETRIC_UNIT - np.outer(UNIT, UNIT) / 3
    np.testing.assert_allclose(law.tangent(np.eye(3)), 2 * law.shear_modulus * deviator, atol=1e-6)
    assert np.abs(law.stress(np.eye(3))).max() < 1e-9


def test_simple_extension_follows_mooney_and_rivlin() -> None:
    """sigma = 2 (x^2 - 1/x) (c10 + c01/x) of an incompressible strip (Mooney 1940)."""
    law, x = mooney_rivlin(3e5, 2e5), 1.7
    stress = law.stress(np.diag([x, x**-0.5, x**-0.5]))
    assert stress[0] - stress[1] == pytest.approx(2 * (x**2 - 1 / x) * (3e5 + 2e5 / x))


def test_weak_cords_in_compression() -> None:
    layer = CordLayer(np.array(0.0), np.array([0.0, 1.0]), np.array(1e9), 0.1, 1e4)
    assert layer.tension(np.diag([1, 1, 1.01])) == pytest.approx(100)
    assert layer.tension(np.diag([1, 1, 0.99])) == pytest.approx(-10)


def test_a_pair_of_plies_does_not_couple_stretch_with_twist() -> None:
    f = np.diag([1.02, 0.97, 1.05])
    assert np.abs(PLY.tangent(f[..., None] * np.ones(5))[:4, 4:]).max() < 1e-6 * 1e9


def test_lift_law_keeps_the_number_of_cords() -> None:
    radii = np.linspace(0.18, 0.26, 5)
    angle = lifted_angle(np.radians(35), 0.26, radii)
    np.testing.assert_allclose(np.cos(angle) / radii, np.cos(np.radians(35)) / 0.26)
    count = radii * lifted_ends(np.radians(35), 0.26, radii) * np.sin(angle)
    np.testing.assert_allclose(count, count[-1])
    with pytest.raises(InputError, match=r"no cord angle at r = 330 mm"):
        lifted_angle(np.radians(35), 0.26, np.array([0.2, 0.33]))


def test_a_soft_law_is_refused() -> None:
    with pytest.raises(InputError, match="shear modulus"):
        mooney_rivlin(1e5, -2e5)
