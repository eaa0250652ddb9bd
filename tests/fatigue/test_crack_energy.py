"""Cracking energy density and its critical plane, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tyrefem.fatigue.cracking_energy import CrackingEnergy, products, six
from tyrefem.fatigue.planes import critical_planes, half_sphere
from tyrefem.mechanics.solid.compounds import neo_hookean

pytestmark = pytest.mark.fast

Array = NDArray[np.float64]
G = 1.5e6
RUBBER = neo_hookean(G)


def cycle(stretches: Array, stress: Array, rotation: Array | None = None) -> CrackingEnergy:
    """From rest to principal stretches (times, 3) with principal stresses, and back to rest."""
    turned = np.eye(3) if rotation is None else rotation
    path = [np.concatenate([values, values[-2::-1]]) for values in (stress, np.log(stretches))]
    diagonals = [np.einsum("ij,tj,kj->tik", turned, values, turned) for values in path]
    return CrackingEnergy(six(diagonals[0])[None], six(diagonals[1])[None])


def uniaxial(stretch: float, steps: int = 400) -> tuple[Array, Array]:
    s = np.linspace(1, stretch, steps)
    stress = np.zeros((steps, 3))
    stress[:, 0] = G * (s**2 - 1 / s)
    return np.stack([s, s**-0.5, s**-0.5], axis=1), stress


def energy_of(stretches: Array) -> float:
    return float(RUBBER.energy(np.diag(stretches[-1])))


def searched(energies: CrackingEnergy) -> tuple[Array, float]:
    normals, largest = critical_planes(lambda n: energies.on(products(n)).peak, len(energies.stress))
    return normals[0], float(largest[0])


@pytest.mark.parametrize("stretch", [1.02, 1.3, 2.0])
def test_uniaxial_all_energy_is_available_on_the_plane_normal_to_the_pull(stretch: float) -> None:
    stretches, stress = uniaxial(stretch)
    normal, peak = searched(cycle(stretches, stress))
    assert abs(normal[0]) == pytest.approx(1.0, abs=2e-5)  # 0.4 degrees
    assert peak == pytest.approx(energy_of(stretches), rel=1e-4)


def test_uniaxial_energy_on_an_oblique_plane() -> None:
    # s e n = s de n_x^2 for the only stress s along x.
    stretches, stress = uniaxial(1.2)
    energies = cycle(stretches, stress)
    normals = half_sphere(50)
    expected = energy_of(stretches) * normals[:, 0] ** 2
    np.testing.assert_allclose(energies.on(products(normals)).peak[0], expected, rtol=1e-4)


def test_a_narrow_hill_beside_a_broad_one_is_found() -> None:
    """Growth that falls with R = valley/peak has hills 5 degrees wide: the search took the broad one, with 60 %."""
    rng = np.random.default_rng(7)
    narrow, broad = (v / np.linalg.norm(v, axis=-1, keepdims=True) for v in rng.normal(size=(2, 300, 1, 3)))

    def damage(normals: Array) -> Array:
        near, far = (np.minimum(np.abs((normals * hill).sum(axis=-1)), 1.0) for hill in (narrow, broad))
        return np.asarray(np.maximum(np.exp(-((np.arccos(near) / np.radians(5.0)) ** 2)), 0.6 * far**20))

    _, largest = critical_planes(damage, len(narrow))
    assert largest.min() > 0.99


def test_a_cycle_that_does_not_relax_has_the_energies_of_its_ends() -> None:
    """Pulled to 1.3, then between 1.3 and 1.1: the pull alone opens the plane, and has gained W(1.3) - W(1.1)."""
    s = np.concatenate([np.linspace(1, 1.3, 400), np.linspace(1.3, 1.1, 300)[1:], np.linspace(1.1, 1.3, 300)[1:]])
    stretches, stress = np.stack([s, s**-0.5, s**-0.5], axis=1), np.zeros((len(s), 3, 3))
    stress[:, 0, 0] = G * (s**2 - 1 / s)
    strain = np.eye(3) * np.log(stretches)[:, None]
    energies, weights = CrackingEnergy(six(stress)[None], six(strain)[None], before=399), products(np.eye(3)[:1])
    on = energies.on(weights)
    ends = [energy_of(np.array([[x, x**-0.5, x**-0.5]])) for x in (1.3, 1.1)]
    assert [on.peak[0, 0], on.valley[0, 0]] == pytest.approx(ends, rel=1e-4)
    assert [on.opening[0, 0], on.stretch[0, 0]] == pytest.approx([1.0, 1.3], rel=1e-6)
    # The search over planes sees the same, in single precision.
    for rough, exact in zip(energies.extremes(weights), (on.peak, on.valley, on.stretch), strict=True):
        np.testing.assert_allclose(rough, exact, rtol=1e-4)


def test_uniaxial_compression_leaves_shear_only() -> None:
    # Every plane is closed. n.s.de n - s_nn de_nn = 3/2 s de n_x^2 (1 - n_x^2), greatest at 45 degrees: 3/8 W.
    stretches, stress = uniaxial(0.8)
    normal, peak = searched(cycle(stretches, stress))
    assert abs(normal[0]) == pytest.approx(np.sqrt(0.5), abs=3e-3)
    assert peak == pytest.approx(3 / 8 * energy_of(stretches), rel=1e-4)


def test_equibiaxial_half_of_the_energy_on_any_plane_that_holds_the_thickness() -> None:
    s = np.linspace(1, 1.4, 400)
    stretches = np.stack([s, s, s**-2], axis=1)
    stress = np.zeros((len(s), 3))
    stress[:, 0] = stress[:, 1] = G * (s**2 - s**-4)
    energies = cycle(stretches, stress)
    angles = np.linspace(0, np.pi, 13)
    normals = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)
    np.testing.assert_allclose(energies.on(products(normals)).peak[0], energy_of(stretches) / 2, rtol=1e-4)
    normal, peak = searched(energies)
    assert abs(normal[2]) < 6e-3
    assert peak == pytest.approx(energy_of(stretches) / 2, rel=1e-4)


def simple_shear(amount: float, steps: int = 100) -> CrackingEnergy:
    """Small shear g of the planes y = const along x, s = G g, no pressure, from rest and back."""
    shear = np.concatenate([np.linspace(0, amount, steps), np.linspace(amount, 0, steps)[1:]])
    strain = np.zeros((len(shear), 3, 3))
    strain[:, 0, 1] = strain[:, 1, 0] = shear / 2
    return CrackingEnergy(six(2 * G * strain)[None], six(strain)[None])


def test_simple_shear_opens_planes_at_45_degrees() -> None:
    # n = (c, s, 0): G g^2/4 on every plane that is not closed; the plane normal to the greatest stretch lasts shortest,
    # as only there all of it opens. On the plane at -45 degrees the normal stress presses: nothing is left.
    energies = simple_shear(0.01)
    on = energies.on(
        products(np.array([[1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 0.0, 0.0]]) / [[2**0.5], [2**0.5], [1]])
    )
    np.testing.assert_allclose(on.peak[0], [G * 1e-4 / 4, 0.0, G * 1e-4 / 4], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(on.opening[0, [0, 2]], [1.0, 0.0], atol=1e-9)


@pytest.mark.parametrize("amount", [0.02, 0.1, 0.2])
def test_finite_simple_shear_has_its_critical_plane_at_45_degrees_for_small_shear(amount: float) -> None:
    """Neo-Hookean, thickness free: half of the energy W, on the plane that the greatest stretch opens.

    That direction turns from 45 to 45 - g/4 rad as the shear g grows; what stiffens the pull lifts the energy by g/3.
    """
    shear = np.linspace(0, amount, 200)
    f = np.tile(np.eye(3), (len(shear), 1, 1))
    f[:, 0, 1] = shear
    b = f @ f.swapaxes(1, 2)
    values, vectors = np.linalg.eigh(b)
    strain = (vectors * np.log(values)[:, None] / 2) @ vectors.swapaxes(1, 2)
    stress = G * (b - np.eye(3))
    there_and_back = [np.concatenate([path, path[-2::-1]]) for path in (stress, strain)]
    normal, peak = searched(CrackingEnergy(*(six(path)[None] for path in there_and_back)))
    angle = np.degrees(np.arctan2(abs(normal[1]), abs(normal[0])))
    assert abs(normal[2]) < 6e-3
    assert angle == pytest.approx(45.0, abs=0.5 + np.degrees(0.4 * amount))
    assert peak == pytest.approx(G * amount**2 / 4, rel=0.4 * amount)


def test_the_result_does_not_depend_on_the_axes() -> None:
    generator = np.random.default_rng(1)
    turned = np.linalg.qr(generator.normal(size=(3, 3)))[0]
    stress = generator.normal(size=(20, 3, 3))
    stress = np.concatenate([stress, stress[:1]])
    stress += stress.swapaxes(1, 2)
    strain = 0.05 * generator.normal(size=(21, 3, 3))
    strain[-1] = strain[0]
    strain += strain.swapaxes(1, 2)
    normals = half_sphere(60)
    before = CrackingEnergy(six(stress)[None], six(strain)[None]).on(products(normals))
    rotated = [turned @ values @ turned.T for values in (stress, strain)]
    after = CrackingEnergy(*(six(values)[None] for values in rotated)).on(products(normals @ turned.T))
    for name in ("peak", "valley", "stretch", "opening", "drift"):
        np.testing.assert_allclose(getattr(after, name), getattr(before, name), rtol=1e-9, atol=1e-9)


def test_a_cycle_does_not_depend_on_its_start() -> None:
    """Proportional about a mean: the path leads back, and there is no drift."""
    angle = np.linspace(0, 2 * np.pi, 73)
    size = 0.05 + 0.03 * np.cos(angle)
    strain = np.zeros((len(size), 3, 3))
    strain[:, 0, 0], strain[:, 1, 1], strain[:, 2, 2] = size, -size / 2, -size / 2
    stress = np.zeros_like(strain)
    stress[:, 0, 0] = 3 * G * size
    on = CrackingEnergy(six(stress)[None], six(strain)[None]).on(products(np.eye(3)[:1]))
    assert on.drift[0, 0] < 1e-9 * G
    assert on.peak[0, 0] - on.valley[0, 0] == pytest.approx(0.0, abs=1e-9)  # never above its start, W(0.08)
