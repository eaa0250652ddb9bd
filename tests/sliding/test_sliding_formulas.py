"""Identities between Roberts' equations, their limits, and what must be refused."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tyrefem.boundaries import friction_names as sliding
from tyrefem.boundaries.friction_names import ICE, RUBBER, TEAK, Solid
from tyrefem.errors import InputError

pytestmark = pytest.mark.fast

SIZE = st.floats(1e-3, 1e3)


@given(force=SIZE, speed=SIZE, length=SIZE, breadth=SIZE)
def test_equations_1_with_2_and_3_and_12_and_13_are_one(
    force: float, speed: float, length: float, breadth: float
) -> None:
    edge = sliding.exit_rise(force, speed, length, breadth, ICE)
    flux = sliding.heat_flux(force, speed, length, breadth)
    assert sliding.surface_rise(flux, length / speed, ICE) == pytest.approx(edge, rel=1e-12)
    assert sliding.exit_rise_of_stress(force / (length * breadth), speed, length, ICE) == pytest.approx(edge, rel=1e-12)
    assert sliding.largest_friction(edge, speed, length, breadth, ICE) == pytest.approx(force, rel=1e-12)


@given(distance=SIZE, length=SIZE)
def test_fall_off_is_as_printed_and_can_be_solved_for_the_distance(distance: float, length: float) -> None:
    printed = math.sqrt((length + distance) / length) * (1 - math.sqrt(1 - length / (length + distance)))
    ratio = sliding.fall_off(distance, length)
    assert ratio == pytest.approx(printed, rel=1e-8)
    assert sliding.fall_off(sliding.distance_of_fall_off(ratio, length), length) == pytest.approx(ratio, rel=1e-9)


def test_far_behind_the_pad_the_rise_is_that_of_an_instantaneous_source() -> None:
    """F_0 l/v released at once leaves F_0 (l/v)/(b sqrt(pi t)), so the ratio tends to sqrt(l/d)/2."""
    assert sliding.fall_off(1e6, 1.0) == pytest.approx(0.5 * math.sqrt(1e-6), rel=1e-3)


def test_mean_under_the_pad_is_the_average_of_equation_1() -> None:
    steps = 20000
    mean = sum(sliding.surface_rise(1e4, 0.1 * (i + 0.5) / steps, TEAK) for i in range(steps)) / steps
    assert mean == pytest.approx(sliding.MEAN_OF_EXIT * sliding.surface_rise(1e4, 0.1, TEAK), rel=1e-5)


def test_two_conductors_share_as_their_effusivities() -> None:
    alone, shared = sliding.surface_rise(1e4, 0.2, TEAK), sliding.shared_rise(1e4, 0.2, TEAK, RUBBER)
    assert shared / alone == pytest.approx(sliding.share_into(TEAK, RUBBER), rel=1e-12)
    assert shared == pytest.approx(sliding.shared_rise(1e4, 0.2, RUBBER, TEAK), rel=1e-12)
    assert sliding.share_into(TEAK, RUBBER) + sliding.share_into(RUBBER, TEAK) == pytest.approx(1.0)
    felt = Solid(1e-9, 1.0, 1.0)
    assert sliding.shared_rise(1e4, 0.2, TEAK, felt) == pytest.approx(alone, rel=1e-4)


def test_share_into_the_slider_is_the_papers() -> None:
    """Equation 10 prints 0.96; the text says that a pad of 40 mm after 1 m has l/L such that the share is 0.2."""
    factor = sliding.share_into_slider(0.04, 1.0, RUBBER, TEAK) / math.sqrt(0.04)
    assert round(factor, 2) == 0.96
    assert sliding.share_of_like_solids(0.04, 1.0) == pytest.approx(0.2)


def test_the_slider_takes_no_more_than_all_heat() -> None:
    """Ice conducts far better than rubber: equation 9 gives a share of 2 and more at its own length."""
    with pytest.raises(InputError, match=r"slid: must be 0\.185 m or more: .* 2\.15 times all heat"):
        sliding.share_into_slider(0.04, 0.04, ICE, RUBBER)
    assert sliding.share_into_slider(0.04, 0.186, ICE, RUBBER) == pytest.approx(1.0, rel=0.01)


@pytest.mark.parametrize("bad", [-1.0, math.nan, math.inf])
@pytest.mark.parametrize(
    ("field", "call"),
    [
        ("force", lambda x: sliding.heat_flux(x, 1.0, 1.0, 1.0)),
        ("speed", lambda x: sliding.exit_rise(1.0, x, 1.0, 1.0, TEAK)),
        ("length", lambda x: sliding.exit_rise_of_stress(1.0, 1.0, x, TEAK)),
        ("breadth", lambda x: sliding.largest_friction(1.0, 1.0, 1.0, x, TEAK)),
        ("time", lambda x: sliding.surface_rise(1.0, x, TEAK)),
        ("flux", lambda x: sliding.shared_rise(x, 1.0, TEAK, ICE)),
        ("distance", lambda x: sliding.fall_off(x, 1.0)),
        ("slid", lambda x: sliding.share_into_slider(0.04, x, RUBBER, TEAK)),
        ("density", lambda x: Solid(1.0, x, 1.0)),
        ("pressure", lambda x: sliding.LockedWheel(pressure=x)),
    ],
)
def test_nonsense_is_refused_by_name(field: str, call: Callable[[float], object], bad: float) -> None:
    with pytest.raises(InputError, match=field):
        call(bad)


@pytest.mark.parametrize(
    "call",
    [
        lambda: sliding.heat_flux(1.0, 1.0, 0.0, 1.0),
        lambda: sliding.fall_off(0.1, 0.0),
        lambda: sliding.largest_friction(1.0, 0.0, 1.0, 1.0, ICE),
        lambda: sliding.distance_of_fall_off(1.1, 1.0),
        lambda: sliding.share_into_slider(1.0, 0.5, RUBBER, TEAK),
        lambda: sliding.solid("rubbr"),
    ],
)
def test_limits_are_kept(call: Callable[[], object]) -> None:
    with pytest.raises(InputError):
        call()
