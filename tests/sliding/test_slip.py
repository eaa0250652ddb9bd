"""Slip of a wheel: its speeds, what the drive accepts, and the friction laws."""

from __future__ import annotations

import math

import pytest

from tyrefem.boundaries import LawOf
from tyrefem.errors import InputError
from tyrefem.inputs.drive import Drive
from tyrefem.inputs.motion import Motion, motion_at

pytestmark = pytest.mark.fast

STEADY = {"speed": "36 km/h", "load": "12 kN", "pressure": "5 bar", "duration": "10 s"}


def drive(**changes):
    return Drive.check({**STEADY, **changes})


def law(name, **numbers):
    return LawOf("sliding", "constant")({"law": name, **numbers})


def friction(sliding, motion):
    return sliding.friction(motion.sliding_speed, motion.rolling_speed)


def test_without_slip_the_tread_passes_at_the_wheel_s_speed():
    motion = motion_at(drive(), 3.0)
    assert (motion.rolling_speed, motion.sliding_speed, motion.slip_ratio) == (motion.speed, 0.0, 0.0)
    assert not drive(slip_ratio=0, slip_angle="0 deg").phases[0].slides


def test_braking_slip_slows_the_tread_and_driving_slip_speeds_it_up():
    braked, driven = (motion_at(drive(slip_ratio=ratio), 0.0) for ratio in ("20 %", -0.2))
    assert (braked.rolling_speed, driven.rolling_speed) == (pytest.approx(8.0), pytest.approx(12.0))
    assert braked.sliding_speed == pytest.approx(driven.sliding_speed) == pytest.approx(2.0)
    assert motion_at(drive(slip_speed="2 m/s"), 0.0).slip_ratio == pytest.approx(0.2)


def test_longitudinal_and_lateral_slip_add_as_vectors():
    motion = motion_at(drive(slip_ratio=0.3, slip_angle="-10 deg"), 0.0)
    along, across = 0.3 * 10 * math.cos(math.radians(10)), 10 * math.sin(math.radians(10))
    assert motion.sliding_speed == pytest.approx(math.hypot(along, across))
    # A locked wheel slides at the vehicle's speed whichever way it points.
    locked = motion_at(drive(slip_ratio=1, slip_angle="30 deg"), 0.0)
    assert (locked.rolling_speed, locked.sliding_speed) == (0.0, pytest.approx(10.0))


def test_a_locked_wheel_is_locked_since_the_first_of_its_phases():
    phases = [
        {"slip_ratio": {"from": 0, "to": 1}},
        {"slip_ratio": 1},
        {"slip_speed": {"from": "36 km/h", "to": "0 m/s"}, "speed": {"from": "36 km/h", "to": "0 m/s"}},
        {"speed": "0 m/s"},
    ]
    skid = drive(phases=phases)
    assert [skid.locked_since(t) for t in (9.999, 10.0, 25.0, 35.0)] == [None, 10.0, 10.0, None]


@pytest.mark.parametrize(
    ("changes", "field", "message"),
    [
        ({"slip_ratio": 0.1, "slip_speed": "1 m/s"}, "slip_speed", "not both"),
        ({"slip_ratio": 1.2}, "slip_ratio", "at most 1"),
        ({"slip_ratio": -1.2}, "slip_ratio", "at least -1"),
        ({"slip_ratio": {"from": 0, "to": "150 %"}}, "slip_ratio.to", "at most 1"),
        ({"slip_angle": "60 deg"}, "slip_angle", "60 deg is out of range: -45 to 45 deg"),
        ({"slip_angle": 4}, "slip_angle", "has no unit"),
        ({"slip_speed": "11 m/s"}, "slip_speed", "more than the wheel's forward speed, 10 m/s"),
        ({"slip_speed": "-11 m/s"}, "slip_speed", "more than the wheel's forward speed"),
        ({"slip_speed": "5 m/s", "speed": {"from": "10 m/s", "to": "2 m/s"}}, "slip_speed", "forward speed"),
        ({"slip_ratio": 0.1, "speed": "0 m/s"}, "slip_ratio", "needs a speed"),
        ({"slip_angle": "4 deg", "speed": "0 m/s"}, "slip_angle", "needs a speed"),
        ({"slip_ration": 0.1}, None, "did you mean 'slip_ratio'"),
    ],
)
def test_slip_that_cannot_be(changes, field, message):
    with pytest.raises(InputError, match=message) as refused:
        drive(**changes)
    assert field is None or refused.value.field.endswith(field)


def test_a_phase_s_slip_speed_replaces_the_drive_s_slip_ratio():
    mixed = drive(slip_ratio=0.1, phases=[{}, {"slip_speed": "3 m/s"}])
    assert [motion_at(mixed, t).slip_ratio for t in (5.0, 15.0)] == pytest.approx([0.1, 0.3])


def test_brush_friction_grows_from_nothing_to_that_of_a_sliding_block():
    """F = 3 c s at small slip s (c = mu/full_slip), mu where the whole footprint slides; in between 1 - (1 - x)^3."""
    brush = law("brush", coefficient=0.9, full_slip=0.2)

    def at(slip: float) -> float:
        return friction(brush, Motion(10.0 * (1 + slip), 10.0 * slip))

    assert at(1e-6) == pytest.approx(3 * 0.9 / 0.2 * 1e-6, rel=1e-4)
    assert at(0.1) == pytest.approx(0.9 * (1 - 0.5**3))
    assert at(0.2) == pytest.approx(0.9)
    assert at(5.0) == friction(brush, Motion(10.0, 10.0)) == 0.9
    assert friction(brush, Motion(10.0)) == 0.0
    assert friction(law("constant", coefficient=0.9), Motion(10.0, 0.1)) == 0.9


def test_the_road_is_that_of_the_road_law_unless_given():
    half_space = LawOf("road", "constant")({"law": "half-space", "road_conductivity": "0.75 W/m/K"})
    constant = LawOf("road", "constant")({"law": "constant"})
    assert law("constant").road_effusivity(constant) == pytest.approx(math.sqrt(1.5 * 2e6))
    assert law("constant").road_effusivity(half_space) == pytest.approx(math.sqrt(0.75 * 2e6))
    ice = law("constant", road_conductivity="2.2 W/m/K", road_heat_capacity="1.914e6 J/m**3/K")
    assert ice.road_effusivity(half_space) == pytest.approx(math.sqrt(2.2 * 1.914e6))


def test_a_wheel_turns_once_in_the_length_of_its_rolling_circle():
    rolling, braked = Motion(10.0, rolling_radius=0.25), Motion(10.0, 2.0, rolling_radius=0.25)
    assert rolling.revolutions_per_second * 2 * math.pi * 0.25 == pytest.approx(10.0, rel=1e-15)
    assert braked.revolutions_per_second == pytest.approx(0.8 * rolling.revolutions_per_second, rel=1e-15)
    assert Motion(10.0, 10.0, rolling_radius=0.25).revolutions_per_second == 0.0
    # Without a load case nobody knows the rolling radius: no number is better than a wrong one.
    assert math.isnan(motion_at(drive(), 3.0).revolutions_per_second)
