"""A locked wheel: what Roberts says of a skidding car, and equation 13 as the limit of its friction."""

from __future__ import annotations

import pytest

from tyrefem.boundaries.friction_names import MILD, SEVERE, LockedWheel
from tyrefem.errors import InputError

KMH = 1 / 3.6


@pytest.mark.parametrize("speed", [50, 60, 80, 100, 130])
def test_contact_is_more_than_200_K_hotter_above_50_km_h(speed: float) -> None:
    """Roberts: "at speeds greater than 50 km per hour the temperature rise [...] can be in excess of 200"."""
    assert LockedWheel().mean_rise(speed * KMH) > 200
    assert LockedWheel().exit_rise(speed * KMH) > 200


def test_the_200_K_hang_on_the_estimates() -> None:
    assert LockedWheel().mean_rise(30 * KMH) < 200
    assert MILD.exit_rise(50 * KMH) < 200 < MILD.exit_rise(130 * KMH)
    assert MILD.mean_rise(130 * KMH) < 200 < SEVERE.mean_rise(20 * KMH)


def test_decomposition_caps_friction_so_that_the_exit_edge_stays_at_its_rise() -> None:
    car = LockedWheel()
    limit = car.decomposition_speed()
    assert car.uncapped_exit_rise(limit) == pytest.approx(car.decomposition_rise, rel=1e-12)
    assert car.friction_at(0.99 * limit) == car.friction
    assert car.friction_at(4 * limit) == pytest.approx(car.friction / 2, rel=1e-12)
    capped = LockedWheel(friction=car.friction_at(4 * limit))
    assert capped.uncapped_exit_rise(4 * limit) == pytest.approx(car.exit_rise(4 * limit), rel=1e-12)


def test_a_wheel_that_does_not_rub_stays_cold_and_never_decomposes() -> None:
    smooth = LockedWheel(friction=0.0)
    assert smooth.exit_rise(50.0) == 0.0
    with pytest.raises(InputError, match="friction"):
        smooth.decomposition_speed()
