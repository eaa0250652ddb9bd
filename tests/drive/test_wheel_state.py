"""The state of a wheel that rolls with friction, as a phase of a drive gives it."""

from __future__ import annotations

import math

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.inputs.drive import Phase
from tyrefem.inputs.wheel_state import wheel_state
from tyrefem.mechanics.solved_cases import changes_cycle

pytestmark = pytest.mark.fast

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
