"""Short waves of a tyre near another: the difference at a few harmonics is the difference at all."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
from bias_tyre import bias

from tyrefem.mechanics.finite_elements import FiniteElements
from tyrefem.mechanics.footprint import nearby_balance as nearby_balance_module
from tyrefem.mechanics.footprint.compliance import TreadCompliance
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.footprint.nearby_balance import nearby_balance
from tyrefem.mechanics.footprint.nearby_tread import (
    NearbyPressing,
    NearbyTread,
    ShortWaves,
    few_harmonics,
    few_weights,
)
from tyrefem.mechanics.footprint.pressed_tyre import PressedTyre, mechanical_mesh
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics

TREAD = "materials.tread.shear_modulus.value"


@pytest.fixture(scope="module")
def start(bias_cycle: FiniteElements) -> Footprint:
    assert bias_cycle.footprint is not None
    return bias_cycle.footprint


@pytest.fixture(scope="module")
def stiffer(bias_cycle: FiniteElements) -> Pressing:
    """The tyre with a tread that is stiffer by a fifth: of all parts it matters most to short waves."""
    tyre = PressedTyre(bias().scaled(TREAD, 1.2)).inflated(bias_cycle.case.pressure, bias_cycle.tyre)
    return Pressing(tyre.state)


def test_weights_reproduce_polynomials_of_the_logarithm() -> None:
    few, wanted = few_harmonics(120, 24), np.arange(25, 121)
    for power in range(len(few)):
        exact = np.log1p(wanted) ** power
        np.testing.assert_allclose(few_weights(120, 24) @ np.log1p(few) ** power, exact, rtol=1e-9)


def test_compliance_of_short_waves_is_that_of_all_harmonics(start: Footprint, stiffer: Pressing) -> None:
    waves = ShortWaves(start)
    highest, above = start.harmonics, waves.above
    before, exact = start.grid.tread.up_to(highest, above), stiffer.tread.up_to(highest, above)
    near = NearbyTread(stiffer.harmonics, waves).up_to(highest, above)
    change = np.abs(exact - before).max()
    assert change > 0.05 * np.abs(before).max()
    assert np.abs(near - exact).max() < 0.02 * change


def test_motion_of_short_waves_is_that_of_all_harmonics(start: Footprint, stiffer: Pressing) -> None:
    """Also under other forces than those of the footprint from which it starts."""
    waves = ShortWaves(start)
    loads = 0.9 * start.load_harmonics
    exact = TreadCompliance(stiffer.harmonics).fields(loads, waves.above)
    near = NearbyTread(stiffer.harmonics, waves).fields(loads, waves.above)
    change = np.abs(exact - waves.motion).max()
    assert change > 0.05 * np.abs(waves.motion).max()
    assert np.abs(near - exact).max() < 0.02 * change


def test_other_harmonics_are_solved_one_by_one(start: Footprint, stiffer: Pressing) -> None:
    near, alone = NearbyTread(stiffer.harmonics, ShortWaves(start)), TreadCompliance(stiffer.harmonics)
    np.testing.assert_allclose(near.up_to(30, 2), alone.up_to(30, 2), rtol=1e-9, atol=0)
    loads = start.load_harmonics[:31]
    np.testing.assert_array_equal(near.fields(loads, 2), alone.fields(loads, 2))


def test_footprints_of_one_tyre_share_its_factors(
    start: Footprint, stiffer: Pressing, monkeypatch: pytest.MonkeyPatch
) -> None:
    waves = ShortWaves(start)
    highest, above = start.harmonics, waves.above
    first = NearbyPressing(stiffer.state, waves=waves)
    compliance, motion = first.tread.up_to(highest, above), first.tread.fields(start.load_harmonics, above)
    second = NearbyPressing(stiffer.state, waves=waves, like=first)
    monkeypatch.delattr(Harmonics, "factor_with_last")
    np.testing.assert_array_equal(second.tread.up_to(highest, above), compliance)
    np.testing.assert_array_equal(second.tread.fields(start.load_harmonics, above), motion)


def test_forces_beside_the_tread_are_solved_at_all_harmonics(start: Footprint, stiffer: Pressing) -> None:
    waves = ShortWaves(start)
    near, alone = NearbyTread(stiffer.harmonics, waves), TreadCompliance(stiffer.harmonics)
    loads = np.zeros((start.harmonics + 1, stiffer.harmonics.elements.n_dofs))
    loads[waves.above + 1 :, stiffer.harmonics.free[0]] = 1.0
    np.testing.assert_array_equal(near.responses(loads, waves.above), alone.responses(loads, waves.above))


def test_a_footprint_from_another_process_knows_the_compliance_of_its_short_waves(
    start: Footprint, monkeypatch: pytest.MonkeyPatch
) -> None:
    above = ShortWaves(start).above
    compliance = start.grid.tread.up_to(start.harmonics, above)
    tread = pickle.loads(pickle.dumps(start.grid.tread))
    monkeypatch.delattr(Harmonics, "compliance")
    np.testing.assert_array_equal(tread.up_to(start.harmonics, above), compliance)
    with pytest.raises(AttributeError, match="compliance"):
        tread.up_to(start.harmonics, above + 1)


def test_copies_of_one_tyre_are_led_by_the_same_small_motions(start: Footprint, stiffer: Pressing) -> None:
    """Drives of one pressure come from several files, but their tyre is one; another stiffness is another tyre."""
    copy = replace(start, pressing=pickle.loads(pickle.dumps(start.pressing)))
    assert copy.pressing is not start.pressing
    leading = nearby_balance_module._leading(start)
    assert nearby_balance_module._leading(copy) is leading
    assert nearby_balance_module._leading(replace(start, pressing=stiffer)) is not leading


def test_strain_energy_near_a_footprint_is_that_of_the_whole_compliance(
    bias_cycle: FiniteElements, start: Footprint, stiffer: Pressing
) -> None:
    """The same motion of the long waves; short ones by all harmonics."""
    near = nearby_balance(Balance(stiffer), start, load=bias_cycle.case.load)
    assert near is not None
    assert near.balanced is not None
    products = StrainHarmonics(near).storage_products
    orders = np.arange(len(products))[:, None, None]
    whole = near.amplitudes.copy()
    whole[len(near.balanced) :] = stiffer.tread.fields(near.load_harmonics, len(near.balanced) - 1)
    before = (orders * StrainHarmonics(start).storage_products).sum(axis=0)
    elements = near.pressing.harmonics.elements
    shorts = range(len(near.balanced), len(whole))
    short = [(elements.strain(n, near.amplitudes[n]), elements.strain(n, whole[n])) for n in shorts]
    storage = stiffer.state.storage
    off = sum(
        n * (np.einsum("ieq,ijeq,jeq->eq", b, storage, b) - np.einsum("ieq,ijeq,jeq->eq", a, storage, a))
        for n, (a, b) in zip(shorts, short, strict=True)
    )
    change = (orders * products).sum(axis=0) - before
    weights = elements.weights
    assert np.sqrt((off**2 * weights).sum()) < 0.01 * np.sqrt((change**2 * weights).sum())


def test_tyres_of_other_stiffness_share_a_mesh() -> None:
    assert mechanical_mesh(bias()) is mechanical_mesh(bias().scaled(TREAD, 1.2))
