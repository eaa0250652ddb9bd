"""A measured table that is a DataFrame gives what the same table in a file gives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from toy_study import measured_from

import tyrefem as tf
from tyrefem.compare import compare
from tyrefem.errors import InputError
from tyrefem.measured import read_table
from tyrefem.measured.frame import frame_lines

EVERY_20 = np.arange(0.0, 1201.0, 20.0)


@pytest.fixture
def frame(study, tmp_path: Path) -> pd.DataFrame:
    """Columns as in a file."""
    return pd.read_csv(measured_from(study, EVERY_20, bias=5.0).write(tmp_path / "run-1.csv"))


def test_a_frame_is_a_table(study, frame, tmp_path):
    file = compare(study, tmp_path / "run-1.csv")
    comparison = compare(study, frame)
    columns = ["time_s", "sensor", "measured_degC", "computed_degC", "error_K"]
    pd.testing.assert_frame_equal(comparison.residuals[columns], file.residuals[columns])


def test_the_time_may_be_the_index_and_units_are_read(study, frame):
    other = frame.set_index("time [s]")
    other.index = pd.Index(other.index / 60.0, name="time [min]")
    other = (other * 1.8 + 32.0).rename(columns=lambda name: name.replace("degC", "degF"))
    assert compare(study, other).bias_K == pytest.approx(5.0)


def test_runs_of_a_frame_and_lists_of_tables(study, frame, tmp_path):
    two = pd.concat([frame.assign(run="morning"), frame.assign(run="evening")])
    assert set(compare(study, two).table["run"]) == {"morning", "evening"}
    mixed = [frame, tmp_path / "run-1.csv", *read_table(tmp_path / "run-1.csv")]
    assert set(compare(study, mixed).table["run"]) == {"measured", "run-1", "run-1 (2)"}


def test_gaps_in_a_frame_are_no_readings(study, frame):
    frame.iloc[3:10, 1] = np.nan
    comparison = compare(study, frame)
    assert comparison.table.set_index(["sensor", "phase"]).loc[("crown", "all"), "n"] == 54


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (lambda frame: frame.rename(columns=lambda name: name.split(" [")[0]), "has no unit"),
        (lambda frame: frame.drop(columns="time [s]"), "no time column"),
        (lambda frame: frame.rename(columns={"crown [degC]": "crwn [degC]"}), "did you mean 'crown'"),
        (lambda frame: frame.assign(**{"crown [degC]": "hot"}), "line 2, column 'crown .*'hot' is not a number"),
        (lambda frame: frame.iloc[:0], "no readings"),
        (lambda frame: pd.concat({"a": frame}, axis="columns"), "several levels"),
        (lambda frame: {"crown": [1.0]}, "a value of type dict is no measured table"),
        (lambda frame: 3, "a value of type int is no measured table"),
    ],
)
def test_what_is_no_table_is_one_error(study, frame, wrong, words):
    with pytest.raises(InputError, match=words):
        compare(study, wrong(frame))


def test_columns_of_a_frame_are_renamed_and_ignored(study, frame):
    other = frame.rename(columns={"crown [degC]": "c1 [degC]"}).assign(**{"air [degC]": 20.0})
    comparison = compare(study, other, rename={"c1": "crown"}, ignore=["air"])
    assert comparison.bias_K == pytest.approx(5.0)
    with pytest.raises(InputError, match="no column 'c2' to rename"):
        compare(study, other, rename={"c2": "crown"}, ignore=["air"])


def test_readings_of_a_result_are_a_table():
    quick = tf.study("example-validation", {"mesh.size": "12 mm"})
    result = quick.run()
    assert quick.compare(result.readings, result, inputs=False).rms_K == 0.0


@pytest.mark.parametrize("form", ["column", "index", "objects"])
def test_clocks_that_are_put_back_lose_no_hour(form: str) -> None:
    stamps = pd.date_range("2024-10-27 00:30", periods=4, freq="30min", tz="UTC").tz_convert("Europe/Berlin")
    frame = pd.DataFrame({"time": stamps, "crown [degC]": [20.0, 21.0, 22.0, 23.0]})
    frame = {"column": frame, "index": frame.set_index("time"), "objects": frame.astype({"time": object})}[form]
    (run,) = frame_lines(frame).read().runs
    assert run.times.tolist() == [0.0, 1800.0, 3600.0, 5400.0]


SECONDS = pd.to_timedelta([0.0, 0.01, 0.02, 1.5], unit="s")
STAMPS = pd.Timestamp("2024-05-01 12:30:00", tz="Europe/Berlin") + SECONDS


@pytest.mark.parametrize("name", [None, "utc", "Zeit", "time", "time [ms]", "Dauer"])
@pytest.mark.parametrize("times", [SECONDS, STAMPS, STAMPS.tz_localize(None)], ids=["elapsed", "zone", "stamps"])
def test_an_index_of_times_is_the_time_whatever_its_name(times: pd.Index, name: str | None) -> None:
    """pandas forgets the name of an index that is computed with."""
    frame = pd.DataFrame({"crown [degC]": [20.0, 21.0, 22.0, 23.0]}, index=pd.Index(times, name=name))
    rename = {"Dauer": "time"} if name == "Dauer" else {}
    (run,) = frame_lines(frame, rename).read(rename=rename).runs
    assert run.times.tolist() == pytest.approx([0.0, 0.01, 0.02, 1.5], abs=1e-9)
    assert run.sensors == ("crown",)


def test_elapsed_times_in_a_column() -> None:
    values = {"time": SECONDS, "crown [degC]": [20.0, 21.0, 22.0, 23.0]}
    (run,) = frame_lines(pd.DataFrame(values)).read().runs
    assert run.times.tolist() == [0.0, 0.01, 0.02, 1.5]
    (run,) = frame_lines(pd.DataFrame(values, index=STAMPS + pd.Timedelta("1s"))).read().runs
    assert run.times.tolist() == [0.0, 0.01, 0.02, 1.5], "the column counts, not the index beside it"


def test_an_index_of_elapsed_times_in_words_of_other_languages() -> None:
    frame = pd.DataFrame({"Zeit [min]": [0.0, 1.0], "crown [degC]": [20.0, 21.0]}).set_index("Zeit [min]")
    (run,) = frame_lines(frame).read().runs
    assert run.times.tolist() == [0.0, 60.0]


@pytest.mark.parametrize("index", [["time [s]"], ["run"], ["run", "time [s]"]])
def test_an_index_whose_columns_were_kept(frame: pd.DataFrame, index: list[str]) -> None:
    named = frame.assign(run="a")
    (plain,) = frame_lines(named).read().runs
    (run,) = frame_lines(named.set_index(index, drop=False)).read().runs
    assert run.times.tolist() == plain.times.tolist()
    pd.testing.assert_frame_equal(run.temperatures, plain.temperatures)


def test_a_time_that_is_the_index_twice(frame: pd.DataFrame) -> None:
    (run,) = frame_lines(frame.set_index([frame["time [s]"], frame["time [s]"]])).read().runs
    assert run.times.tolist() == EVERY_20.tolist()


def test_readings_of_a_result_by_time() -> None:
    readings = pd.DataFrame({"time_s": [0.0, 5.0], "crown": [20.0, 21.0]}).set_index("time_s")
    (run,) = frame_lines(readings).read().runs
    assert run.times.tolist() == [0.0, 5.0]


def test_a_run_whose_name_would_begin_a_comment_is_kept() -> None:
    """In a file such rows are comments; a frame has none."""
    frame = pd.DataFrame({"run": ["#1", "#1", "b"], "time [s]": [0, 10, 0], "crown [degC]": [20.0, 21.0, 22.0]})
    first, second = frame_lines(frame).read().runs
    assert (first.name, first.times.tolist()) == ("#1", [0.0, 10.0])
    assert (second.name, second.temperatures["crown"].tolist()) == ("b", [22.0])
