"""What is given to a study's methods in Python: a clear error in place of a failure deep in the mechanics."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.api import identify
from tyrefem.api.numbers import check_numbers
from tyrefem.errors import InputError
from tyrefem.measured import read_table
from tyrefem.quantity import registry
from tyrefem.variants.execution import Execution, SweepSettings
from tyrefem.variants.schedulers import Local

pytestmark = pytest.mark.fast


SPEEDS = {"drive.speed": ["10 mph", "20 mph"]}


@pytest.fixture(scope="module")
def coarse() -> tf.Study:
    return tf.study("nasa-22x5.5-8pr", {"mesh.size": "15 mm", "drive.duration": "2 s", "output.every": "1 s"})


@pytest.mark.parametrize(
    ("method", "options", "message"),
    [
        ("press", {"load": "5 kN"}, r"load: must be a number in N, not '5 kN'; did you mean 5000\?"),
        ("press", {"load": math.inf}, "load: must be finite, not inf"),
        ("press", {"pressure": "much"}, "pressure: must be a number in Pa, not 'much'$"),
        ("press", {"camber": [1.0, 2.0, None]}, r"camber: must be a number in rad, not \[1\.0, 2\.0, None\]"),
        ("press", {"load": b"x"}, "load: must be a number in N, not b'x'"),
        ("press", {"load": True}, "load: must be a number in N, not True"),
        ("press", {"load": 10**400}, "load: must be finite, not inf"),
        ("press", {"load": []}, r"load: must be a number in N, not \[\]"),
        ("press", {"pressure": lambda speed: speed}, "pressure: must be a number in Pa, not <function"),
        (
            "press",
            {"load": registry().Quantity(3, "kN")},
            r"load: must be a number in N, .* did you mean 3000\?",
        ),
        ("press", {"motion": 3.5}, r"motion: no motion '3\.5'; allowed: large, linear"),
        ("roll", {"slip": [0.1, 0.2]}, r"slip: must be a number, not \[0\.1, 0\.2\]; several numbers make a curve"),
        ("press", {"tolerance": math.nan}, "tolerance: must be finite, not nan"),
        ("roll", {"slip_angle": "2 deg"}, r"slip_angle: must be a number in rad, not '2 deg'; did you mean 0\.0349"),
        ("roll", {"torque": math.nan}, "torque: must be finite, not nan"),
        ("roll", {"friction": "x"}, "friction: must be a number, not 'x'$"),
        ("slip_curve", {"slip_angle": [0.01, math.nan]}, "slip_angle: must be finite, not nan"),
        ("slip_curve", {"slip_angle": np.int64(0), "slip": []}, "slip: give at least one value"),
        ("tyre_forces", {"loads": 5e3}, r"loads: must be a list of numbers in N, not 5000\.0"),
        ("tyre_forces", {"slips": [0.1, math.nan]}, "slips: must be finite, not nan"),
        ("natural_frequencies", {"harmonics": [1.5]}, r"harmonics: must be whole numbers from 0 to 60, not \[1\.5\]"),
        ("natural_frequencies", {"harmonics": 5}, "harmonics: must be whole numbers from 0 to 60, not 5"),
        ("natural_frequencies", {"count": 1.5}, "count: must be a whole number from 1 to 40, not 1.5"),
        ("natural_frequencies", {"count": True}, "count: must be a whole number from 1 to 40, not True"),
        ("tyre_forces", {"loads": iter([3e3, 3e3])}, "loads: give at least two different loads"),
        ("tyre_forces", {"slips": iter([0.1, math.nan])}, "slips: must be finite, not nan"),
        ("tyre_forces", {"harmonics": "80"}, "harmonics: must be a whole number of at least 24, not '80'"),
        ("tyre_forces", {"harmonics": 0}, "harmonics: must be a whole number of at least 24, not 0"),
        ("tyre_forces", {"slips": [], "slip_angles": []}, "slip_angles: give at least one slip angle or one slip"),
        (
            "life",
            {"temperature": "80 degC"},
            r"temperature: must be a number in degC, not '80 degC'; did you mean 80\?",
        ),
        ("warmed", {"temperatures": {"tread": 50.0}}, "temperatures: every region needs a temperature; missing: "),
        ("warmed", {"temperatures": {"tred": 50.0}}, "no region 'tred'; did you mean 'tread'"),
        ("with_drive", {"changes": None}, "changes: must be a mapping like {'speed': '25 mph'}, not None"),
        ("save", {"path": None}, "path: must be a path, as text or Path, not None"),
        ("save", {"path": ""}, "path: is empty"),
        ("save", {"path": "/"}, "/: is a folder; a file is wanted"),
        ("sweep", {"vary": ["drive.speed"]}, "vary: must be a mapping like"),
        ("sweep", {"vary": SPEEDS, "folder": 3.5}, r"folder: must be a path, as text or Path, not 3\.5"),
        ("sweep", {"vary": SPEEDS, "folder": ""}, "folder: is empty"),
        ("sweep", {"vary": SPEEDS, "scheduler": 4}, "scheduler: must be Here, Local or Dask, not 4"),
        ("sweep", {"vary": SPEEDS, "settings": {}}, "settings: must be SweepSettings, not {}"),
        ("explore", {"vary": 3.5}, "vary: must be a mapping like"),
        ("explore", {"tolerance": "1 K"}, "tolerance: must be a positive number of kelvins, not '1 K'"),
        ("explore", {"tolerance": 0}, "tolerance: must be a positive number of kelvins, not 0"),
        ("explore", {"scheduler": 4}, "scheduler: must be Here, Local or Dask, not 4"),
        ("compare", {"table": 3.5}, "table: a value of type float is no measured table"),
        ("diagnose", {"workers": "2"}, "workers: must be a whole number of at least 1, not '2'"),
        ("diagnose", {"workers": 0}, "workers: must be a whole number of at least 1, not 0"),
        ("diagnose", {"strategy": "forward"}, "strategy: must be a Strategy, with check and search, not 'forward'"),
        ("diagnose", {"criterion": "BIC"}, "criterion: must be a Criterion, with of_fit and of_linear, not 'BIC'"),
        ("diagnose", {"largest": "2"}, "largest: must be a number of effects from 1 to 3, not '2'"),
        ("diagnose", {"looks": "2"}, "looks: must be a whole number of at least 1, not '2'"),
        ("diagnose", {"settings": {}}, "settings: must be DiagnosisSettings, not {}"),
        ("diagnose", {"effects": 3}, "effects: must be a path, as text or Path, not 3"),
        ("diagnose", {"calibration": [1]}, r"calibration: must be a path, as text or Path, not \[1\]"),
        ("at_amplitudes", {"amplitudes": {"tred": 0.1}}, "no region 'tred'; did you mean 'tread'"),
        ("replace", {"changes": None}, "changes must be a table like"),
        ("scaled", {"key": "drive.speed", "factor": "2"}, "factor: must be a number, not '2'"),
        ("scaled", {"key": 3, "factor": 2.0}, r"3 is not a dotted name such as drive\.speed"),
        ("sweep", {"vary": SPEEDS, "tolerance": math.inf}, "tolerance: must be finite"),
        ("sweep", {"vary": SPEEDS, "tolerance": True}, "tolerance: must be a number of kelvins, not True"),
        ("explore", {"tolerance": math.inf}, "tolerance: must be a positive number of kelvins, not inf"),
        ("sweep", {"vary": {"drive.speed": iter(["10 mph"])}}, "vary: must be a list of values or a tuple"),
        ("sweep", {"vary": {"drive.speed": (each for each in "ab")}}, "vary: must be a list of values or a tuple"),
        ("sweep", {"cases": Path("none.csv")}, r"none\.csv: cannot be read: No such file"),
        (
            "replace",
            {"changes": {"drive.speed": (each for each in "ab")}},
            r"drive\.speed: <generator .* is not",
        ),
    ],
)
def test_an_argument_that_cannot_be(coarse: tf.Study, method: str, options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        getattr(coarse, method)(**options)


def test_numbers_of_every_kind_pass() -> None:
    check_numbers(load=np.float64(4e3), drum_diameter=math.inf, slips=np.array([0.1]), friction=lambda speed, _: speed)
    check_numbers(slip_angle=(0.1, np.int64(0)), pressure=None, cambers=[], curve=True)
    check_numbers(load=np.array(4e3), loads=(each for each in (3e3, 4e3)))


def test_numbers_of_numpy_and_paths_are_taken_by_a_sweep(coarse: tf.Study, tmp_path: Path) -> None:
    assert Execution(tolerance=np.float32(0.5)).tolerance == Execution(tolerance=np.int64(1)).tolerance / 2
    assert Local(np.int64(2)).workers == 2
    assert coarse.scaled("drive.speed", np.float32(2)).data["drive"]["speed"] == "40 mph"
    (tmp_path / "cases.csv").write_text("name,drive.speed [mph]\n1,10\n2,20\n", encoding="utf-8")
    design = coarse.sweep(cases=tmp_path / "cases.csv", tolerance=np.float32(0.01))
    assert design.table["variant"].tolist() == ["1", "2"]


@pytest.mark.parametrize("workers", [0, -1, 1.5, "2", None, True])
def test_workers_and_settings_of_a_sweep_are_whole_numbers(workers: Any) -> None:
    with pytest.raises(InputError, match="workers: must be a whole number of at least 1, not"):
        Local(workers)
    with pytest.raises(InputError, match=r"settings\.piece: must be a whole number of at least 1, not"):
        SweepSettings(piece=workers)


def test_a_case_may_be_named_by_a_number(coarse: tf.Study, tmp_path: Path) -> None:
    (tmp_path / "cases.csv").write_text("name,drive.speed [mph]\n1,10\n2,20\n", encoding="utf-8")
    campaign = coarse.replace({"cases": tmp_path / "cases.csv"})
    assert campaign.case(2).data == campaign.case("2").data
    with pytest.raises(InputError, match=r"no case '\[2\]'; did you mean '2'"):
        campaign.case([2])  # type: ignore[arg-type]


def test_heat_of_an_unknown_kind_is_not_nothing(coarse: tf.Study) -> None:
    budget = coarse.run().heat_budget
    assert budget.total("sliding") == 0
    assert budget.total("generated") == pytest.approx(budget.table.query("kind == 'generated'")["energy_J"].sum())
    for method in (budget.total, budget.power):
        with pytest.raises(InputError, match="kind: no heat of the kind 'generatd'; did you mean 'generated'"):
            method("generatd")


def test_arguments_of_a_comparison_and_of_a_plan() -> None:
    measured = tf.study("example-validation")
    for options, message in (
        ({"k": "2"}, "the coverage factor k must be more than 0 and less than 100, not '2'"),
        ({"settings": {}}, "settings: must be ReducedInputSettings, not {}"),
        ({"result": 5}, "result: must be the result of a run, not 5"),
    ):
        with pytest.raises(InputError, match=message):
            measured.compare(**options)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="workers: must be a whole number of at least 1, not 0"):
        tf.study("hidden-effect").plan(workers=0)


def test_a_quick_look_at_a_life_has_the_temperatures_of_the_command() -> None:
    tyre = tf.study("nasa-22x5.5-8pr", {"mesh.size": "15 mm", "mechanics.strain": "fem"})
    for temperature in (-300.0, 301.0):
        with pytest.raises(InputError, match=f"temperature: no tyre has {temperature:g} degC; allowed: -273.15 to 300"):
            tyre.life(temperature=temperature)
    with pytest.raises(InputError, match="result: must be the result of a run, not 5"):
        tyre.life(result=5)  # type: ignore[arg-type]


def test_a_text_is_no_list_of_variants_places_or_tables(coarse: tf.Study, tmp_path: Path) -> None:
    design = coarse.sweep({"drive.speed": [f"{speed} mph" for speed in range(5, 17)]}, reduced="never")
    # Not the variants 1 and 2.
    for variants in ("12", 12):
        with pytest.raises(InputError, match="variants: must be a list of variants"):
            design.to_vtk(tmp_path, variants)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="folder: must be a path"):
        design.to_vtk(3.5, ["1"])  # type: ignore[arg-type]
    pressed = coarse.press(deflection=0.015, motion="linear")
    for places in ("tread", 5, [5]):
        with pytest.raises(InputError, match="at: must be a list of places or regions"):
            pressed.save(tmp_path, at=places)  # type: ignore[arg-type]
    for name in ("tables", "without", "tests"):
        with pytest.raises(InputError, match=f"{name}: must be a list, not 'T1'"):
            identify("trtlab", **{name: "T1"})  # type: ignore[arg-type]
    with pytest.raises(InputError, match="rig: must be a path"):
        identify(5)  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())


def test_a_result_from_a_file_and_of_a_user_that_there_is_not(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="~nobody-here/out: no such folder of results"):
        tf.load("~nobody-here/out")
    (tmp_path / "verdict.json").write_text("{}")
    with pytest.raises(InputError, match=r"verdict\.json: is damaged, or no verdict of 'tyrefem diagnose'"):
        tf.load(tmp_path)
    with pytest.raises(InputError, match=r"verdict\.json: is a file; give its folder of results"):
        tf.load(tmp_path / "verdict.json")


@pytest.mark.parametrize("value", [None, 3.5, b"x", [], "", "a\0b"])
def test_what_is_no_path(value: Any) -> None:
    calls: dict[str, Callable[[Any], object]] = {"folder": tf.load, "path": read_table}
    for field, call in calls.items():
        with pytest.raises(InputError) as error:
            call(value)
        assert error.value.field == field


def test_numbers_of_a_size_and_the_offset_of_a_table(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="numbers: must be a mapping like"):
        tf.section_from_size("205/60R15", 3.5)  # type: ignore[arg-type]
    file = tmp_path / "run.csv"
    file.write_text("time [s],crown [degC]\n0,25\n")
    for offset in ("60 s", None, [60.0], math.nan):
        with pytest.raises(InputError, match="time_offset"):
            read_table(file, time_offset=offset)  # type: ignore[arg-type]


def test_times_points_and_pictures_of_a_result(coarse: tf.Study) -> None:
    result = coarse.run()
    for time in ("2 s", [1.0], b"1"):
        with pytest.raises(InputError, match="time: must be a number of seconds, not"):
            result.field(time)  # type: ignore[arg-type]
    for points in ("nope", {}, ["x", 1], 10**400):
        with pytest.raises(InputError, match=r"points: wanted finite pairs of coordinates, \(n, 2\); not"):
            result.near(points)  # type: ignore[arg-type]
    for picture in (None, 3.5, ["heat"]):
        with pytest.raises(InputError, match="picture: no picture"):
            result.plot(picture=picture)  # type: ignore[call-overload]
    for path in (None, 3.5, b"x", ""):
        for write in (result.save, result.to_vtk, result.report):
            with pytest.raises(InputError, match="path"):
                write(path)  # type: ignore[arg-type]


@pytest.mark.parametrize("changes", [5, {5: "x"}, ["drive.speed"]])
def test_changes_are_a_table_of_dotted_names(changes: Any) -> None:
    with pytest.raises(InputError, match=r"changes must be a table like|is not a dotted name such as drive\.speed"):
        tf.study("nasa-22x5.5-8pr", changes)


def test_a_limit_is_finite(coarse: tf.Study) -> None:
    with pytest.raises(InputError, match=r"limits\.hottest_degC\.below: Input should be a finite number"):
        coarse.sweep({"drive.speed": ["10 mph"]}, limits={"hottest_degC": {"below": math.nan}})


def test_a_result_is_not_saved_in_a_file(coarse: tf.Study, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    with pytest.raises(InputError, match="a file is in the place of this folder"):
        coarse.run().save(tmp_path / "file")
    assert (tmp_path / "file").read_text() == "mine"
