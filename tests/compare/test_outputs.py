"""What a comparison writes: complete files, readable again, a page that needs nothing else."""

from __future__ import annotations

import json
import struct
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from html.parser import HTMLParser

import numpy as np
import pandas as pd
import pytest
from toy_study import Sensor, measured_from

from tyrefem.cli.compare import _lines
from tyrefem.compare import compare
from tyrefem.compare.stored import read_comparison
from tyrefem.errors import InputError
from tyrefem.inputs.uncertain_numbers import UncertainNumber
from tyrefem.output import atomic_folder, atomic_path
from tyrefem.reports.comparison import _phases, deviations, save

EVERY_20 = np.arange(0.0, 1201.0, 20.0)


@pytest.fixture(scope="module")
def comparison():
    from toy_study import Study

    study = replace(
        Study(), sensors={"crown": Sensor(noise=0.5), "shoulder": Sensor(noise=0.5)}, uncertainty={"heat": 0.05}
    )
    sensors = ("crown", "shoulder", "contained-air")
    runs = [
        measured_from(study, EVERY_20, name="slow <1> $x$", noise=0.5, sensors=sensors),
        measured_from(study, np.arange(0.0, 1500.0, 100.0), name="slow 1", noise=0.5, bias=9.0),
    ]
    return compare(study, runs)


@pytest.fixture(scope="module")
def folder(comparison, tmp_path_factory):
    folder = tmp_path_factory.mktemp("out")
    (folder / "mine.txt").write_text("kept")
    assert save(comparison, folder) == folder / "comparison.html"
    return folder


def test_a_phase_begins_where_the_one_before_ends():
    """A reading at the border is of the phase that ends there: 600 s, not the next reading's 610 s."""
    times = np.arange(0.0, 1201.0, 10.0)
    names = np.where(times <= 600, "rolling", "cooling")
    assert _phases(pd.DataFrame({"time_s": times, "phase": names}), 60.0) == [("rolling", 0, 10), ("cooling", 10, 20)]


def test_the_files_and_no_other(folder):
    assert sorted(path.name for path in folder.iterdir()) == [
        "comparison.csv", "comparison.html", "comparison.json", "curves.csv", "deviations.png",
        "histories-slow-1-x.png", "histories-slow-1.png", "mine.txt", "residuals.csv",
    ]  # fmt: skip
    assert not list(folder.parent.glob(".out*"))


def test_tables_come_back(folder, comparison):
    table = pd.read_csv(folder / "comparison.csv")
    assert table.rms_K.tolist() == pytest.approx(comparison.table.rms_K.tolist(), rel=1e-14)
    residuals = pd.read_csv(folder / "residuals.csv")
    np.testing.assert_allclose(residuals.error_K, residuals.computed_degC - residuals.measured_degC, rtol=0, atol=1e-12)
    assert len(residuals) == 3 * 61 + 2 * 13


def test_runs_come_back_whatever_they_are_called(study, tmp_path):
    names = ["NA", "None", "01"]
    save(compare(study, [measured_from(study, EVERY_20, name=name) for name in names]), tmp_path)
    back = read_comparison(tmp_path)
    assert list(back.curves) == names
    assert list(back.table["run"].unique()) == list(back.residuals["run"].unique()) == names


def test_printed_times_keep_their_seconds(comparison):
    table = comparison.table.assign(at_s=1172.5)
    assert _lines(table).count(" 1172.5 ") == len(table)


def test_json_holds_the_table(folder, comparison):
    data = json.loads((folder / "comparison.json").read_text(encoding="utf-8"))
    assert data["overall"]["rms_K"] == pytest.approx(comparison.rms_K, rel=1e-15)
    assert len(data["rows"]) == len(comparison.table)
    assert isinstance(data["rows"][0]["beyond"], bool)
    assert {item["key"] for item in data["inputs"]} == {"heat"}
    assert data["summary"] == comparison.summary


def test_an_uncertain_temperature_stands_in_kelvins(study, tmp_path):
    """A share of a temperature means nothing to a person."""

    @dataclass(frozen=True)
    class InAir(type(study)):
        uncertain_numbers = (
            UncertainNumber("air", ("air",), ("298.15 K",), 2 / 298.15),
            UncertainNumber("heat", ("heat",), (1.0,), 0.05),
        )

    warm = InAir(uncertainty={"air": 2 / 298.15, "heat": 0.05})
    save(compare(warm, measured_from(warm, EVERY_20)), tmp_path)
    data = json.loads((tmp_path / "comparison.json").read_text(encoding="utf-8"))
    assert {item["key"]: item["sd"] for item in data["inputs"]} == {"air": "±2 K", "heat": "±5 %"}
    assert "<td>±2 K</td>" in (tmp_path / "comparison.html").read_text(encoding="utf-8")


def test_pictures_are_pictures(folder):
    for path in folder.glob("*.png"):
        data = path.read_bytes()
        assert data.startswith(b"\x89PNG\r\n\x1a\n")
        width, height = struct.unpack(">II", data[16:24])
        assert 400 < width < 2500
        assert 200 < height < 2500


def test_the_page_is_self_contained_escaped_and_begins_with_the_summary(folder, comparison):
    text = (folder / "comparison.html").read_text(encoding="utf-8")

    class Page(HTMLParser):
        sources, words = [], []

        def handle_starttag(self, tag, attrs):
            self.sources += [value for name, value in attrs if name in ("src", "href")]

        def handle_data(self, data):
            self.words.append(data)

    Page().feed(text)
    assert len(Page.sources) == 3
    assert all(source.startswith("data:image/png;base64,") for source in Page.sources)
    assert "<1>" not in text
    words = [word.strip() for word in Page.words if word.strip()]
    assert words.index(comparison.summary) < words.index("Deviations")


def test_the_summary_is_one_honest_line(comparison):
    assert "\n" not in comparison.summary
    assert comparison.bias_K == pytest.approx(9.0 * 26 / 209, abs=4 * 0.5 / np.sqrt(209))
    overall = f"computed - measured {comparison.bias_K:+.2f} K on average, {comparison.rms_K:.2f} K rms"
    assert comparison.summary.startswith(f"toy: 2 runs, 3 sensors, 209 readings: {overall}; ")
    assert "worst sensor" in comparison.summary
    assert "2 of 5 sensor histories, 4 of 10 sensor phases" in comparison.summary
    assert not any("no measurement noise is stated" in note for note in comparison.notes)


def test_simulations_side_by_side_give_the_same(comparison):
    from toy_study import Study

    study = replace(Study(), uncertainty={"heat": 0.05, "air": 0.01})
    run = measured_from(study, EVERY_20, noise=0.5)
    with ThreadPoolExecutor(2) as executor:
        parallel = compare(study, run, executor=executor)
    pd.testing.assert_frame_equal(parallel.table, compare(study, run).table)


def test_a_failure_leaves_the_old_file_and_no_other(tmp_path):
    target = tmp_path / "a.json"
    target.write_text("old")

    def fail_in(place):
        with place as temporary:
            (temporary / "half" if temporary.is_dir() else temporary).write_text("half")
            raise ArithmeticError

    for place in (atomic_path(target), atomic_folder(tmp_path / "new")):
        with pytest.raises(ArithmeticError):
            fail_in(place)
    assert target.read_text() == "old"
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["a.json", "new"]


def test_a_place_that_cannot_be_written_is_an_input_error(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"), atomic_path(tmp_path / "file" / "a.json"):
        pass
    with pytest.raises(InputError, match="cannot be written"), atomic_folder(tmp_path / "file"):
        pass


def test_folders_within_are_moved_whole(tmp_path):
    with atomic_folder(tmp_path / "out") as temporary:
        (temporary / "fields").mkdir()
        (temporary / "fields" / "a.vtu").write_text("x")
    assert (tmp_path / "out" / "fields" / "a.vtu").read_text() == "x"


def test_the_map_speaks_of_boxes_only_where_there_are_any(study):
    for bias, words in ((0.0, "none is beyond 2 u_val"), (20.0, "boxed = beyond 2 u_val")):
        run = measured_from(study, EVERY_20, bias=bias)
        assert words in deviations(compare(study, run)).axes[0].get_title(loc="left")
