"""Mass, cords and rubber of the radials from their cards."""

from __future__ import annotations

import math

import numpy as np
import pytest
from constructions import RADIALS

import tyrefem as tf
from tyrefem.geometry.meshing import build
from tyrefem.materials.card import material
from tyrefem.materials.cord_layers import masses, region_thickness
from tyrefem.materials.elasticity import Cords, MooneyRivlin, NeoHookean, Yeoh
from tyrefem.mechanics.solid.cords import lifted_ends
from tyrefem.mechanics.solid.tyre_body import tyre_body

pytestmark = pytest.mark.fast

STEEL, POLYESTER, NYLON, HYBRID = 7850.0, 1380.0, 1140.0, 1290.0
#: Card -> (tyre, region, density of a filament, share of the cord's round outline that filaments fill).
PLIES = {
    "passenger-belt": ("passenger", "belt-1", STEEL, 1.0),
    "passenger-body-ply": ("passenger", "body-ply", POLYESTER, 1.0),
    "passenger-cap-ply": ("passenger", "cap-ply", NYLON, 1.0),
    "truck-body-ply": ("truck", "body-ply", STEEL, 0.75),
    "truck-transition-belt": ("truck", "belt-1", STEEL, 0.75),
    "truck-belt": ("truck", "belt-2", STEEL, 0.75),
    "truck-protector-belt": ("truck", "belt-4", STEEL, 0.7),
    "aircraft-body-ply": ("aircraft", "body-plies", NYLON, 1.0),
    "aircraft-belt": ("aircraft", "inner-belts", HYBRID, 1.0),
}
RUBBER = 1120.0


@pytest.mark.parametrize("name", RADIALS)
def test_the_tyre_weighs_what_such_tyres_weigh(name):
    radial = RADIALS[name]
    by_region = masses(radial.section, tf.study(radial.study).materials)
    low, high = radial.mass
    assert low < sum(by_region.values()) - radial.voids * by_region["tread"] < high
    assert min(by_region.values()) > 0


def test_mass_is_density_times_the_ring_of_both_halves():
    radial = RADIALS["passenger"]
    section, cards = radial.section, tf.study(radial.study).materials
    whole = sum(masses(section, dict.fromkeys(cards, cards["tread"])).values())
    assert whole == pytest.approx(2 * section.volume() * 1180.0, rel=1e-9)


@pytest.mark.parametrize("card", PLIES)
def test_cords_and_density_of_a_ply_agree(card):
    """rho = (1 - phi) rho_rubber + phi rho_cord, phi = v_c x filling: two statements of one card, within 3 %."""
    tyre, region, dense, filling = PLIES[card]
    ply, section = material(card), RADIALS[tyre].section
    # The cords lie in the ply where it is a ply: the thickness of its layer does not vary there.
    thin, thick = region_thickness(section, region)
    assert thick == pytest.approx(thin, rel=0.1)
    fraction = ply.cords.volume_fraction(thin)
    assert fraction == pytest.approx(ply.cords.ends * math.pi * ply.cords.diameter**2 / 4 / thin, rel=1e-12)
    assert 0.1 < fraction < 0.5
    phi = fraction * filling
    assert ply.density.at(25.0) == pytest.approx((1 - phi) * RUBBER + phi * dense, rel=0.03)


@pytest.mark.parametrize("name", RADIALS)
def test_the_bead_has_the_wires_of_the_rating(name):
    """The integral of v_c over the bundle as it is drawn and meshed."""
    study = tf.study(RADIALS[name].study)
    cords, rating = study.materials["bead"].cords, study.section.rating
    mesh = build(study.section, size=RADIALS[name].size, through=1)
    body = tyre_body(study, mesh)
    weights = body.rings.weights[body.mesh.subdomains["bead"]]
    (layer,) = body.parts["bead"].cords
    radius = body.rings.points[0, body.mesh.subdomains["bead"]]
    wires = (layer.stiffness / cords.modulus * weights / radius).sum()
    assert wires == pytest.approx(rating.bead_area, rel=0.01)
    assert (cords.angle, cords.lift) == (0.0, False)


@pytest.mark.parametrize(
    ("card", "energy"),
    [
        (NeoHookean(law="neo-hookean", shear_modulus="1.4 MPa", source="test"), lambda x: 0.7e6 * x),
        (MooneyRivlin(law="mooney-rivlin", c10="0.5 MPa", c01="0.2 MPa", source="test"), lambda x: 0.7e6 * x),
        (
            Yeoh(law="yeoh", c10="0.7 MPa", c20="-0.1 MPa", c30="0.05 MPa", source="test"),
            lambda x: 0.7e6 * x - 0.1e6 * x**2 + 0.05e6 * x**3,
        ),
    ],
)
def test_the_shear_modulus_is_the_curvature_of_the_energy(card, energy):
    """Simple shear g: I1 = I2 = 3 + g^2, so G = W''(0)."""
    g = 1e-4
    curvature = (energy(g**2) - 2 * energy(0.0) + energy(g**2)) / g**2
    assert card.initial_shear_modulus == pytest.approx(curvature, rel=1e-6)
    assert card.bulk == pytest.approx(100 * card.initial_shear_modulus)


def test_round_cords_fill_a_hexagonal_packing_and_no_more():
    """Cords that touch, in plies of sqrt(3)/2 diameters: pi / (2 sqrt 3) of the layer, whatever their size."""
    for diameter in (0.5e-3, 1.1e-3):
        cords = Cords(
            modulus="1 GPa", diameter=f"{diameter} m", ends=f"{100 / diameter!r} 1/m", plies=100, angle="0 deg",
            lift=False, source="test",
        )  # fmt: skip
        tight = 100 * diameter * math.sqrt(3) / 2
        assert cords.volume_fraction(tight * (1 + 1e-9)) == pytest.approx(math.pi / (2 * math.sqrt(3)), rel=1e-6)
        with pytest.raises(tf.InputError, match="ends: the cords would take 92% of the layer"):
            cords.volume_fraction(tight * 0.99)


def test_a_textile_cord_may_be_slack_in_compression():
    steel, textile = material("truck-belt").cords, material("passenger-body-ply").cords
    assert steel.in_compression == steel.modulus
    assert textile.in_compression == pytest.approx(0.1 * textile.modulus)


@pytest.mark.parametrize("name", RADIALS)
def test_the_tyre_has_its_standard_size(name):
    """ETRTO overall diameter and section width of the two road tyres; 0.985 and 0.975 of 22 and 5.5 in, the largest."""
    sizes = {"passenger": (0.632, 0.214), "truck": (1.044, 0.298), "aircraft": (0.5504, 0.1362)}
    section = RADIALS[name].section
    assert np.array([section.outer_diameter, section.overall_width]) == pytest.approx(sizes[name], rel=5e-3)


def fractions(study, region, size):
    """v_c at the Gauss points of a region, their stations, distances from the meridian, and cord section per metre."""
    mesh, cords = build(study.section, size=size, through=1), study.materials[region].cords
    body = tyre_body(study, mesh)
    points = body.rings.points[:, body.mesh.subdomains[region]]
    s, y = study.section.line.nearest(np.moveaxis(points, 0, -1))
    ends = cords.ends * lifted_ends(cords.angle, cords.angle_radius, points[0])
    (layer,) = body.parts[region].cords
    return layer.stiffness / cords.modulus, s, y, ends * math.pi * cords.diameter**2 / 4


@pytest.mark.parametrize("name", ["truck", "aircraft"])
def test_each_leg_of_the_chafers_fabric_is_one_ply(name):
    """The strip goes on round the bead: v_c = ends pi d^2 / (4 h), h the thickness of the leg."""
    radial = RADIALS[name]
    section, study = radial.section, tf.study(radial.study)
    fraction, s, y, area = fractions(study, "chafer-fabric", radial.size)
    inner = y < section.interfaces(s)[1]
    assert 0.1 < inner.mean() < 0.9
    thickness = np.where(inner, section.layers[0].thickness(s), section.layers[-1].thickness(s))
    np.testing.assert_allclose(fraction, area / thickness, rtol=1e-6)
    assert study.materials["chafer-fabric"].cords.plies == 1


def test_neighbouring_layers_of_a_region_share_its_cords():
    study = tf.study("passenger-205-55r16")
    materials = {region: card for region, card in study.data["materials"].items() if region != "liner"}
    thick = study.replace(
        {"section.layers.liner.regions.0.name": "body-ply", "materials": materials, "mechanics.energy": None}
    )
    fraction, s, _, area = fractions(thick, "body-ply", RADIALS["passenger"].size)
    first, second = (layer.thickness(s) for layer in thick.section.layers[:2])
    start = thick.section.layers[0].regions.ends[0]
    # Below the liner's end the ply is alone.
    np.testing.assert_allclose(fraction, area / np.where(s < start, first + second, second), rtol=1e-6)
