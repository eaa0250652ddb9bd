"""The harmonics against the same tyre in three dimensions."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.footprint.reference_3d import Hexahedra, angles_near_contact
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics


@pytest.mark.parametrize("n", [1, 2, 3])
def test_energy_of_a_harmonic_field_is_the_same(n: int) -> None:
    """u K u of hexahedra, t from 0 to pi, is pi/2 u K_n u: strains, pre-stress and following pressure alike."""
    state = PlainTyre().state(along=3)
    flat, solid = Harmonics(state), Hexahedra(state, np.linspace(0, np.pi, 13 * n))
    r, z, t = np.asarray(solid.basis.doflocs)
    nodes = flat.elements.nodes
    same = np.argmin((r[:, None] - nodes[0]) ** 2 + (z[:, None] - nodes[1]) ** 2, axis=1)
    u = np.random.default_rng(n).normal(size=(nodes.shape[1], 3))
    u.reshape(-1)[flat.held] = 0.0
    waves = np.stack([np.cos(n * t), np.cos(n * t), np.sin(n * t)], axis=1)
    full = (u[same] * waves).ravel()
    energy = np.pi / 2 * u.ravel() @ flat.stiffness(n) @ u.ravel()
    assert full @ solid.stiffness @ full == pytest.approx(energy, rel=2e-4)


def test_load_footprint_and_strains_agree_with_hexahedra() -> None:
    state = PlainTyre().state(along=6)
    solid = Hexahedra(state, angles_near_contact(0.35, 7, 5))
    pressed = solid.at_deflection(0.02)
    footprint = Pressing(state).at_deflection(0.02, 80)
    assert footprint.load == pytest.approx(pressed.load, rel=0.003)
    ends = pressed.angles[pressed.forces > 0].max(), footprint.grid.angles[footprint.pressure.max(axis=1) > 0].max()
    assert ends[1] == pytest.approx(ends[0], abs=0.35 / 14 + np.pi / 80)
    cycle = StrainHarmonics(footprint)
    places, strains = solid.strain(pressed.displacement)
    # Ten points of the section and of the wheel, chosen without looking.
    rng = np.random.default_rng(0)
    elements, points = rng.integers(strains.shape[1] // 2, size=10), rng.integers(27, size=10)
    theirs = strains[:, elements, points].T
    ours = np.array(
        [cycle.at(*places[:2, e, q], places[2, [e], q])[:, 0] for e, q in zip(elements, points, strict=True)]
    )
    assert np.abs(theirs).max() > 0.02
    assert np.abs(ours - theirs).max() < 0.06 * np.abs(theirs).max()
    assert np.linalg.norm(ours - theirs) < 0.04 * np.linalg.norm(theirs)
