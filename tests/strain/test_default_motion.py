"""Large motion is what a study gets without asking; the page says which motion was used."""

from __future__ import annotations

import pytest

import tyrefem as tf
from tyrefem.mechanics.cycle_schedule import KnotSolver
from tyrefem.mechanics.finite_elements import FiniteElements
from tyrefem.reports.inputs import assumptions, mechanics_rows

COARSE = {"mesh.size": "14 mm", "mesh.element": "P1", "drive.duration": "60 s", "drive.load": "1000 lbf"}
SHIPPED = ("passenger-205-55r16", "truck-295-80r22.5", "aircraft-radial", "measured-205-60r15", "measured-255-40r17")


def bias(**changes: object) -> tf.Study:
    return tf.study("nasa-22x5.5-8pr", {**COARSE, "mechanics.strain": "fem", **changes})


@pytest.fixture(scope="module")
def cycle() -> FiniteElements:
    """A strain cycle of a study that says nothing of its motion."""
    solver = KnotSolver(bias())
    solved = solver.cycle(0, solver.case(0, 0.0))
    assert isinstance(solved, FiniteElements)
    return solved


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_studies_by_finite_elements_are_in_large_motion(name: str) -> None:
    assert tf.study(name).card.mechanics.motion == "large"


def test_a_study_gets_large_motion_without_asking(cycle: FiniteElements) -> None:
    assert cycle.footprint is not None
    assert cycle.footprint.motion == "large"
    pressed = bias().press(load=cycle.case.load)
    assert pressed.footprint.motion == "large"
    assert pressed.footprint.deflection == pytest.approx(cycle.footprint.deflection, rel=1e-9)
    linear = bias(**{"mechanics.motion": "linear"}).press(load=cycle.case.load)
    assert linear.footprint.motion == "linear"
    assert linear.footprint.deflection < 0.97 * pressed.footprint.deflection


def test_the_page_names_the_motion_and_what_the_linear_one_leaves_out(cycle: FiniteElements) -> None:
    assert ["motion of the footprint", "large"] in mechanics_rows(bias(), cycle)
    assert assumptions(bias(), [])[0][0] == "A footprint without friction"
    linear = bias(**{"mechanics.motion": "linear"})
    assert assumptions(linear, [])[0][0] == "A small deflection about the inflated tyre"
    assert ["motion of the footprint", "linear about the inflated tyre: a quick look, too stiff"] in mechanics_rows(
        linear
    )
