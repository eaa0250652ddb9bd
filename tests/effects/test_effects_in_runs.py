"""Effects that act in some measured runs only: `runs` in a study, and what follows no measured run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import tyrefem as tf
from tyrefem.cli import main
from tyrefem.effects import catalogue
from tyrefem.reports.assumptions import assumptions
from tyrefem.reports.inputs import effect_rows

HOT: dict[str, Any] = {"name": "hot-road", "warmer_by": "20 delta_degC"}
SHORT = {"drive.phases": [{"name": "rolling", "duration": "60 s"}], "mesh.size": "8 mm", "sensors": {}}
SENSOR = {"crown": {"s": "0.3 in", "depth": "0.6 in"}}


@pytest.fixture(scope="module")
def plain() -> tf.Study:
    return tf.study("example-validation").replace({**SHORT, "sensors": SENSOR, "measured": [], "effects": []})


@pytest.fixture
def two_runs(plain: tf.Study, tmp_path: Path) -> tf.Study:
    """A study file with two measured runs; the road is 20 K warmer in the second."""
    for name, effects in (("run-1", []), ("run-2", [HOT])):
        readings = plain.replace({"effects": effects}).run().readings
        table = pd.DataFrame({"time [s]": readings["time_s"], "crown [degC]": readings["crown"]})
        table.to_csv(tmp_path / f"{name}.csv", index=False)
    measured = [{"table": str(tmp_path / f"{name}.csv")} for name in ("run-1", "run-2")]
    file = plain.replace({"measured": measured, "effects": [{**HOT, "runs": ["run-2"]}]}).save(tmp_path / "study.toml")
    return tf.study(file)


def rise(study: tf.Study, plain: tf.Study) -> float:
    """K at the end, above the study without effects."""
    return float(study.run().readings["crown"].iloc[-1] - plain.run().readings["crown"].iloc[-1])


def test_an_effect_acts_in_its_runs_and_in_no_other_drive(plain: tf.Study) -> None:
    restricted = plain.replace({"effects": [{**HOT, "runs": ["run-2", "run-4"]}]})
    assert restricted.effects == ()
    assert rise(restricted, plain) == 0.0
    assert rise(restricted.at_run("run-1"), plain) == 0.0
    everywhere = rise(plain.replace({"effects": [HOT]}), plain)
    assert everywhere > 0.5
    for run in ("run-2", "run-4"):
        assert rise(restricted.at_run(run), plain) == everywhere
    assert restricted.replace({"run": "run-2"}).effects[0].name == "hot-road"


def test_an_effect_in_all_runs_and_one_in_a_run_add_up(plain: tf.Study) -> None:
    both = plain.replace({"effects": [HOT, {**HOT, "warmer_by": "10 delta_degC", "runs": ["run-2"]}]})
    once, thrice = rise(both, plain), rise(both.at_run("run-2"), plain)
    assert thrice == pytest.approx(1.5 * once, rel=0.02)
    labels = [" ".join(effect.label) for effect in both.at_run("run-2").effects]
    assert labels == ["hot-road", "hot-road in run-2"]


def test_wear_in_one_run_thins_the_section_of_this_run(plain: tf.Study) -> None:
    worn = plain.replace({"effects": [{"name": "worn-tread", "fraction": 0.5, "runs": ["run-2"]}]})
    assert worn.section == worn.new_section
    assert worn.at_run("run-2").section != worn.new_section


def test_reports_say_which_effects_are_left_out(plain: tf.Study) -> None:
    restricted = plain.replace({"effects": [{**HOT, "runs": ["run-2"]}]})
    assert effect_rows(restricted) == []
    (row,) = effect_rows(restricted.at_run("run-2"))
    assert "only in run-2" in row[2]

    def texts(study: tf.Study) -> str:
        return " ".join(" ".join(row) for row in assumptions(study, []))

    assert "hot-road in run-2. This drive is of no measured run." in texts(restricted)
    assert "hot-road in run-2. This drive is of the run 'run-1'." in texts(restricted.at_run("run-1"))
    assert "do not act" not in texts(restricted.at_run("run-2"))


def test_a_comparison_takes_the_effect_in_its_run(two_runs: tf.Study) -> None:
    comparison = two_runs.compare(inputs=False)
    for run in ("run-1", "run-2"):
        readings = pd.read_csv(two_runs.folder / f"{run}.csv")  # type: ignore[operator]
        computed = comparison.curves[run]
        np.testing.assert_allclose(
            np.interp(readings["time [s]"], computed["time_s"], computed["crown"]), readings["crown [degC]"], atol=1e-3
        )
    without = two_runs.replace({"effects": []}).compare(inputs=False)
    assert abs(without.curves["run-2"]["crown"].iloc[-1] - comparison.curves["run-2"]["crown"].iloc[-1]) > 0.5


def test_a_run_that_is_not_measured_is_an_error(two_runs: tf.Study, capfd: pytest.CaptureFixture[str]) -> None:
    wrong = two_runs.replace({"effects": [{**HOT, "runs": ["run-22"]}]})
    message = r"effects\.hot-road\.runs: there is no measured run 'run-22'; did you mean 'run-2'\?"
    for question in (wrong.compare, wrong.diagnose):
        with pytest.raises(tf.InputError, match=message):
            question()
    assert two_runs.file is not None
    text = two_runs.file.read_text(encoding="utf-8")
    two_runs.file.write_text(text.replace('"run-2"', '"rum-2"'), encoding="utf-8")
    assert main(["compare", str(two_runs.file), "--out", str(two_runs.file.parent / "out")]) == 2
    err = capfd.readouterr().err
    assert "there is no measured run 'rum-2'; did you mean 'run-2'?" in err
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("entries", "words"),
    [
        ([{**HOT, "runs": []}], r"effects\.0\.runs: must be a list of names of measured runs, such as \['run-2'\]"),
        ([{**HOT, "runs": "run-2"}], r"effects\.0\.runs: must be a list of names .*, not 'run-2'"),
        ([{**HOT, "runs": [2]}], r"effects\.0\.runs\.0: must be text, not 2"),
        ([{**HOT, "run": ["run-2"]}], "unknown key 'run'; did you mean 'runs'"),
        ([{**HOT, "runs": ["a", "b"]}, {**HOT, "runs": ["b"]}], "effects.hot-road: is given twice"),
    ],
)
def test_wrong_runs_are_refused(plain: tf.Study, entries: list[dict[str, Any]], words: str) -> None:
    with pytest.raises(tf.InputError, match=words):
        plain.replace({"effects": entries})


def test_one_effect_may_have_a_size_of_its_own_in_each_run(plain: tf.Study) -> None:
    two = plain.replace({"effects": [{**HOT, "runs": ["a"]}, {**HOT, "warmer_by": "5 delta_degC", "runs": ["b"]}]})
    assert [two.at_run(run).effects[0].values["warmer_by"] for run in ("a", "b")] == [20.0, 5.0]


def test_effects_of_the_day_are_those_of_the_surroundings() -> None:
    of_the_day = {name for name, effect in catalogue().items() if effect.of_the_day}
    assert of_the_day >= {"hot-road", "sun", "wind", "wet-road", "ambient-drift"}
    assert {catalogue()[name].family for name in of_the_day} == {"boundary"}
