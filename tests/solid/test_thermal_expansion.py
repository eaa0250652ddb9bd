"""Warm bodies against closed forms of small strain: free expansion, a bar held at its ends, a thick cylinder."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from solid_bodies import tube

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.mechanics.solid.body import Body
from tyrefem.mechanics.solid.compounds import neo_hookean
from tyrefem.mechanics.solid.cords import CordLayer
from tyrefem.mechanics.solid.inflation import inflate
from tyrefem.mechanics.solid.newton import equilibrium
from tyrefem.mechanics.solid.parts import RegionMaterial
from tyrefem.mechanics.solid.thermal import Expansion, expansions, thermal_equilibrium, warm

G, KAPPA = 1e6, 1e8
E, NU = 9 * KAPPA * G / (3 * KAPPA + G), (3 * KAPPA - 2 * G) / (6 * KAPPA + 2 * G)
ALPHA = 2e-4
EXPANSION = {"rubber": Expansion(ALPHA)}


def test_what_is_free_expands_without_stress() -> None:
    body = replace(tube(4, neo_hookean(G, KAPPA)), held={"ends": ""})
    body = replace(body, mesh=body.mesh.with_boundaries({"foot": lambda x: x[1] < 1e-9}), held={"foot": "z"})
    hot = warm(body, 125.0, EXPANSION)
    displacement = thermal_equilibrium(hot).displacement
    assert displacement == pytest.approx(ALPHA * 100 * body.rings.nodes, abs=1e-9)
    assert np.abs(hot.state(displacement, 0.0).stress).max() < 1e-6 * E
    assert hot.energy(displacement) == pytest.approx(0.0, abs=1e-9 * E)


def test_a_bar_held_at_its_ends_is_pressed() -> None:
    """sigma_zz = -E alpha (T - T0), the other stresses none: at a rise of 1 K within a thousandth."""
    hot = warm(tube(4, neo_hookean(G, KAPPA)), 26.0, EXPANSION)
    stress = hot.state(thermal_equilibrium(hot).displacement, 0.0).stress
    assert stress[1] == pytest.approx(-E * ALPHA, rel=1e-3)
    assert np.abs(stress[[0, 2, 3]]).max() < 1e-3 * E * ALPHA


def test_a_thick_cylinder_hot_inside() -> None:
    """T = T0 + 1 K (1 - ln r/ln 2) from r = 1 to 2, ends held: Timoshenko & Goodier, Theory of elasticity, section 135.

    sigma_r = E alpha/(1 - nu)/r^2 [(r^2 - 1)/3 I(2) - I(r)], sigma_t likewise with (r^2 + 1)/3 I(2) + I(r) - r^2 T,
    sigma_z = E alpha/(1 - nu) [2 nu/3 I(2) - T], I(r) = int_1^r T r dr.
    """
    hot = warm(tube(8, neo_hookean(G, KAPPA)), lambda x: 26.0 - np.log(x[0]) / np.log(2.0), EXPANSION)
    stress, r = hot.state(thermal_equilibrium(hot).displacement, 0.0).stress, hot.rings.points[0]

    def moment(r: np.ndarray | float) -> np.ndarray:
        return np.asarray((np.square(r) - 1) / 2 - (np.square(r) / 2 * np.log(r) - (np.square(r) - 1) / 4) / np.log(2))

    rise, scale, whole = 1 - np.log(r) / np.log(2.0), E * ALPHA / (1 - NU), moment(2.0) / 3
    radial = scale / r**2 * ((r**2 - 1) * whole - moment(r))
    hoop = scale / r**2 * ((r**2 + 1) * whole + moment(r) - r**2 * rise)
    axial = scale * (2 * NU * whole - rise)
    for computed, exact in zip(stress[:3], (radial, axial, hoop), strict=True):
        assert computed == pytest.approx(exact, abs=3e-3 * np.abs(hoop).max())


def test_cords_hinder_the_expansion_of_their_rubber() -> None:
    """Hoop cords of a free thin ring that keep their length hold it: E/(v_c E_c + E) of its growth is left."""
    plain = tube(1, neo_hookean(G, KAPPA), inner=1.0, outer=1.01, height=0.02)
    shape = plain.rings.weights.shape
    cords = CordLayer(np.zeros(shape), np.stack([np.zeros(shape), np.ones(shape)]), np.full(shape, 3 * E))
    mesh = plain.mesh.with_boundaries({"foot": lambda x: x[1] < 1e-9})
    body = Body(mesh, {"rubber": RegionMaterial(neo_hookean(G, KAPPA), (cords,))}, {"foot": "z"})
    displacement = thermal_equilibrium(warm(body, 30.0, EXPANSION)).displacement[0] / body.rings.nodes[0]
    assert displacement.mean() == pytest.approx(ALPHA * 5 * E / (E + 3 * E), rel=5e-3)
    same = {"rubber": Expansion(ALPHA, ALPHA)}
    alike = thermal_equilibrium(warm(body, 30.0, same)).displacement[0] / body.rings.nodes[0]
    assert alike == pytest.approx(ALPHA * 5, rel=1e-4)


def test_the_stiffness_is_the_derivative_of_the_forces() -> None:
    body = tube(2, neo_hookean(G, KAPPA))
    shape = body.rings.weights.shape
    cords = CordLayer(np.full(shape, 0.6), np.stack([np.zeros(shape), np.ones(shape)]), np.full(shape, 2e7))
    body = replace(body, parts={"rubber": RegionMaterial(neo_hookean(G, KAPPA), (cords,))})
    hot = warm(body, lambda x: 60 + 40 * x[0], {"rubber": Expansion(ALPHA, 1e-5)})
    rng = np.random.default_rng(3)
    u, du = (0.02 * rng.standard_normal((2, body.rings.n_nodes)) for _ in range(2))
    step = 1e-5
    ahead, behind = (hot.residual(u + sign * step * du, 1e5) for sign in (1, -1))
    slope = hot.stiffness(u, 1e5) @ du.T.ravel()
    assert slope == pytest.approx((ahead - behind) / (2 * step), abs=1e-6 * np.abs(slope).max())
    work = (hot.energy(u + step * du) - hot.energy(u - step * du)) / (2 * step)
    assert work == pytest.approx(hot.residual(u, 0.0) @ du.T.ravel(), rel=1e-6)


def test_at_its_own_temperature_nothing_changes() -> None:
    body, u = tube(3), 0.01 * np.random.default_rng(2).standard_normal((2, tube(3).rings.n_nodes))
    assert np.array_equal(warm(body, 25.0, EXPANSION).residual(u, 1e4), body.residual(u, 1e4))


def test_unknown_regions_and_shapes_are_refused() -> None:
    with pytest.raises(InputError, match="no region 'ruber'"):
        warm(tube(1), 30.0, {"ruber": Expansion(ALPHA)})
    with pytest.raises(InputError, match="one number per Gauss point"):
        warm(tube(1), np.zeros(3), EXPANSION)
    with pytest.raises(InputError, match="finite"):
        warm(tube(1), np.nan, EXPANSION)


def test_a_studys_cards_give_the_expansion() -> None:
    regions = ("carcass", "tread", "sidewall", "bead")
    cards = {f"materials.{r}.expansion": {"coefficient": "2e-4 1/delta_degC", "source": "test"} for r in regions}
    study = tf.study("nasa-22x5.5-8pr", {"mesh.size": "16 mm", "mesh.through": 1, **cards})
    assert expansions(study)["tread"] == Expansion(2e-4, 0.0, 25.0)
    cold, hot = inflate(study, 2e5), inflate(study, 2e5, temperature=lambda x: np.full(x.shape[1], 75.0))
    alone = inflate(study, 0.0, temperature=75.0)
    # The rim holds it and cords keep their length: the tyre grows by far less than the free 2.8 mm.
    assert 0.05e-3 < alone.radius_growth < 1.5e-3
    assert hot.radius_growth > cold.radius_growth


def test_without_a_card_that_expands_a_temperature_is_refused() -> None:
    with pytest.raises(InputError, match="no material card gives 'expansion'"):
        inflate(tf.study("nasa-22x5.5-8pr"), 1e5, temperature=60.0)


@pytest.mark.fast
@pytest.mark.parametrize("rise", [0.0, 1e-9, 1e-6])
def test_a_body_at_its_stress_free_temperature_keeps_its_balance(rise: float) -> None:
    """Its heating has no forces but the rounding that its cold balance left, which no Newton step makes smaller."""
    body = tube(2, neo_hookean(G, KAPPA))
    cold = equilibrium(body, 1e4)
    hot = thermal_equilibrium(warm(body, 25.0 + rise, EXPANSION), cold)
    assert hot.displacement == pytest.approx(cold.displacement, rel=1e-5)
