"""The drive: phases, ramps, defaults and what is refused."""

from __future__ import annotations

import pytest

import tyrefem
from tyrefem.errors import InputError
from tyrefem.inputs.drive import Drive

pytestmark = pytest.mark.fast

STEADY = {"speed": "36 km/h", "load": "12 kN", "pressure": "5 bar", "duration": "600 s"}


def test_one_steady_phase():
    drive = Drive.check(STEADY)
    assert [phase.name for phase in drive.phases] == ["rolling"]
    assert (drive.end, drive.initial) == (600.0, 25.0)
    assert drive.value("speed", 300.0) == pytest.approx(10.0)
    assert drive.value("road_temperature", 300.0) is None
    assert not drive.phases[0].changes_load


def schedule(**defaults):
    phases = [
        {"name": "start", "speed": {"from": "0 m/s", "to": "10 m/s"}, "duration": "10 s"},
        {"speed": "10 m/s", "load": {"from": "12 kN", "to": "0 N"}},
        {"name": "stop", "speed": "0 m/s", "ambient": {"from": "25 degC", "to": "5 degC"}},
    ]
    return Drive.check({**STEADY, "duration": "100 s", **defaults, "phases": phases})


def test_phases_take_what_they_do_not_say_from_the_drive():
    drive = schedule(ambient="20 degC")
    assert [phase.name for phase in drive.phases] == ["start", "phase 2", "stop"]
    assert drive.starts == (0.0, 10.0, 110.0)
    assert drive.end == 210.0
    assert drive.initial == 20.0
    assert [phase.load.end for phase in drive.phases] == [12e3, 0.0, 12e3]
    assert [phase.changes_load for phase in drive.phases] == [False, True, False]


def test_a_border_belongs_to_the_phase_that_begins():
    drive = schedule()
    assert drive.locate(0.0) == (0, 0.0)
    assert drive.locate(10.0) == (1, 0.0)
    assert drive.locate(110.0) == (2, 0.0)
    assert drive.locate(210.0) == (2, 1.0)
    assert drive.locate(500.0) == (2, 1.0)
    assert drive.locate(-1.0) == (0, 0.0)


def test_ramps_are_linear_in_time():
    drive = schedule()
    assert [drive.value("speed", t) for t in (0.0, 2.5, 9.999, 10.0)] == pytest.approx([0.0, 2.5, 9.999, 10.0])
    assert drive.value("load", 35.0) == pytest.approx(9e3)
    assert drive.value("ambient", 160.0) == pytest.approx(15.0)


def test_the_start_is_the_first_ambient_unless_given():
    assert schedule(ambient={"from": "30 degC", "to": "20 degC"}).initial == 30.0
    assert schedule(initial="60 degC").initial == 60.0


def test_a_phase_s_deflection_replaces_the_drive_s_load():
    drive = Drive.check({**STEADY, "phases": [{"deflection": "30 mm"}, {"speed": "0 m/s"}]})
    assert drive.phases[0].load is None
    assert drive.phases[0].deflection.start == pytest.approx(0.03)
    assert drive.phases[1].load.start == pytest.approx(12e3)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"deflection": "30 mm"}, "exactly one of 'load' and 'deflection'"),
        ({"sped": "3 m/s"}, "did you mean 'speed'"),
        ({"speed": {"from": "0 m/s"}}, "needs both 'from' and 'to'"),
        ({"speed": {"from": "0 m/s", "upto": "1 m/s"}}, "unknown key 'upto'"),
        ({"speed": {"from": "0 m/s", "to": "1 kg"}}, "to: 'kg' is not a unit"),
        ({"speed": "-1 m/s"}, "at least 0"),
        ({"speed": "500 m/s"}, "at most 400"),
        ({"duration": "0 s"}, "at least 1e-06 s"),
        ({"duration": "1e-12 s"}, "at least 1e-06 s"),
        ({"ambient": "-300 degC"}, "absolute zero"),
        ({"initial": "0 K"}, "initial: '0 K' is out of range: must be more than -273.15 degC"),
        ({"phases": []}, "at least one phase"),
        ({"phases": [{"name": "a"}, {"name": "a"}]}, "two phases are named 'a'"),
        ({"phases": ["a"]}, "must be a table of keys"),
    ],
)
def test_what_is_refused(changes, message):
    with pytest.raises(InputError, match=message):
        Drive.check({**STEADY, **changes})


@pytest.mark.parametrize("missing", ["speed", "pressure", "duration"])
def test_what_is_required(missing):
    with pytest.raises(InputError, match=f"{missing}: missing"):
        Drive.check({key: value for key, value in STEADY.items() if key != missing})


@pytest.mark.parametrize("side", ["road", "rim"])
def test_a_temperature_of_a_boundary_that_the_drive_replaces_is_warned_of(side):
    """Phase 'b' takes that of the boundary, as long as the whole drive has none."""
    phases = [{"name": "a", "duration": "10 s", f"{side}_temperature": "30 degC"}, {"name": "b", "duration": "10 s"}]
    given = {f"boundaries.{side}.temperature": "60 degC", "drive.phases": phases}
    read = tyrefem.study("nasa-22x5.5-8pr", given)
    assert read.warnings == ()
    not_read = tyrefem.study("nasa-22x5.5-8pr", given | {f"drive.{side}_temperature": "10 degC"})
    (warning,) = not_read.warnings
    assert warning.field == f"boundaries.{side}.temperature"
    assert f"every phase of the drive has '{side}_temperature'" in warning.message
