"""A footprint in large motion that starts from a nearby one is the footprint that load steps reach."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest
from bias_tyre import bias

from tyrefem.inputs.loading import LoadCase
from tyrefem.mechanics.finite_elements import FiniteElements
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.footprint.nearby_balance import NearbyFootprint, nearby_balance
from tyrefem.mechanics.footprint.pressed_tyre import PressedTyre, mechanical_mesh
from tyrefem.mechanics.solid.inflation import inflate


@pytest.mark.parametrize(("load", "pressure"), [(1.03, 1.0), (1.0, 1.03), (0.97, 0.98)])
def test_a_nearby_footprint_is_the_one_from_the_free_tyre(
    bias_cycle: FiniteElements, load: float, pressure: float
) -> None:
    """Wherever the solution starts, it is the same within the balance's tolerance."""
    tyre, case, start = PressedTyre(bias()), bias_cycle.case, bias_cycle.footprint
    assert start is not None
    moved = LoadCase(load * case.load, 0.0, pressure * case.pressure, case.outer_radius, case.drum_diameter)
    near = tyre.footprint(moved, large=True, near=start)
    far = tyre.footprint(moved, large=True)
    assert near is not None
    assert far is not None
    assert near is not far
    assert near.deflection == pytest.approx(far.deflection, rel=2e-3)
    assert near.area == pytest.approx(far.area, rel=5e-3)
    assert near.stiffness == pytest.approx(far.stiffness, rel=0.03)
    assert near.load == pytest.approx(moved.load, rel=1e-3)


def test_too_far_a_start_or_another_mesh_is_none(bias_cycle: FiniteElements) -> None:
    assert bias_cycle.footprint is not None
    balance = Balance(bias_cycle.footprint.pressing)
    assert nearby_balance(balance, bias_cycle.footprint, load=2.5 * bias_cycle.case.load) is None
    other = bias(**{"mesh.size": "18 mm"})
    finer = PressedTyre(other).footprint(bias_cycle.case, large=True, near=bias_cycle.footprint)
    assert finer is not None
    assert finer.motion == "large"
    linear = bias(**{"mechanics.motion": "linear"}).press(load=bias_cycle.case.load).footprint
    assert nearby_balance(balance, linear, load=bias_cycle.case.load) is None


def test_a_tyre_of_other_loss_needs_no_search(bias_cycle: FiniteElements) -> None:
    """Loss dissipates; in a standing press it moves nothing."""
    start = bias_cycle.footprint
    assert start is not None
    lossy = replace(start.pressing.state, storage=1.2 * start.pressing.state.storage)
    footprint = nearby_balance(Balance(Pressing(lossy)), start, load=bias_cycle.case.load)
    assert footprint is not None
    assert footprint.balanced is start.balanced
    assert footprint.amplitudes is start.amplitudes
    assert footprint.stiffness == start.stiffness
    assert footprint.pressing.state is lossy
    stiffer = replace(start.pressing.state, stress=1.02 * start.pressing.state.stress)
    moved = nearby_balance(Balance(Pressing(stiffer)), start, load=bias_cycle.case.load)
    assert moved is not None
    assert moved.balanced is not start.balanced


def test_stiffness_computed_later_is_that_of_the_load_steps(bias_cycle: FiniteElements) -> None:
    start = bias_cycle.footprint
    assert start is not None
    parts = {part.name: getattr(start, part.name) for part in fields(Footprint)}
    later = NearbyFootprint(**{**parts, "known_stiffness": 0.0})
    assert later.stiffness == pytest.approx(start.stiffness, rel=0.01)


def test_an_inflated_tyre_near_another_is_the_one_from_the_undeformed_state(bias_cycle: FiniteElements) -> None:
    study, pressure = bias(), 1.05 * bias_cycle.case.pressure
    near = inflate(study, pressure, mechanical_mesh(study), near=bias_cycle.tyre)
    far = inflate(study, pressure, mechanical_mesh(study))
    assert near.equilibrium.steps == (1.0,)
    assert len(far.equilibrium.steps) > 1
    np.testing.assert_allclose(
        near.equilibrium.displacement, far.equilibrium.displacement, rtol=0, atol=1e-7 * far.radius_growth
    )
