"""A footprint in large motion that starts from a nearby one is the footprint that load steps reach."""

from __future__ import annotations

import pytest
from bias_tyre import bias

from tyrefem.inputs.loading import LoadCase
from tyrefem.mechanics.finite_elements import FiniteElements
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.footprint.nearby_balance import nearby_balance
from tyrefem.mechanics.footprint.pressed_tyre import PressedTyre


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
