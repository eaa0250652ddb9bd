"""The bend of plies that press the bead, before inflation."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem.errors import InputError
from tyrefem.sizes import draw_size
from tyrefem.sizes.meridian import SizedMeridian
from tyrefem.sizes.pressed_bead import MOST_LARGER, MOST_PRESSED, bend_before, pressed_by

SIZES = ("22x5.5R12 8PR", "46x17R20", "22x5.5 8PR", "56x16 38PR")


def evenly_bent(size: str) -> SizedMeridian:
    return draw_size(size, {"bead_pressed": "0 mm"}).meridian


@pytest.mark.parametrize("size", SIZES)
def test_the_pressure_on_the_flange_is_the_pull_over_the_radius(size: str) -> None:
    """Axial balance at the flange: 2 pi r N sin phi = pi p (r^2 - r_m^2); E d/h = N/R."""
    line, pressure, modulus = evenly_bent(size), 1e6, 50e6
    r, _, phi = (float(value) for value in line.at(line.flange_s))
    pull = pressure * (r**2 - line.membrane.widest**2) / (2 * r * np.sin(phi))
    stress = modulus * pressed_by(line, pressure, modulus) / line.offset
    assert stress == pytest.approx(pull / line.bend, rel=1e-4)


@pytest.mark.parametrize("size", SIZES)
def test_before_inflation_the_plies_are_further_from_the_flange(size: str) -> None:
    """By what they press, to an eighth; beside the seat by nothing."""
    drawn, even = draw_size(size), evenly_bent(size)
    pressed, line = drawn.rules["bead_pressed"].value, drawn.meridian
    assert even.bend == pytest.approx(even.rim.radius + even.offset, rel=1e-9)
    assert float(even.to_flange(even.flange_s)) == pytest.approx(even.offset, rel=1e-9)
    leaves = np.array([float(value) for value in line.at(line.flange_s)[:2]])
    distance = float(np.hypot(*(leaves - line.rim.centre))) - line.rim.radius
    assert distance - line.offset == pytest.approx(pressed, rel=0.125)
    assert float(line.to_flange(line.length - line.rim.straight)) == pytest.approx(line.offset, rel=1e-9)
    assert drawn.rules["bend_radius"].value == pytest.approx(line.bend)


def test_stiff_beads_are_drawn_evenly_about_the_flange() -> None:
    usual, stiff = draw_size("46x17R20"), draw_size("46x17R20", {"bead_modulus": "480 MPa"})
    assert stiff.rules["bead_pressed"].value == pytest.approx(usual.rules["bead_pressed"].value / 10, rel=1e-4)
    assert usual.meridian.bend > stiff.meridian.bend > evenly_bent("46x17R20").bend


def test_soft_beads_have_a_limit() -> None:
    line = evenly_bent("22x5.5 8PR")
    assert bend_before(line, 1.0) == pytest.approx((1 + MOST_LARGER) * line.bend)
    soft = draw_size("22x5.5 8PR", {"bead_modulus": "2 MPa"})
    assert soft.rules["bead_pressed"].value == pytest.approx(MOST_PRESSED * line.offset)


def test_a_given_bend_is_kept_and_filled_up_to_the_flange() -> None:
    """A radial's outside follows the flange for any bend of its plies."""
    given = draw_size("22x5.5R12 8PR", {"bend_radius": "22 mm"})
    assert given.meridian.bend == pytest.approx(22e-3)
    assert given.meridian.to_flange(given.meridian.flange_s) > given.meridian.offset + 0.5e-3


def test_a_bead_pressed_through_is_refused() -> None:
    with pytest.raises(InputError, match="bead_pressed"):
        draw_size("22x5.5 8PR", {"bead_pressed": "9 mm"})


def test_wide_base_trucks_have_the_rule_and_others_do_not() -> None:
    assert "bead_pressed" in draw_size("445/65R22.5").rules.numbers
    assert not {"bead_pressed", "bead_modulus"} & draw_size("295/80R22.5").rules.numbers.keys()
