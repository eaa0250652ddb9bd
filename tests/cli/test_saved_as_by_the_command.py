"""Answers saved from Python are the folder of the command: edited files and other results stay, `load` reads it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w

import tyrefem as tf
from tyrefem.cli import main
from tyrefem.effects import catalogue
from tyrefem.errors import InputError

SPEEDS = {"drive.speed": ["10 mph", "20 mph"]}
VARY = ["--vary", "drive.speed=10 mph,20 mph"]
PAIR = ("hot-road", "sun")
#: Command -> further words of its line; the same in Python; a file that a user may edit; class that `load` gives.
ANSWERS: dict[str, tuple[list[str], Callable[[Any], Any], str, type]] = {
    "run": (["--no-vtk", "--no-pictures"], lambda study: study.run(), "readings.csv", tf.Result),
    "compare": (["--workers", "1"], lambda study: study.compare(), "comparison.csv", tf.Comparison),
    "diagnose": (["--largest", "1", "--workers", "1"], lambda study: study.diagnose(largest=1), "amended.toml",
                 tf.api.DiagnosisRecord),
    "plan": (["--workers", "1"], lambda study: study.plan(), "plan.csv", tf.api.Record),
    "sweep": (["--workers", "1", *VARY], lambda study: study.sweep(SPEEDS), "sweep.csv", tf.api.Record),
}  # fmt: skip
#: Kept by the sweep's command, to go on with.
VARIANTS = "variants.jsonl"


@pytest.fixture
def study(here: Path) -> Path:
    """A coarse study of 60 s with two sensors, two effects to choose from, and a measured table."""
    data = {
        "title": "Small",
        "section": "nasa-22x5.5-8pr",
        "materials": {name: f"nasa-{name}" for name in ("carcass", "tread", "sidewall", "bead")},
        "drive": {
            "speed": "20 mph", "load": "2700 lbf", "pressure": "83 psi", "ambient": "25 degC", "duration": "60 s",
        },
        "mesh": {"size": "14 mm", "element": "P1"},
        "numerics": {"tolerance": "0.5 delta_degC"},
        "output": {"fields": 2},
        "diagnosis": {"exclude": sorted(name for name in catalogue() if name not in PAIR)},
        "plan": {"limits": {"drive.speed": ["10 mph", "30 mph"]}, "drives": 2, "runs_most": 1, "sensors_most": 0},
        "sensors": {
            "crown-outer": {"s": "0.33 in", "depth": "0.63 in"},
            "shoulder-inner": {"s": "2.00 in", "depth": "0.07 in"},
        },
    }  # fmt: skip
    file = here / "mine" / "study.toml"
    file.parent.mkdir()
    file.write_text(tomli_w.dumps(data))
    readings = tf.study(file).run().readings.filter(["time_s", *data["sensors"]]).rename(columns={"time_s": "time [s]"})
    readings = readings.rename(columns={name: f"{name} [degC]" for name in data["sensors"]})
    readings.iloc[:, 1:] += np.random.default_rng(1).normal(0, 0.1, (len(readings), 2))
    readings.to_csv(file.with_name("table.csv"), index=False)
    file.write_text(tomli_w.dumps(data | {"measured": [{"table": "table.csv"}]}))
    return file


def content(folder: Path) -> dict[str, bytes]:
    """The files of a folder, but the variants that a sweep keeps."""
    files = (path for path in folder.rglob("*") if path.is_file() and path.name != VARIANTS)
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


@pytest.mark.parametrize("command", ANSWERS)
def test_the_folder_is_that_of_the_command_and_edited_files_stay(command: str, study: Path, here: Path) -> None:
    words, answer, edited, kind = ANSWERS[command]
    assert main([command, str(study), *words, "--out", "line"]) == 0
    result = answer(tf.study(study))
    result.save("python")
    line, python = content(here / "line"), content(here / "python")
    assert sorted(python) == sorted(line)
    assert python["study.toml"] == line["study.toml"]
    by_line, by_python = json.loads(line["summary.json"]), json.loads(python["summary.json"])
    assert by_python.keys() == by_line.keys()
    assert by_python["command"] == command
    assert by_python["input"] == by_line["input"]
    assert by_python["complete"] is True
    assert isinstance(tf.load(here / "python"), kind)

    result.save("python")  # again: nothing is the user's
    assert sorted(content(here / "python")) == sorted(line)
    mine = here / "python" / edited
    mine.write_text("mine")
    with pytest.raises(InputError, match=rf"changed since: {edited}; .*force=True"):
        result.save("python")
    assert content(here / "python") == {**content(here / "python"), edited: b"mine"}
    result.save("python", force=True)
    assert isinstance(tf.load(here / "python"), kind)

    other = "sweep" if command == "run" else "run"
    (here / "python" / "summary.json").write_text(json.dumps(by_python | {"command": other}))
    with pytest.raises(InputError, match=f"holds the results of 'tyrefem {other}'; .*force=True"):
        result.save("python")
    (here / "other").mkdir()
    (here / "other" / edited).write_text("mine")
    with pytest.raises(InputError, match=f"overwrite files that it did not write.*: {edited}"):
        result.save("other")
    assert content(here / "other") == {edited: b"mine"}


def test_files_of_an_earlier_sweep_go_but_not_edited_ones(study: Path, here: Path) -> None:
    """Variants to go on with, and files that a user has edited, stay."""
    small = tf.study(study)
    assert main(["sweep", str(study), *VARY, "--workers", "1", "--no-pictures", "--out", "out"]) == 0
    (here / "out" / "pareto.csv").write_text("mine")
    fewer = small.sweep({"drive.load": ["2000 lbf", "2700 lbf"]}, tornado={"tolerances": {"drive.load": "5 %"}})
    with pytest.raises(InputError, match=r"changed since: pareto\.csv"):
        fewer.save("out", pictures=False)
    assert (here / "out" / VARIANTS).is_file()
    assert not (here / "out" / "tornado.csv").exists()
    fewer.save("out", pictures=False, force=True)
    fewer.save("out")
    small.sweep(SPEEDS).save("out", pictures=False)
    assert not (here / "out" / "tornado.csv").exists()
    assert not list(here.glob("out/pictures/*"))
    assert (here / "out" / VARIANTS).is_file()


def test_a_loaded_answer_is_saved_again_beside_its_own_study(study: Path, here: Path) -> None:
    tf.study(study).compare().save("out")
    before = content(here / "out")
    tf.load("out").save("out")
    assert sorted(content(here / "out")) == sorted(before)
    assert content(here / "out")["study.toml"] == before["study.toml"]
    tf.load("out").save("again")
    assert sorted(content(here / "again")) == sorted(before)


def test_the_page_of_an_exploration_has_its_study_beside(here: Path) -> None:
    changes = {"mesh.size": "20 mm", "mesh.through": 1, "mesh.element": "P1", "drive.duration": "60 s"}
    coarse = tf.study("nasa-22x5.5-8pr", changes)
    explored = coarse.explore({"drive.speed": ("15 mph", "20 mph")}, tolerance=2.0)
    assert explored.save("tyre.html") == Path("tyre.html")
    assert tf.study("tyre.toml").card == coarse.card
    explored.save("tyre.html")
    with open("tyre.toml", "a") as stream:
        stream.write("# mine\n")
    with pytest.raises(InputError, match=r"tyre\.toml: .*has changed since; .*force=True"):
        explored.save("tyre.html")
    assert Path("tyre.toml").read_text().endswith("# mine\n")
    explored.save("tyre.html", force=True)
    assert not Path("tyre.toml").read_text().endswith("# mine\n")
