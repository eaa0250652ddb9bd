"""Means of strains over patches of the section: exact where the field is linear, settled where it is singular."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import skfem

from tyrefem.mechanics.solid.elements import Rings

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"


@pytest.fixture(scope="module")
def patches() -> Any:
    """The benchmark's class."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(BENCHMARKS)
        from strain_patches import Patches
    return Patches


def square(count: int) -> Rings:
    """``count`` x ``count`` elements of 0.1 m from r = 1 m, z = 0, their inner corners moved."""
    mesh = skfem.MeshQuad.init_tensor(*(start + np.linspace(0, 0.1, count + 1) for start in (1.0, 0.0)))
    x, y = mesh.p[0] - 1.0, mesh.p[1]
    bump = 0.2 * np.sin(np.pi * x / 0.1) * np.sin(np.pi * y / 0.1) / count * 0.1
    return Rings(skfem.MeshQuad(mesh.p + bump, mesh.t))


def test_a_linear_field_has_its_value_at_the_centre_for_any_mesh(patches: Any) -> None:
    for count in (2, 3, 7):
        rings = square(count)
        made = patches(rings, np.arange(count**2), 0.02, np.array([[1.05, 1.03], [0.05, 0.06]]))
        field = 3 * rings.points[0] - 5 * rings.points[1]
        assert made.means(field) == pytest.approx(3 * made.places[0] - 5 * made.places[1], abs=5e-3)


def test_strains_of_several_angles_keep_their_order(patches: Any) -> None:
    rings = square(2)
    made = patches(rings, np.arange(4), 0.02, np.array([[1.05], [0.05]]))
    strain = np.arange(12.0).reshape(3, 1, 1, 1, 4) * np.ones((3, 3, 4, 9, 4))
    means = made.means(strain)
    assert means.shape == (3, 3, 1, 4)
    assert means[:, 0, 0] == pytest.approx(np.arange(12.0).reshape(3, 4))


def test_centres_of_the_grid_have_half_their_disc_in_the_region_and_weights_of_sum_1(patches: Any) -> None:
    made = patches(square(4), np.arange(16), 0.01)
    r, z = made.places
    assert (r.min(), r.max()) == pytest.approx((1.0, 1.1), abs=1.1e-3)
    assert np.hypot(np.minimum(r - 1.0, 1.1 - r), np.minimum(z, 0.1 - z)).min() > 0.004
    assert np.asarray(made.weights.sum(axis=1)).ravel() == pytest.approx(1.0)


def test_a_singular_field_grows_at_points_and_settles_in_a_patch(patches: Any) -> None:
    points, means = [], []
    for count in (4, 8, 16):
        rings = square(count)
        field = np.hypot(rings.points[0] - 1.0, rings.points[1]) ** -0.5
        centre = np.array([[1.0], [0.0]])
        means.append(float(patches(rings, np.arange(count**2), 0.04, centre).means(field)[0]))
        points.append(float(field.max()))
    assert points[1] / points[0] == pytest.approx(2**0.5, rel=0.05)
    assert points[2] / points[1] == pytest.approx(2**0.5, rel=0.05)
    exact = 2 / 1.5 * 0.04**-0.5
    assert means == pytest.approx([exact] * 3, rel=0.03)
    assert abs(means[2] / exact - 1) < 0.01
