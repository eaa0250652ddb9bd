"""Large motion is what a study gets without asking; the page says which motion was used."""

from __future__ import annotations

import pytest
from bias_tyre import bias

import tyrefem as tf
from tyrefem.mechanics.finite_elements import FiniteElements
from tyrefem.reports.assumptions import assumptions
from tyrefem.reports.inputs import mechanics_rows

SHIPPED = ("passenger-205-55r16", "truck-295-80r22.5", "aircraft-radial", "measured-205-60r15", "measured-255-40r17")


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_studies_by_finite_elements_are_in_large_motion(name: str) -> None:
    assert tf.study(name).card.mechanics.motion == "large"


def test_a_study_gets_large_motion_without_asking(bias_cycle: FiniteElements) -> None:
    assert bias_cycle.footprint is not None
    assert bias_cycle.footprint.motion == "large"
    pressed = bias().press(load=bias_cycle.case.load)
    assert pressed.footprint.motion == "large"
    assert pressed.footprint.deflection == pytest.approx(bias_cycle.footprint.deflection, rel=1e-9)
    linear = bias(**{"mechanics.motion": "linear"}).press(load=bias_cycle.case.load)
    assert linear.footprint.motion == "linear"
    assert linear.footprint.deflection < 0.97 * pressed.footprint.deflection


def test_the_page_names_the_motion_and_what_the_linear_one_leaves_out(bias_cycle: FiniteElements) -> None:
    assert ["motion of the footprint", "large"] in mechanics_rows(bias(), bias_cycle)
    assert assumptions(bias(), [])[0][0] == "A footprint without friction"
    linear = bias(**{"mechanics.motion": "linear"})
    assert assumptions(linear, [])[0][0] == "A small deflection about the inflated tyre"
    assert ["motion of the footprint", "linear about the inflated tyre: a quick look, too stiff"] in mechanics_rows(
        linear
    )


def test_the_page_states_the_loss_of_a_harmonic_as_the_strain_cycle_has_it() -> None:
    """n pi tan delta e : C' : e a revolution is 2 pi tan delta of the strain energy, e : C' : e / 2, in each cycle."""
    texts = dict(assumptions(bias(), []))
    assert "loses 2π tan δ of its strain energy per cycle; tan δ depends" in texts["Loss of every harmonic"]
