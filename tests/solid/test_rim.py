"""The bead on its rim: contact laws, and the tyre that once folded where a held seat ended."""

from __future__ import annotations

import functools
from itertools import pairwise

import numpy as np
import pytest
import skfem
from scipy.optimize import brentq

from tyrefem import study
from tyrefem.geometry.meshing import build
from tyrefem.mechanics.footprint.compliance import TreadCompliance
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.solid.body import Body
from tyrefem.mechanics.solid.compounds import determinant, neo_hookean
from tyrefem.mechanics.solid.elements import Rings
from tyrefem.mechanics.solid.inflation import Inflation, inflate
from tyrefem.mechanics.solid.newton import NewtonChoice, equilibrium
from tyrefem.mechanics.solid.parts import RegionMaterial
from tyrefem.mechanics.solid.rim import FLANGE, SEAT, Flange, on_rim

END = 1e-9


def resting(stiffness: float = 1e9) -> Body:
    """A block, pressed by inner pressure at z = 0 against a ring beyond z = 0.1 that it does not touch before."""
    mesh = skfem.MeshQuad.init_tensor(np.linspace(1, 1.3, 7), np.linspace(0, 0.1, 3))
    mesh = mesh.with_boundaries(
        {
            "contained_air": lambda x: x[1] < END,
            FLANGE: lambda x: x[1] > 0.1 - END,
            "ends": lambda x: (x[0] < 1 + END) | (x[0] > 1.3 - END),
        }
    ).with_subdomains({"rubber": np.arange(mesh.t.shape[1])})
    flange = Flange(Rings(mesh), (1.12, 0.1 + 0.1 + 2e-3), 0.1, stiffness=stiffness)
    return Body(mesh, {"rubber": RegionMaterial(neo_hookean(1e6))}, {"ends": "rz"}, flanges=(flange,))


@functools.cache
def pressed(stiffness: float = 1e9) -> tuple[Body, np.ndarray]:
    body = resting(stiffness)
    return body, equilibrium(body, 4e5).displacement


def test_flange_pushes_only_where_it_is_touched() -> None:
    """Pressure >= 0, depth = pressure over stiffness, never pressure across an open gap; and the block does touch."""
    body, moved = pressed()
    places, flange = body.rings.nodes + moved, body.flanges[0]
    gap, pressure = flange.gap(places), flange.pressure(places)
    assert (pressure >= 0).all()
    assert (pressure[gap > 0] == 0).all()
    np.testing.assert_allclose(gap[gap < 0], -pressure[gap < 0] / 1e9, rtol=1e-9)
    assert 0.05 < (gap < 0).mean() < 0.8


def test_depth_falls_as_the_flange_stiffens() -> None:
    """The stiffer, the less deep, and the less change of the displacement."""
    solutions = [pressed(stiffness) for stiffness in (1e9, 1e10, 1e11)]
    depths = [-body.flanges[0].gap(body.rings.nodes + moved).min() for body, moved in solutions]
    assert depths[2] < depths[1] / 3 < depths[0] / 9
    (_, soft), (_, middle), (_, hard) = solutions
    assert np.abs(hard - middle).max() < np.abs(middle - soft).max() / 3


def test_forces_of_pressure_flange_and_ends_balance() -> None:
    body, moved = pressed()
    places, inner = body.rings.nodes + moved, body.residual(moved, 4e5).reshape(-1, 2)
    held = np.unique(body.rings.boundary_nodes("ends"))
    flange = body.flanges[0].force(places).reshape(-1, 2)[:, 1].sum()
    air = 4e5 * body.load(moved).reshape(-1, 2)[:, 1].sum()
    assert flange < 0
    assert flange + air + inner[held, 1].sum() == pytest.approx(0, abs=1e-7 * air)


def test_stiffness_is_the_slope_of_the_forces_and_forces_of_the_energy() -> None:
    body, moved = pressed()
    direction, h = 1e-3 * np.random.default_rng(5).standard_normal(moved.shape), 1e-5
    up, down = moved + h * direction, moved - h * direction
    slope = (body.residual(up, 4e5) - body.residual(down, 4e5)) / (2 * h)
    expected = body.stiffness(moved, 4e5) @ direction.T.ravel()
    np.testing.assert_allclose(slope, expected, atol=1e-5 * np.abs(expected).max())
    change = (body.energy(up) - body.energy(down)) / (2 * h)
    assert change == pytest.approx(body.residual(moved, 0.0) @ direction.T.ravel(), rel=1e-5)


def test_a_motion_round_the_wheel_leaves_the_ring_with_its_curvature() -> None:
    """Energy of u_t in the pressed state is half of the pressure times the change of gap in three dimensions."""
    body, moved = pressed()
    flange, places = body.flanges[0], body.rings.nodes + moved
    matrix, h = flange.stiffness_matrix(places, 3), 1e-4
    u = np.zeros(3 * body.rings.n_nodes)
    u[2::3] = 1.0
    # All nodes h aside: the radius grows to sqrt(r^2 + h^2).
    aside = np.array([np.hypot(places[0], h), places[1]])
    assert u @ matrix @ u == pytest.approx(2 * (flange.energy(aside) - flange.energy(places)) / h**2, rel=1e-4)


def test_newton_converges_quadratically_on_the_flange() -> None:
    history = equilibrium(resting(), 4e5, NewtonChoice(first_step=1.0, tolerance=1e-11)).residuals[-1]
    before, after = next((a, b) for a, b in pairwise(history) if b < 1e-5)
    assert after < 10 * before**1.8


def test_a_levelled_cord_follows_its_law() -> None:
    """W' = C x/(1 - C x/Y): half of Y where C |x| = Y, all of it for large strains."""
    from tyrefem.mechanics.solid.cords import CordLayer

    layer = CordLayer(np.array(0.0), np.array([0.0, 1.0]), np.array(1e9), 0.1, 1e4, limit=1e6)
    assert layer.stress_in_layer(np.diag([1, 1, 0.99])) == pytest.approx(-5e5)
    assert layer.stress_in_layer(np.diag([1, 1, 0.5])) == pytest.approx(-1e6, rel=0.03)
    assert layer.tension(np.diag([1, 1, 0.99])) == pytest.approx(-5.0)
    crush = brentq(lambda x: float(layer.stress_in_layer(np.diag([1, 1, x]))) + 9e5, 0.5, 1.0)
    assert crush == pytest.approx(1 - 0.09)


@pytest.mark.parametrize("half", [True, False])
def test_flange_touches_the_undeformed_face(half: bool) -> None:
    tyre = study("passenger-205-55r16", {} if half else {"mesh.section": "full"})
    mesh = build(tyre.section, size=10e-3, through=1).mesh
    named, flanges = on_rim(mesh, 9e-3)
    assert len(flanges) == (1 if half else 2)
    rim, seat = (set(named.boundaries[name].tolist()) for name in ("rim", SEAT))
    assert seat < rim
    assert rim - seat < set(named.boundaries[FLANGE].tolist())
    for flange in flanges:
        assert 0 <= np.abs(flange.gap(flange.rings.nodes)).min() < 1e-4
        assert flange.gap(flange.rings.nodes).min() > -2e-5


@functools.cache
def truck() -> Inflation:
    tyre = study("truck-295-80r22.5")
    choice = NewtonChoice(first_step=1.0, iterations=40, line_search=6)
    return inflate(tyre, None, build(tyre.section, size=28e-3, through=1), choice)


def test_truck_tyre_inflates_without_folding() -> None:
    tyre = truck()
    # Least where the ply turns round the bundle's corner: 0.46 at one point of a coarse element.
    assert determinant(tyre.deformation).min() > 0.4
    assert len(tyre.equilibrium.steps) <= 4
    (flange,) = tyre.body.flanges
    assert flange.pressure(tyre.places).max() > 0
    assert -flange.gap(tyre.places).min() < 1e-4


def test_no_harmonic_of_the_truck_tyre_is_unstable() -> None:
    """Compressed cords that carried more than their rubber's shear modulus would buckle in every harmonic."""
    harmonics = Harmonics(truck().state)
    dofs = TreadCompliance(harmonics).dofs.ravel()
    for n in (0, 1, 2, 6, 24, 60):
        harmonics.compliance(n, dofs)
    assert set(harmonics.negative_pivots.values()) == {0}


def test_a_rim_between_air_on_both_sides_has_its_flange() -> None:
    """The toe in the air, too: the flange stands at the heel, where it stands without a bare toe."""
    tyre = study("passenger-205-55r16")
    mesh = build(tyre.section, size=6e-3, through=1).mesh
    rim = np.asarray(mesh.boundaries["rim"])
    # The facets of the seat whose middles are nearest to the mid plane become outside air.
    toe = rim[np.argsort(mesh.p[1, mesh.facets[:, rim]].mean(axis=0))[:1]]
    air = np.concatenate([mesh.boundaries["outside_air"], toe])
    bare = mesh.with_boundaries({"rim": np.setdiff1d(rim, toe), "outside_air": np.sort(air)})
    (flange,), (usual,) = on_rim(bare, 9e-3)[1], on_rim(mesh, 9e-3)[1]
    assert flange.centre == pytest.approx(usual.centre)
    assert flange.radius == pytest.approx(usual.radius)
