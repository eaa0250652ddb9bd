"""Rolling from the shape of a footprint: without friction it is that footprint."""

from __future__ import annotations

import functools
import math

import numpy as np
import pytest

from tyrefem.mechanics.footprint.compliance import TreadCompliance
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.example_tyre import PlainTyre
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.harmonic_balance import Balance
from tyrefem.mechanics.footprint.road import Road
from tyrefem.mechanics.rolling.lossy_harmonics import LossyHarmonics
from tyrefem.mechanics.rolling.pressed_shape import PressedShape
from tyrefem.mechanics.rolling.rolled import RolledTyre
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.steady_rolling import RollingLoads, SteadyRolling
from tyrefem.mechanics.rolling.tread_influence import TreadInfluence

DEFLECTION, HARMONICS = 0.006, 24


@functools.lru_cache(2)
def deep(drum: float) -> tuple[Pressing, Footprint]:
    """A footprint with 120 harmonics at 15 mm."""
    pressing = pressed(drum)
    return pressing, Balance(pressing, 12, 120, tolerance=1e-4).at_deflection(0.015)


def pressed(drum: float) -> Pressing:
    return Pressing(PlainTyre().state(along=6), Road(drum))


def rolled(pressing: Pressing, footprint: Footprint, friction: float = 0.0) -> RolledTyre:
    tyre = SteadyRolling(pressing, friction=friction, shape=PressedShape(footprint))
    loads = RollingLoads(deflection=DEFLECTION, travel=footprint.rolling_radius)
    return tyre.roll(RollingMotion(), loads, HARMONICS)


def pressure_of(state: RolledTyre, footprint: Footprint) -> tuple[np.ndarray, np.ndarray]:
    """Contact pressure of one side of the wheel and of the tread, as rolled and as pressed, Pa."""
    middle, across = -state.grid.first, footprint.pressure.shape[1]
    ours = state.pressure[middle:, -across:]
    count = min(len(ours), len(footprint.pressure))
    return ours[:count], footprint.pressure[:count]


@pytest.mark.parametrize("drum", [math.inf, 1.0])
def test_small_motion_adds_nothing(drum: float) -> None:
    pressing = pressed(drum)
    footprint = pressing.at_deflection(DEFLECTION, HARMONICS)
    state = rolled(pressing, footprint)
    assert np.abs(state.grid.offsets).max() < 1e-12
    ours, theirs = pressure_of(state, footprint)
    assert ours == pytest.approx(theirs, abs=1e-9 * theirs.max())


@pytest.mark.parametrize("drum", [math.inf, 1.0])
def test_without_friction_it_is_the_footprint_in_large_motion(drum: float) -> None:
    pressing = pressed(drum)
    footprint = Balance(pressing, 12, HARMONICS, tolerance=1e-4).at_deflection(DEFLECTION)
    linear = pressing.at_deflection(DEFLECTION, HARMONICS)
    state = rolled(pressing, footprint)
    assert state.force[2] == pytest.approx(footprint.load, rel=1e-3)
    assert abs(linear.load - footprint.load) > 0.05 * footprint.load
    ours, theirs = pressure_of(state, footprint)
    assert ours == pytest.approx(theirs, abs=5e-3 * theirs.max())


@pytest.mark.parametrize(
    ("drum", "slip_angle", "slip", "torque"),
    [(math.inf, 1.0, None, 0.0), (math.inf, 3.0, None, -100.0), (math.inf, 0.0, -0.01, None),
     (math.inf, 0.0, -0.03, None), (math.inf, 0.0, 0.01, None), (1.0, 1.0, -0.02, None)],
)  # fmt: skip
def test_the_axle_puts_in_what_friction_takes_out(
    drum: float, slip_angle: float, slip: float | None, torque: float | None
) -> None:
    """The shape turns until the forces do no work on it: in a shape that stands still up to 28 % are missing."""
    pressing, footprint = deep(drum)
    tyre = SteadyRolling(pressing, friction=0.8, shape=PressedShape(footprint))
    travel = None if slip is None else footprint.rolling_radius / (1 + slip)
    loads = RollingLoads(load=footprint.load, travel=travel, torque=torque)
    guess = (footprint.deflection, footprint.rolling_radius)
    rolled = tyre.roll(RollingMotion(math.radians(slip_angle), speed=20.0), loads, 120, guess=guess)
    assert rolled.friction_power > 20
    assert abs(rolled.balance) < 0.01
    works = rolled.vectors * rolled.grid.shape_rate(rolled.vectors)
    assert abs(works.sum()) < 1e-5 * float(np.abs(works).sum())
    if slip is not None:
        assert rolled.grid.turn * slip > 0


def test_with_loss_the_rubber_takes_its_share() -> None:
    """d is that without loss: what the rubber loses is the axle's work beside that of friction."""
    pressing, footprint = deep(math.inf)
    state = pressing.state
    lossy = LossyHarmonics(state, angular_speed=60.0, tangents=lambda _: np.full(len(state.bulk), 0.15))
    points, elastic = TreadInfluence(TreadCompliance(lossy)), TreadInfluence(pressing.tread)
    tyre = SteadyRolling(pressing, 0.0, 0.8, points, PressedShape(footprint, elastic))
    loads, guess = RollingLoads(load=footprint.load, torque=0.0), (footprint.deflection, footprint.rolling_radius)
    rolled = tyre.roll(RollingMotion(math.radians(3.0), speed=20.0), loads, 120, guess=guess)
    assert rolled.loss_power > 100
    assert abs(rolled.balance) < 0.015
    free = tyre.roll(RollingMotion(speed=20.0), loads, 120, rolled)
    assert free.loss_power < rolled.loss_power
    assert -free.force[0] * 20.0 == pytest.approx(free.loss_power + free.friction_power, rel=0.05)


def test_a_shape_without_friction_does_not_turn() -> None:
    pressing, footprint = deep(math.inf)
    loads = RollingLoads(deflection=footprint.deflection, travel=footprint.rolling_radius)
    rolled = SteadyRolling(pressing, friction=0.0, shape=PressedShape(footprint)).roll(RollingMotion(), loads, 120)
    assert abs(rolled.grid.turn) < 1e-9


def test_friction_acts_from_that_shape() -> None:
    pressing = pressed(math.inf)
    footprint = Balance(pressing, 12, HARMONICS, tolerance=1e-4).at_deflection(DEFLECTION)
    tyre = SteadyRolling(pressing, friction=0.8, shape=PressedShape(footprint))
    loads = RollingLoads(load=footprint.load, torque=0.0)
    guess = (footprint.deflection, footprint.rolling_radius)
    left = tyre.roll(RollingMotion(0.03), loads, HARMONICS, guess=guess)
    right = tyre.roll(RollingMotion(-0.03), loads, HARMONICS, guess=guess)
    assert left.force[1] < -0.1 * footprint.load
    assert right.force[1] == pytest.approx(-left.force[1], rel=1e-6)
    assert right.moment[2] == pytest.approx(-left.moment[2], rel=1e-6)
    traction, limit = np.hypot(*left.contact.forces[:, 1:].T), 0.8 * left.contact.forces[:, 0]
    assert (traction <= limit + 1e-6).all()
