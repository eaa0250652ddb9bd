"""The state of a wheel that rolls with friction, as a phase of a drive gives it."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.inputs.drive import Phase
from tyrefem.inputs.loading import LoadCase
from tyrefem.inputs.wheel_state import WheelState, wheel_state
from tyrefem.materials.road_friction import RoadFriction
from tyrefem.mechanics.rolling.rolled_footprint import SLOWEST, _speed
from tyrefem.mechanics.solved_cases import changes_cycle

pytestmark = pytest.mark.fast

FLAT = {"coefficient": 1.0, "source": "test"}
LOADED = {"load": "3 kN", "pressure": "2 bar", "duration": "1 s"}


@pytest.mark.parametrize(
    ("speed", "slips"),
    [
        ({"from": "40 mph", "to": "0 mph"}, {"slip_ratio": "20 %"}),
        ({"from": "0 mph", "to": "40 mph"}, {"slip_ratio": "-5 %"}),
        ({"from": "40 mph", "to": "0 mph"}, {"slip_angle": "3 deg"}),
        ({"from": "90 mph", "to": "80 km/h"}, {"slip_ratio": "10 %"}),
        ({"from": "41 mph", "to": "3 mph"}, {"slip_ratio": "7 %", "slip_angle": "3 deg"}),
    ],
)
def test_the_same_slip_is_the_same_state_at_every_speed(speed: dict[str, str], slips: dict[str, str]) -> None:
    """A wheel that braked to rest ended without slip; rounding made more states, each of them solved."""
    phase = Phase.check({**LOADED, "speed": speed, **slips})
    (state,) = {wheel_state(phase, fraction) for fraction in np.linspace(0, 1, 9).tolist()}
    ratio = 0.0 if phase.slip_ratio is None else phase.slip_ratio.start
    assert (state.slip or 0.0) == pytest.approx(-ratio)
    assert state.forward == pytest.approx(math.cos(state.slip_angle) * (1 - ratio))


def test_braking_to_rest_with_one_slip_is_one_state() -> None:
    changes = {"mechanics.strain": "fem", "boundaries.sliding": "rolling", "materials.tread": "rubber-tread-passenger"}
    braking = {"drive.speed": {"from": "40 mph", "to": "0 mph"}, "drive.slip_ratio": 0.1}
    assert not changes_cycle(tf.study("nasa-22x5.5-8pr", {**changes, **braking}), 0)
    turning = {**changes, **braking, "mechanics.rolling": True}
    assert changes_cycle(tf.study("nasa-22x5.5-8pr", turning), 0)


def test_a_slip_speed_is_another_slip_at_another_speed() -> None:
    phase = Phase.check({**LOADED, "speed": {"from": "10 m/s", "to": "20 m/s"}, "slip_speed": "1 m/s"})
    assert wheel_state(phase, 0.0).slip == pytest.approx(-0.1)
    assert wheel_state(phase, 1.0).slip == pytest.approx(-0.05)
    assert wheel_state(phase, 1.0).forward == pytest.approx(0.95)


@pytest.mark.parametrize("ends", [("from", "to"), ("to", "from")])
def test_a_wheel_that_is_locked_at_rest_is_refused(ends: tuple[str, str]) -> None:
    """A ratio of 100 % where the vehicle stands divided by zero in the rolling tyre."""
    rest, moving = ends
    changes = {
        "mechanics.strain": "fem", "boundaries.sliding": "rolling", "materials.tread": "rubber-tread-passenger",
        "drive.speed": {rest: "0 mph", moving: "40 mph"}, "drive.slip_ratio": {rest: "100 %", moving: "0 %"},
    }  # fmt: skip
    with pytest.raises(InputError, match="a locked wheel does not roll") as caught:
        tf.study("nasa-22x5.5-8pr", changes)
    assert str(caught.value.field).endswith("slip_ratio")


def test_friction_at_rest_is_that_of_slow_rolling() -> None:
    """A law over the sliding speed was taken at 1 m/s where the vehicle stands, at 0.1 m/s just after."""
    savkoor = {
        "law": "savkoor", "coefficient": 1.2, "standstill": 0.8, "peak_speed": "1 m/s", "width": 0.5, "source": "test",
    }  # fmt: skip
    case = LoadCase(3e3, 0.0, 2e5, 0.28, wheel=WheelState(slip=-0.1, forward=0.9))
    for law, speed in ((RoadFriction.check(savkoor), SLOWEST), (RoadFriction.check(FLAT), 1.0)):
        study: Any = SimpleNamespace(materials={"tread": SimpleNamespace(friction=law)})
        assert _speed(study, case) == speed
        assert _speed(study, replace(case, speed=9.0)) == pytest.approx(10.0)
