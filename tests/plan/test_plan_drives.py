"""Drives and places that a plan compares: within limits, spread out, refused with one clear error."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.plan.drives import candidate_drives, spread_points
from tyrefem.plan.places import with_candidate_sensors
from tyrefem.quantity import parse

pytestmark = pytest.mark.fast
COARSE = {"mesh.size": "12 mm", "mesh.element": "P1"}


def planned(plan: dict[str, Any], name: str = "hidden-effect") -> tf.Study:
    return tf.study(name, COARSE).replace({"plan": plan})


def test_drives_lie_within_the_limits_and_reach_their_corners() -> None:
    limits = {"drive.speed": ["10 mph", "30 mph"], "drive.pressure": ["80 psi", "100 psi"]}
    drives = candidate_drives(planned({"limits": limits, "drives": 6}))
    assert len(drives) == 6
    assert drives[0].changes == {"speed": "20 mph", "pressure": "90 psi"}
    corners = {(drive.changes["speed"], drive.changes["pressure"]) for drive in drives[1:5]}
    assert corners == {(speed, pressure) for speed in ("10 mph", "30 mph") for pressure in ("80 psi", "100 psi")}
    assert {drive.duration for drive in drives} == {1500.0}


def test_without_limits_the_study_s_drive_is_varied() -> None:
    drives = candidate_drives(planned({}))
    assert [set(drive.changes) for drive in drives] == [{"speed", "load", "pressure"}] * 12
    assert drives[0].name == "speed 20 mph, load 2700 lbf, pressure 83 psi"
    speeds = [parse(drive.changes["speed"], "m/s") / parse("20 mph", "m/s") for drive in drives]
    assert (min(speeds), max(speeds)) == pytest.approx((0.5, 1.5))


def test_a_phase_that_sets_its_speed_is_varied_by_its_name() -> None:
    phases = [{"name": "out", "speed": "20 mph", "duration": "60 s"}, {"speed": "30 mph", "duration": "60 s"}]
    study = tf.study("hidden-effect", COARSE).replace({"drive.phases": phases, "measured": []})
    assert set(candidate_drives(study)[0].changes) == {"phases.out.speed", "load", "pressure"}


def test_the_factor_on_a_phase_s_speed_is_that_of_this_phase() -> None:
    speeds = {"1": "20 mph", "phase 2": "40 mph"}
    phases = [{"name": name, "speed": speed, "duration": "60 s"} for name, speed in speeds.items()]
    limits = {"drive.phases.1.speed": ["10 mph", "30 mph"], "drive.phases.phase 2.speed": ["40 mph", "50 mph"]}
    study = tf.study("hidden-effect", COARSE).replace({"drive.phases": phases, "measured": [], "plan.limits": limits})
    ratios = {drive.name: drive.ratios["phases.phase 2.speed"] for drive in candidate_drives(study)}
    assert ratios["phase 1 speed 10 mph, phase 2 speed 50 mph"] == pytest.approx(1.25)
    assert ratios["phase 1 speed 30 mph, phase 2 speed 40 mph"] == pytest.approx(1.0)


def test_longer_runs_cost_more_with_a_cost_per_hour() -> None:
    limits = {"drive.phases.rolling.duration": ["600 s", "4200 s"]}
    drives = candidate_drives(planned({"limits": limits, "drives": 3, "run_cost": 2.0, "hour_cost": 5.0}))
    costs = {drive.duration: drive.cost for drive in drives}
    assert costs == pytest.approx({1200.0: 2 + 5 / 3, 3000.0: 2 + 25 / 6, 4800.0: 2 + 20 / 3})


@pytest.mark.parametrize(
    ("plan", "words"),
    [
        ({"limits": {"drive.speed": ["30 mph", "10 mph"]}}, "limit 30 mph is not below the upper limit 10 mph"),
        ({"limits": {"drive.speed": ["30 mph", "30 mph"]}}, "is not below"),
        ({"limits": {"drive.speed": "30 mph"}}, "must be a lower and an upper limit"),
        ({"limits": {"drive.speed": ["10 kN", "30 kN"]}}, r"plan\.limits\.drive\.speed: 'kN' is not a unit"),
        ({"limits": {"drive.sped": ["1 m/s", "2 m/s"]}}, r"'drive\.sped' is no quantity.*did you mean 'drive\.speed'"),
        ({"limits": {"drive": {"speed": ["1 m/s", "2 m/s"]}}}, r"plan\.limits\.drive: write the dotted name in quotes"),
        ({"limits": {"mesh.size": ["1 mm", "2 mm"]}}, r"'mesh\.size' is no quantity of the drive"),
        ({"limit": {}}, "unknown key 'limit'; did you mean 'limits'"),
        ({"run_cost": 0}, r"plan\.run_cost: 0 is out of range"),
        ({"runs_most": 0}, r"plan\.runs_most"),
        ({"sensors": {"new": {"s": "20 mm"}}}, r"plan\.sensors\.new\.depth"),
    ],
)
def test_a_wrong_table_is_one_error(plan: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        planned(plan)


def test_limits_of_a_load_and_a_deflection_exclude_each_other() -> None:
    limits = {"drive.load": ["8 kN", "12 kN"], "drive.deflection": ["15 mm", "20 mm"]}
    with pytest.raises(InputError, match=r"plan\.limits\.drive\.deflection: 'drive\.load' sets it too"):
        candidate_drives(planned({"limits": limits}))


def test_a_stated_drive_that_cannot_run_is_refused() -> None:
    # A phase name that is not there, a speed above the fastest one.
    wrong = planned({"limits": {"drive.phases.roling.speed": ["10 mph", "20 mph"]}})
    with pytest.raises(
        InputError,
        match=r"plan\.limits\.drive\.phases\.roling\.speed: the drive has no phase 'roling'; did you mean 'rolling'",
    ):
        candidate_drives(wrong)
    drive = {"speed": "20 mph", "load": "2700 lbf", "pressure": "83 psi", "ambient": "25 degC", "duration": "900 s"}
    with pytest.raises(InputError, match="it has no phases, so name the quantity alone"):
        candidate_drives(wrong.replace({"drive": drive, "measured": []}))
    fast = planned({"limits": {"drive.speed": ["10 m/s", "500 m/s"]}})
    with pytest.raises(InputError, match=r"with speed 500 m/s cannot run: .*state narrower limits"):
        candidate_drives(fast)
    short = planned({"limits": {"drive.phases.rolling.duration": ["1 s", "2 s"]}}).replace(
        {"drive.phases": [{"name": "rolling", "duration": "9 s"}]}
    )
    with pytest.raises(InputError, match="it must last at least 10 s"):
        candidate_drives(short)


def test_points_are_distinct_and_spread() -> None:
    for dimensions, count in ((1, 4), (2, 9), (3, 12), (6, 30)):
        points = spread_points(dimensions, count)
        assert points.shape == (count, dimensions)
        assert len({tuple(point) for point in points}) == count
        assert points.min() >= 0.0
        assert points.max() <= 1.0
    corners = np.abs(spread_points(3, 9)[1:] - 0.5)
    assert (corners == 0.5).all()


def test_places_are_in_the_rubber_and_named_once() -> None:
    study, places = with_candidate_sensors(planned({}), tf.study("hidden-effect").sensors)
    assert len(places) == 21
    assert {place.name for place in places} <= set(study.sensors)
    assert len(study.sensors) == 21 + len(tf.study("hidden-effect").sensors)


def test_stated_places_and_sensors_without_readings_are_candidates() -> None:
    stated = planned({"sensors": {"new": {"s": "20 mm", "depth": "3 mm"}}})
    study, places = with_candidate_sensors(stated, {"crown-inner"})
    names = {place.name for place in places}
    assert "new" in names
    assert names - {"new"} == set(stated.sensors) - {"crown-inner"}
    assert study.sensors["new"].s == pytest.approx(0.02)


def test_a_place_off_the_section_or_a_name_in_use_is_refused() -> None:
    unused = planned({"sensors": {"new": {"s": "900 mm", "depth": "3 mm"}}, "sensors_most": 0})
    with pytest.raises(InputError, match=r"plan\.sensors\.new: s = 900\.0 mm is off the section"):
        with_candidate_sensors(unused, ())
    off = planned({"sensors": {"new": {"s": "900 mm", "depth": "3 mm"}}})
    with pytest.raises(InputError, match=r"plan\.sensors\.new: s = 900\.0 mm is off the section"):
        with_candidate_sensors(off, ())
    taken = planned({"sensors": {"crown-inner": {"s": "20 mm", "depth": "3 mm"}}})
    with pytest.raises(InputError, match="give the further sensor another name"):
        with_candidate_sensors(taken, ())
    assert with_candidate_sensors(planned({"sensors_most": 0}), ())[1] == ()


def test_limits_count_as_they_are_written() -> None:
    """A space before the unit may be left out; rounded, a corner might lie beyond what the rig can do."""
    limits = {"drive.speed": ["10mph", "30mph"], "drive.load": ["12009.6 N", "12345.4 N"]}
    drives = candidate_drives(planned({"limits": limits, "drives": 5}))
    assert drives[0].changes == {"speed": "20 mph", "load": "1.218e+04 N"}
    corners = {(drive.changes["speed"], drive.changes["load"]) for drive in drives[1:]}
    assert corners == {(speed, load) for speed in limits["drive.speed"] for load in limits["drive.load"]}
