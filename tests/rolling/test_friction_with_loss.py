"""Friction on a tyre with loss: free rolling as without friction, power balance, half and full section, studies."""

from __future__ import annotations

import functools
import math

import numpy as np
import pytest

from tyrefem import study
from tyrefem.mechanics.footprint.compliance import TreadCompliance
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.road import Road
from tyrefem.mechanics.rolling.free_rolling import LossyTyre, rolling_resistance
from tyrefem.mechanics.rolling.lossy_harmonics import LossyHarmonics
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.steady_rolling import FrictionLaw, RollingLoads, SteadyRolling
from tyrefem.mechanics.rolling.tread_influence import TreadInfluence

LOAD, TANGENT, SPIN = 3000.0, 0.15, 60.0
GUESS = (0.02, 0.314)


@functools.lru_cache(2)
def lossy(half: bool = True) -> LossyHarmonics:
    state = PlainTyre(half=half).state(along=6)
    return LossyHarmonics(state, angular_speed=SPIN, tangents=lambda frequency: np.full(len(state.bulk), TANGENT))


@functools.lru_cache(2)
def points(half: bool = True) -> TreadInfluence:
    return TreadInfluence(TreadCompliance(lossy(half)))


def rolling(
    friction: float | FrictionLaw = 1.0, *, drum: float = math.inf, camber: float = 0.0, half: bool = True
) -> SteadyRolling:
    return SteadyRolling(Pressing(lossy(half).state, Road(drum)), math.radians(camber), friction, points(half))


@pytest.mark.parametrize("drum", [math.inf, 1.7])
def test_without_friction_it_is_free_rolling(drum: float) -> None:
    """The same angles give the same torque and loss; the mean of shifted angles lies near."""
    tyre = LossyTyre(lossy().state, Road(drum), lossy())
    free = tyre.at_deflection(0.02, 180)
    loads = RollingLoads(deflection=0.02, travel=free.rolling_radius)
    rolled = rolling(0.0, drum=drum).roll(RollingMotion(), loads, 180)
    assert rolled.force[2] == pytest.approx(free.load, rel=1e-6)
    assert rolled.torque == pytest.approx(free.torque, rel=1e-5)
    assert rolled.body_loss.energy == pytest.approx(free.dissipated, rel=1e-4)
    resistance = rolling_resistance(tyre, 180, 0.02)
    assert rolled.body_loss.energy / (2 * math.pi * rolled.travel) == pytest.approx(resistance.by_offset, rel=1e-2)
    assert abs(rolled.lost_power / rolled.loss_power - 1) < 0.02


CASES = [
    (math.inf, 0.0, 1.0, 0.0, 0.0), (math.inf, 0.0, 4.0, 0.0, 0.0), (math.inf, 0.0, 2.0, -400.0, 0.0),
    (math.inf, 3.0, 6.0, 200.0, 0.02), (1.7, 2.0, 4.0, -300.0, 0.0),
]  # fmt: skip


@pytest.mark.parametrize(("drum", "camber", "slip_angle", "torque", "turn_slip"), CASES)
def test_the_axle_puts_in_what_friction_and_rubber_take_out(
    drum: float, camber: float, slip_angle: float, torque: float, turn_slip: float
) -> None:
    motion = RollingMotion(math.radians(slip_angle), turn_slip, speed=20.0)
    loads = RollingLoads(load=LOAD, torque=torque)
    rolled = rolling(drum=drum, camber=camber).roll(motion, loads, 270, guess=GUESS)
    assert rolled.friction_power > 100
    assert rolled.loss_power > 100
    assert abs(rolled.balance) < 0.01
    assert rolled.rolling_resistance == pytest.approx(rolled.lost_power / 20.0)


def test_free_rolling_is_held_back_by_loss() -> None:
    """Without torque the road pulls with the lost power over the speed."""
    motion = RollingMotion(speed=20.0)
    rolled = rolling().roll(motion, RollingLoads(load=LOAD, torque=0.0), 80, guess=GUESS)
    assert rolled.force[0] == pytest.approx(-rolled.lost_power / 20.0, rel=1e-9)
    assert -rolled.force[0] * 20.0 > 0.9 * rolled.loss_power > 100


def test_loss_of_the_tread_is_that_of_the_section() -> None:
    """Work of the contact forces = loss by the stiffness of every element, of symmetric and antisymmetric motions."""
    motion = RollingMotion(math.radians(3.0), speed=20.0)
    losses = {}
    for half in (True, False):
        tyre = rolling(camber=2.0, half=half)
        loss = tyre.roll(motion, RollingLoads(load=LOAD, torque=-100.0), 30, guess=GUESS).body_loss
        assert loss.energy == pytest.approx(loss.energy_of_section, rel=1e-5)
        losses[half] = loss.energy
    assert losses[True] == pytest.approx(losses[False], rel=1e-6)


def test_without_loss_nothing_is_lost() -> None:
    tyre = SteadyRolling(Pressing(lossy().state), friction=0.5)
    rolled = tyre.roll(RollingMotion(0.03), RollingLoads(load=LOAD, torque=0.0), 30, guess=GUESS)
    assert rolled.loss_power == 0
    assert rolled.body_loss.energy_of_section == 0


def test_a_law_of_friction_settles_with_loss() -> None:
    def law(speed: np.ndarray, pressure: np.ndarray) -> np.ndarray:
        return 0.6 + 0.4 / (1 + speed / 2.0) + 0 * pressure

    motion = RollingMotion(math.radians(10.0), speed=20.0)
    rolled = rolling(law).roll(motion, RollingLoads(load=LOAD, torque=0.0), 36, guess=GUESS)
    slides = rolled.states == 2
    limit = law(rolled.sliding_speed, rolled.pressure) * rolled.pressure
    assert np.linalg.norm(rolled.traction, axis=-1)[slides] == pytest.approx(limit[slides], rel=1e-4)


def test_studies_that_roll() -> None:
    """With `[mechanics] rolling` the tyre spins and loses; another speed counts."""
    changes = {"mesh.size": "15 mm", "mechanics.strain": "fem", "mechanics.motion": "linear"}
    still = study("nasa-22x5.5-8pr", changes).roll(tolerance=1.0)
    turning = study("nasa-22x5.5-8pr", changes | {"mechanics.rolling": True})
    rolled = turning.roll(tolerance=1.0)
    resistance = turning.press().turning.resistance
    assert still.state.loss_power == 0
    assert rolled.summary()["rolling_resistance_N"] == pytest.approx(resistance.by_loss, rel=0.1)
    assert rolled.state.loss_power == pytest.approx(resistance.by_loss * rolled.wheel.speed, rel=0.1)
    faster = turning.roll(speed=2 * rolled.wheel.speed, tolerance=1.0)
    assert faster.state.loss_power > 1.9 * rolled.state.loss_power
    assert faster.wheel.pressed.tyre.angular_speed > 1.9 * rolled.wheel.pressed.tyre.angular_speed
