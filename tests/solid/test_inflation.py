"""The shipped bias tyres, inflated."""

from __future__ import annotations

import functools

import numpy as np
import pytest
import skfem

from tyrefem import study
from tyrefem.errors import InputError
from tyrefem.geometry.meshing import build
from tyrefem.mechanics.solid.compounds import determinant
from tyrefem.mechanics.solid.inflation import Inflation, inflate


@functools.cache
def inflated(size: float = 8e-3, pressure: float = 5e5) -> Inflation:
    tyre = study("nasa-22x5.5-8pr")
    return inflate(tyre, pressure, build(tyre.section, size=size, through=1))


def test_crown_carries_the_pressure_down_to_the_widest_place() -> None:
    """r N_phi at the crown is p (r_c^2 - r_w^2)/2: at the widest place r_w of the wall N_phi is radial (Clark & Dodge
    1980, appendix F); radii of the middle of the wall, whose bending leaves some per cent."""
    tyre = inflated()
    inner = tyre.body.residual(tyre.displacement, 0.0).reshape(-1, 2)[:, 1]
    cut = tyre.body.rings.boundary_nodes("symmetry")
    wall = tyre.places[:, np.unique(tyre.body.wall.nodes)]
    crown, widest = wall[0].max(), wall[0, wall[1].argmax()]
    assert abs(inner[cut].sum()) == pytest.approx(tyre.pressure * (crown**2 - widest**2) / 2, rel=0.1)


def test_cords_carry_the_pressure() -> None:
    """N_phi + N_theta = v_c E (lambda - 1) h lies between those of tubes of 40 and 260 mm radius."""
    tension = inflated().cord_tensions["carcass"]
    low, mean, high = tension.stress
    assert tension.tension is None
    assert 0 < low < mean < high
    assert 5e5 * 0.04 < mean * 5.08e-3 < 5e5 * 0.26


def test_growth_rises_with_pressure_and_hardly_with_the_mesh() -> None:
    small, large = inflated(pressure=2.5e5), inflated()
    assert 0 < small.radius_growth < large.radius_growth < 2.5 * small.radius_growth
    fine = inflated(size=4e-3)
    assert fine.radius_growth == pytest.approx(large.radius_growth, rel=0.01)
    assert fine.width_growth == pytest.approx(large.width_growth, rel=0.05)


def test_state_is_in_balance_in_its_own_place() -> None:
    """Cauchy stress on the inflated mesh balances the pressure there: virtual work of a uniform hoop motion."""
    tyre = inflated()
    basis = skfem.Basis(tyre.mesh, skfem.ElementQuad2(), intorder=5)
    points, weights = np.asarray(basis.global_coordinates()), np.asarray(basis.dx)
    here = (weights * points[0]).sum()
    assert here == pytest.approx(float((determinant(tyre.deformation) * tyre.body.rings.weights).sum()), rel=1e-6)
    stress = tyre.state.stress
    # v = (r, z): int sigma : grad v r dA = int sigma : 1 r dA = v . (inner forces).
    trace = float((stress[:3].sum(axis=0) * weights * points[0]).sum())
    inner = tyre.body.residual(tyre.displacement, 0.0).reshape(-1, 2)
    for flange in tyre.body.flanges:
        inner = inner + flange.force(tyre.places).reshape(-1, 2)
    assert trace == pytest.approx(float((inner * tyre.places.T).sum()), rel=1e-6)


def test_full_section_grows_like_the_half() -> None:
    full = study("nasa-22x5.5-8pr", {"mesh.section": "full", "mesh.size": "8 mm"})
    mesh = build(full.section, size=8e-3, through=1)
    whole = inflate(full, 5e5, mesh)
    assert whole.radius_growth == pytest.approx(inflated().radius_growth, rel=1e-4)
    assert whole.width_growth == pytest.approx(inflated().width_growth, rel=1e-3)
    assert whole.bead_tension == pytest.approx(inflated().bead_tension, rel=1e-3)


def test_bead_carries_hoop_tension() -> None:
    """At most N_phi sin(beta) R_R (Clark & Dodge 1980, B1), N_phi at most p times 80 mm; the seat takes the rest."""
    assert 0 < inflated().bead_tension < 5e5 * 0.08 * 0.17


def test_triangles_and_vacuum_are_refused() -> None:
    tyre = study("nasa-22x5.5-8pr")
    with pytest.raises(InputError, match="quadrilaterals"):
        inflate(tyre, 1e5, build(tyre.section, size=8e-3, cell="tri"))
    with pytest.raises(InputError, match="0 Pa or more"):
        inflate(tyre, -1e5)
