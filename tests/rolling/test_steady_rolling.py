"""A rolling tyre with friction: limits, symmetry, power."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.road import Road
from tyrefem.mechanics.rolling.rolled import RolledTyre
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.steady_rolling import RollingLoads, SteadyRolling

HARMONICS, LOAD = 54, 3000.0
GUESS = (0.02, 0.314)


@pytest.fixture(scope="module")
def flat() -> Pressing:
    return Pressing(PlainTyre().state(along=12))


@pytest.fixture(scope="module")
def rolling(flat: Pressing) -> SteadyRolling:
    return SteadyRolling(flat, friction=1.0)


@pytest.fixture(scope="module")
def free(rolling: SteadyRolling) -> RolledTyre:
    return rolling.roll(RollingMotion(speed=20.0), RollingLoads(load=LOAD, torque=0.0), HARMONICS, guess=GUESS)


@pytest.mark.parametrize("drum", [math.inf, 1.7])
def test_without_friction_it_is_the_frictionless_footprint(drum: float) -> None:
    pressing = Pressing(PlainTyre().state(along=12), Road(drum))
    footprint = pressing.at_deflection(0.02, HARMONICS)
    tyre = SteadyRolling(pressing, friction=0.0)
    rolled = tyre.roll(RollingMotion(0.05), RollingLoads(deflection=0.02, travel=0.31), HARMONICS)
    assert rolled.force[2] == pytest.approx(footprint.load, rel=1e-9)
    assert np.abs(rolled.contact.forces[:, 1:]).max() == 0.0
    middle, across = -rolled.grid.first, len(footprint.grid.tread.nodes)
    width = len(rolled.grid.influence.places[0]) - across
    ours = rolled.pressure[middle : middle + rolled.grid.last + 1, width:]
    assert ours == pytest.approx(footprint.pressure[: len(ours)], abs=1e-8 * footprint.pressure.max())
    patch = rolled.patch
    for name in ("length", "width", "area", "mean_pressure"):
        assert getattr(patch, name) == pytest.approx(getattr(footprint, name), rel=1e-6)
    assert patch.peak_pressure == pytest.approx(footprint.pressure.max(), rel=1e-8)


def test_free_rolling_has_no_force_to_speak_of(free: RolledTyre) -> None:
    assert free.force[2] == pytest.approx(LOAD, rel=1e-8)
    assert abs(free.torque) < 1e-6
    assert np.abs(free.force[:2]).max() < 1e-3 * LOAD
    assert free.sliding_share < 0.1
    assert free.loaded_radius < free.travel < free.reach
    # Rounding over rounding is no trail.
    assert math.isnan(free.pneumatic_trail)


def test_signs_are_those_of_iso_8855(rolling: SteadyRolling, free: RolledTyre) -> None:
    left = rolling.roll(RollingMotion(math.radians(1.0)), RollingLoads(load=LOAD, torque=0.0), HARMONICS, free)
    assert left.force[1] < -100
    assert left.moment[2] > 1
    # The side force acts as far behind the centre as the forces of the points have their moment.
    x, y = left.places[:2]
    along, side = left.vectors[:, 0], left.vectors[:, 2]
    assert left.pneumatic_trail == pytest.approx((y * along - x * side).sum() / side.sum(), rel=1e-9)
    assert 0 < left.pneumatic_trail < left.patch.length / 2
    right = rolling.roll(RollingMotion(-math.radians(1.0)), RollingLoads(load=LOAD, torque=0.0), HARMONICS, free)
    assert right.force[1] == pytest.approx(-left.force[1], rel=1e-6)
    driven = rolling.roll(RollingMotion(), RollingLoads(load=LOAD, travel=free.travel / 1.01), HARMONICS, free)
    assert driven.force[0] > 100
    assert driven.torque > 0
    braked = rolling.roll(RollingMotion(), RollingLoads(load=LOAD, force=-500.0), HARMONICS, free)
    assert braked.travel > free.travel
    assert braked.torque < 0
    assert braked.force[0] == pytest.approx(-500.0)
    turned = rolling.roll(RollingMotion(turn_slip=0.1), RollingLoads(load=LOAD, torque=0.0), HARMONICS, free)
    assert turned.moment[2] < -1


def test_a_leaning_wheel_is_pushed_to_the_side_it_leans_to(flat: Pressing, rolling: SteadyRolling) -> None:
    tyre = SteadyRolling(flat, math.radians(3.0), 1.0, rolling.points)
    rolled = tyre.roll(RollingMotion(), RollingLoads(load=LOAD, torque=0.0), HARMONICS, guess=GUESS)
    assert rolled.force[1] > 30


def test_far_slip_is_coulomb_friction(rolling: SteadyRolling, free: RolledTyre) -> None:
    rolled = rolling.roll(RollingMotion(math.radians(20.0)), RollingLoads(load=LOAD, torque=0.0), HARMONICS, free)
    assert rolled.sliding_share == pytest.approx(1.0, abs=1e-12)
    assert np.hypot(*rolled.force[:2]) == pytest.approx(LOAD, rel=0.005)
    assert np.linalg.norm(rolled.traction, axis=-1) == pytest.approx(rolled.pressure, rel=1e-6, abs=1.0)


@pytest.mark.parametrize("drum", [math.inf, 1.7])
def test_a_half_section_is_the_full_one(drum: float) -> None:
    results = []
    for half in (True, False):
        tyre = SteadyRolling(Pressing(PlainTyre(half=half).state(along=8), Road(drum)), math.radians(2.0), 0.8)
        motion = RollingMotion(math.radians(1.5), turn_slip=0.05)
        results.append(tyre.roll(motion, RollingLoads(load=LOAD, torque=-100.0), 30, guess=GUESS))
    half, full = results
    assert half.force == pytest.approx(full.force, rel=1e-7)
    assert half.moment == pytest.approx(full.moment, rel=1e-6)
    assert np.abs(half.pressure - full.pressure).max() < 1e-6 * full.pressure.max()


CASES = [
    (math.inf, 0.0, 1.0, 0.0, 0.0), (math.inf, 0.0, 3.0, 0.0, 0.0), (math.inf, 0.0, 8.0, 0.0, 0.0),
    (math.inf, 2.0, 2.0, 0.0, 0.0), (math.inf, -4.0, 4.0, 0.0, 0.0), (math.inf, 0.0, 0.0, 300.0, 0.0),
    (math.inf, 0.0, 2.0, -400.0, 0.0), (math.inf, 3.0, 6.0, 200.0, 0.02), (1.7, 0.0, 3.0, 0.0, 0.0),
    (1.7, 2.0, 4.0, -300.0, 0.0),
]  # fmt: skip


@pytest.mark.parametrize(("drum", "camber", "slip_angle", "torque", "turn_slip"), CASES)
def test_the_axle_puts_in_what_friction_takes_out(
    drum: float, camber: float, slip_angle: float, torque: float, turn_slip: float
) -> None:
    tyre = SteadyRolling(Pressing(PlainTyre().state(along=8), Road(drum)), math.radians(camber), 1.0)
    motion = RollingMotion(math.radians(slip_angle), turn_slip, speed=20.0)
    rolled = tyre.roll(motion, RollingLoads(load=LOAD, torque=torque), 120, guess=GUESS)
    assert rolled.friction_power > 10
    assert abs(rolled.balance) < 0.01
    assert rolled.power_by_ring.min() > -0.01 * rolled.friction_power


def test_friction_may_fall_with_sliding_speed(flat: Pressing, rolling: SteadyRolling) -> None:
    def law(speed: np.ndarray, pressure: np.ndarray) -> np.ndarray:
        return 0.6 + 0.4 / (1 + speed / 2.0) + 0 * pressure

    tyre = SteadyRolling(flat, 0.0, law, rolling.points)
    rolled = tyre.roll(
        RollingMotion(math.radians(10.0), speed=20.0), RollingLoads(load=LOAD, torque=0.0), 36, guess=GUESS
    )
    slides = rolled.states == 2
    limit = law(rolled.sliding_speed, rolled.pressure) * rolled.pressure
    assert np.linalg.norm(rolled.traction, axis=-1)[slides] == pytest.approx(limit[slides], rel=1e-4)


def test_impossible_values_are_refused(flat: Pressing) -> None:
    with pytest.raises(InputError, match="slip angle of 60 deg"):
        RollingMotion(math.radians(60.0))
    with pytest.raises(InputError, match="exactly one of 'load'"):
        RollingLoads(torque=0.0)
    with pytest.raises(InputError, match="at least 0"):
        SteadyRolling(flat, friction=-0.1)
