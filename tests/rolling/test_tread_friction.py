"""Rolling takes the coefficient of friction from the tread's card."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem import study
from tyrefem.api import Study
from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.press import press
from tyrefem.mechanics.rolling.friction import SLIP
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.steady_rolling import FrictionLaw
from tyrefem.mechanics.rolling.wheel_on_road import FRICTION, tread_friction, wheel_on_road

COARSE = {"mesh.size": "16 mm", "mechanics.motion": "linear"}


SAVKOOR = {
    "law": "savkoor", "coefficient": 1.2, "standstill": 0.8, "peak_speed": "0.5 m/s", "width": 0.4, "at": "30 degC",
    "decade": "20 K", "source": "estimate: a test",
}  # fmt: skip


def with_law(law: dict[str, object]) -> Study:
    return study(
        "passenger-205-55r16", COARSE | {"materials.tread": {"base": "rubber-tread-passenger", "friction": law}}
    )


def test_the_card_of_the_region_on_the_road_decides() -> None:
    pressed = press(with_law(SAVKOOR))
    law = tread_friction(pressed)
    assert callable(law)
    card, temperature = pressed.study.materials["tread"].friction, pressed.study.card.drive.initial
    speeds, pressures = np.array([0.0, 0.1, 3.0]), np.array([1e5, 3e5, 6e5])
    assert law(speeds, pressures) == pytest.approx(card(speeds, pressures, temperature))


def test_a_constant_coefficient_is_a_number() -> None:
    assert tread_friction(press(study("passenger-205-55r16", COARSE))) == 1.0


def test_friction_over_sliding_speed_settles() -> None:
    wheel = wheel_on_road(with_law(SAVKOOR), load=4000.0)
    state = wheel.roll(RollingMotion(0.1, speed=wheel.speed), {"torque": 0.0}, 54, wheel.free(54))
    sliding = state.contact.states == SLIP
    law = wheel.rolling.friction(state.sliding_speed.ravel(), state.pressure.ravel())
    traction = np.hypot(*state.contact.forces[:, 1:].T)
    assert sliding.sum() > 20
    used = traction[sliding] / state.contact.forces[sliding, 0]
    weights = state.contact.forces[sliding, 0]
    assert np.average(np.abs(used - law[sliding]), weights=weights) < 0.01
    assert 0.8 * 0.999 < np.average(used, weights=weights) < 1.2


def test_without_the_table_it_is_the_estimate() -> None:
    pressed = press(study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "mechanics.motion": "linear"}))
    assert tread_friction(pressed) == FRICTION


@pytest.mark.parametrize("law", [lambda v, p: np.nan * v, lambda v, p: -0.5 + 0 * v, lambda v, p: np.ones(3)])
def test_a_law_that_gives_no_coefficient_is_one_clear_error(law: FrictionLaw) -> None:
    with pytest.raises(InputError, match="must give a coefficient of at least 0") as caught:
        study("nasa-22x5.5-8pr", COARSE).roll(slip_angle=0.02, friction=law)
    assert caught.value.field == "friction"


def test_a_law_may_give_a_single_number() -> None:
    """It ended in a traceback."""
    tyre = study("nasa-22x5.5-8pr", COARSE)
    constant, law = (tyre.roll(slip_angle=0.02, friction=friction) for friction in (0.5, lambda v, p: 0.5))
    assert law.state.force == pytest.approx(constant.state.force, rel=1e-3, abs=1.0)
