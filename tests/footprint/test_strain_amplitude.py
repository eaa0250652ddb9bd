"""Strain amplitude over a revolution, and the loss of compounds whose moduli depend on it."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
import pytest

from tyrefem.errors import InputError
from tyrefem.inputs.study import study
from tyrefem.materials.card import material
from tyrefem.materials.loss_tangent import OfTemperature, PowerLaw
from tyrefem.materials.strain_dependence import StrainDependence
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.loss import RevolutionLoss
from tyrefem.mechanics.footprint.press import press
from tyrefem.mechanics.footprint.strain_amplitude import StrainAmplitude, shear_amplitude
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics
from tyrefem.mechanics.solved_cases import KnotSolver
from tyrefem.mechanics.strain_cycle import LOSS_FACTOR

REGIONS = ("ply", "belt", "tread", "sidewall")
SWEEP = {
    "small_strain_modulus": "3.5 MPa",
    "large_strain_modulus": "1 MPa",
    "greatest_loss_modulus": "0.3 MPa",
    "large_strain_loss_modulus": "0.08 MPa",
    "critical_strain": "2 %",
    "source": "test",
}
LAW = StrainDependence.check(SWEEP)


@pytest.fixture(scope="module")
def cycle() -> StrainHarmonics:
    return StrainHarmonics(Pressing(PlainTyre().state(along=12)).at_deflection(0.02, 54))


@dataclass(frozen=True, eq=False)
class SimpleShear(StrainHarmonics):
    """Every point is sheared in (r, z) as g cos t."""

    shear: float = 0.03

    @functools.cached_property
    def amplitudes(self) -> np.ndarray:
        amplitudes = np.zeros((self.footprint.harmonics + 1, 6, *self.elements.radii.shape))
        amplitudes[1, 3] = self.shear
        return amplitudes


def test_amplitude_of_simple_and_uniaxial_cycles() -> None:
    t = np.linspace(0, 2 * np.pi, 181)
    shear = np.zeros((6, 1, 181))
    shear[4] = 0.5 + 0.04 * np.cos(t)
    assert shear_amplitude(shear) == pytest.approx([0.04], rel=1e-12)
    pulled = np.zeros((6, 1, 181))
    pulled[:3] = np.array([-0.5, -0.5, 1.0])[:, None, None] * 0.02 * np.sin(t)
    assert shear_amplitude(pulled) == pytest.approx([np.sqrt(3) * 0.02], rel=1e-3)
    swelling = np.zeros((6, 1, 181))
    swelling[:3] = 0.01 * np.sin(t)
    assert shear_amplitude(swelling) == pytest.approx([0.0], abs=1e-9)


def test_amplitude_is_half_the_diameter_of_the_path() -> None:
    """Two shears a quarter cycle apart run round an ellipse, whose longer half axis is the amplitude."""
    t = np.linspace(0, 2 * np.pi, 720, endpoint=False)
    strain = np.zeros((6, 1, 720))
    strain[3], strain[5] = 0.05 * np.cos(t), 0.02 * np.sin(t)
    assert shear_amplitude(strain) == pytest.approx([0.05], rel=1e-9)


def test_one_side_of_a_mirrored_cycle_gives_the_amplitude_of_the_whole(cycle: StrainHarmonics) -> None:
    side = np.pi * np.linspace(0, 1, 25) ** 2
    whole = np.concatenate([-side[:0:-1], side])
    exact = shear_amplitude(cycle.strain(whole))
    assert cycle.mirrored
    np.testing.assert_allclose(shear_amplitude(cycle.strain(side), mirrored=True), exact, rtol=1e-9)
    assert np.abs(shear_amplitude(cycle.strain(side)) / exact - 1).max() > 0.05


def test_a_cycle_of_simple_shear_loses_pi_g2_times_the_loss_modulus(cycle: StrainHarmonics) -> None:
    region = "sidewall"
    members = cycle.elements.mesh.subdomains[region]
    modulus = cycle.footprint.pressing.state.storage[3, 3, members]
    tangent = float(LAW.kraus.loss(0.1) / LAW.kraus.storage(0.1))
    for shear in (0.002, 0.02, 0.3):
        sheared = SimpleShear(cycle.footprint, shear)
        loss = RevolutionLoss(sheared, {region: OfTemperature(tangent)}, 20.0, strain_laws={region: LAW})
        assert loss.strain.amplitudes == pytest.approx(shear, rel=1e-9)
        # The card's modulus is that of the sweep at 10 % times a factor.
        factor = modulus / LAW.kraus.storage(0.1)
        assert loss.density[members] == pytest.approx(np.pi * factor * LAW.kraus.loss(shear) * shear**2, rel=1e-9)


def test_without_laws_nothing_changes_to_the_last_digit(cycle: StrainHarmonics) -> None:
    tangents = {name: PowerLaw(0.1, 0.3) for name in REGIONS}
    plain, empty = (RevolutionLoss(cycle, tangents, 20.0, 60.0, laws) for laws in ({}, {"belt": LAW}))
    cards = {name: material("nasa-sidewall") for name in REGIONS}
    of_cards = RevolutionLoss.of_cards(cycle, cards, 20.0, 60.0)
    by_hand = RevolutionLoss(cycle, {name: cards[name].loss_tangent.over_frequency for name in REGIONS}, 20.0, 60.0)
    assert np.array_equal(of_cards.densities, by_hand.densities)
    assert np.array_equal(of_cards.one_cycle_density(), by_hand.one_cycle_density())
    outside = np.setdiff1d(np.arange(len(cycle.elements.radii)), cycle.elements.mesh.subdomains["belt"])
    assert np.array_equal(plain.densities[:, outside], empty.densities[:, outside])
    assert not np.array_equal(plain.densities, empty.densities)


def test_the_loss_of_a_point_follows_its_amplitude(cycle: StrainHarmonics) -> None:
    tangents = {name: OfTemperature(0.1) for name in REGIONS}
    plain = RevolutionLoss(cycle, tangents, 20.0)
    by_strain = RevolutionLoss(cycle, tangents, 20.0, strain_laws=dict.fromkeys(REGIONS, LAW))
    assert by_strain.density == pytest.approx(plain.density * LAW.lossiness(by_strain.strain.amplitudes), rel=1e-12)
    assert by_strain.one_cycle_density() == pytest.approx(
        plain.one_cycle_density() * LAW.lossiness(by_strain.strain.amplitudes), rel=1e-12
    )


def test_mean_amplitude_stores_as_much_as_all_points(cycle: StrainHarmonics) -> None:
    strain = StrainAmplitude(cycle, {"tread": LAW})
    members = cycle.elements.mesh.subdomains["tread"]
    g, volume = strain.amplitudes[members], cycle.elements.weights[members]
    mean = strain.mean_amplitude("tread")
    assert g.min() < mean < g.max()
    assert LAW.kraus.storage(mean) * (g**2 * volume).sum() == pytest.approx(
        (LAW.kraus.storage(g) * g**2 * volume).sum(), rel=1e-9
    )
    with pytest.raises(InputError, match="did you mean 'tread'"):
        RevolutionLoss(cycle, {}, 20.0, strain_laws={"treads": LAW})


def test_a_study_uses_its_cards_in_press_and_heat_source_alike_and_cords_do_not_change() -> None:
    """Heat source over one revolution against the loss of the pressed tyre; the plies' cords lose as without laws."""
    tyre = study("passenger-205-55r16", {"mesh.size": "12 mm", "mechanics.strain": "fem", "mechanics.motion": "linear"})
    case, energies = KnotSolver(tyre).solve(0, 0.0)
    pressed = press(tyre, load=case.load, drum_diameter=case.drum_diameter)
    loss = pressed.loss
    assert loss is not None
    factor = 2 * 2 * np.pi * np.pi * LOSS_FACTOR[tyre.card.mechanics.loss_convention]
    for region in ("tread", "body-ply", "bead"):
        members = pressed.tyre.body.mesh.subdomains[region]
        weights = loss.cycle.elements.weights[members]
        tangent = float(tyre.materials[region].loss_tangent(tyre.card.drive.initial))
        lost = factor * tangent * (energies.density[members] * weights).sum()
        assert lost == pytest.approx(loss.by_region[region], rel=1e-9)
    bare = RevolutionLoss(loss.cycle, loss.tangents, loss.speed, loss.temperature)
    assert tyre.materials["bead"].strain_dependence is None
    assert loss.by_region["bead"] == bare.by_region["bead"]
    law = tyre.materials["body-ply"].strain_dependence
    assert law is not None
    members = loss.cycle.elements.mesh.subdomains["body-ply"]
    total, rubber = (
        (np.arange(loss.cycle.footprint.harmonics + 1)[:, None, None] * products).sum(axis=0)[members]
        for products in (loss.cycle.storage_products, loss.cycle.rubber_products)
    )
    cords = total - rubber
    assert (cords > -1e-9 * total).all()
    assert cords.sum() > 0.05 * total.sum()
    expected = (cords + rubber * law.lossiness(loss.strain.amplitudes[members])) / total
    assert loss.density[members] == pytest.approx(bare.density[members] * expected, rel=1e-9)
