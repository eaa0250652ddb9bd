"""Mechanics saved from Python: the folder of the command, with its study; files of the user stay."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import tyrefem as tf
from tyrefem.cli import main
from tyrefem.errors import InputError

STUDY = "nasa-22x5.5-8pr"
CHANGES = {
    "mesh.size": "14 mm", "mechanics.strain": "fem", "mechanics.motion": "linear",
    "materials.tread": "rubber-tread-aircraft",
}  # fmt: skip
SETTINGS = [word for key, value in CHANGES.items() for word in ("--set", f"{key}={value}")]
FEW = {"loads": [8e3, 12e3], "slip_angles": [math.radians(a) for a in (1, 3, 5, 8)], "slips": [], "cambers": []}
ANGLES = ["--loads", "8 kN, 12 kN", "--slip-angles", "1 deg, 3 deg, 5 deg, 8 deg", "--slips", "none"]
Saved = Callable[[Any, Path], Path]
#: Command -> further words of its line; the same in Python.
QUESTIONS: dict[str, tuple[list[str], Saved]] = {
    "press": (["--no-vtk"], lambda study, out: study.press().save(out, pictures=False, vtk=False)),
    "modes": ([], lambda study, out: study.natural_frequencies().save(out, pictures=False)),
    "roll": (["--no-vtk", "--slip", "1 %"], lambda study, out: study.roll(slip=0.01).save(
        out, pictures=False, vtk=False)),
    "forces": ([*ANGLES, "--cambers", "none"], lambda study, out: study.tyre_forces(**FEW).save(out, pictures=False)),
    "life": (["--no-vtk", "--temperature", "60 degC", "--no-sensitivity"], lambda study, out: study.life(
        temperature=60.0).save(out, pictures=False, vtk=False)),
    "wear": (["--slip-angle", "1 deg", "--distance", "100 km"], lambda study, out: study.roll(
        slip_angle=math.radians(1)).wear().save(out, 1e5, pictures=False)),
}  # fmt: skip


@pytest.mark.parametrize("command", QUESTIONS)
def test_the_folder_is_that_of_the_command(command: str, here: Path) -> None:
    words, saved = QUESTIONS[command]
    assert main([command, STUDY, *SETTINGS, *words, "--no-pictures", "--out", "line"]) == 0
    assert saved(tf.study(STUDY, CHANGES), Path("python")) == Path("python")
    line, python = here / "line", here / "python"
    assert sorted(path.name for path in python.iterdir()) == sorted(path.name for path in line.iterdir())
    assert (python / "study.toml").read_text() == (line / "study.toml").read_text()
    assert tf.study(python / "study.toml").card == tf.study(STUDY, CHANGES).card
    differing = {"arguments", "checksums", "files_read"}
    by_line, by_python = (json.loads((folder / "summary.json").read_text()) for folder in (line, python))
    assert by_python["complete"] is True
    assert by_python.keys() == by_line.keys()
    assert {key: by_python[key] for key in by_line.keys() - differing} == {
        key: by_line[key] for key in by_line.keys() - differing
    }
    back = tf.load(python)
    assert isinstance(back, tf.api.Record)
    assert back.command == command


def test_the_users_files_and_other_results_stay(here: Path) -> None:
    study = tf.study(STUDY, CHANGES)
    modes = study.natural_frequencies([0], 1)
    (here / "study.toml").write_text("mine")
    with pytest.raises(InputError, match=r"overwrite files that it did not write.*study\.toml.*force=True"):
        modes.save(here, pictures=False)
    assert [path.name for path in here.iterdir()] == ["study.toml"]
    assert (here / "study.toml").read_text() == "mine"
    modes.save("out", pictures=False)
    modes.save("out", pictures=False)
    with pytest.raises(InputError, match="holds the results of 'tyrefem modes'"):
        study.roll().save("out", pictures=False, vtk=False)
    assert (here / "out" / "modes.csv").is_file()
    modes.save(here, pictures=False, force=True)
    assert tf.study(here / "study.toml").card == study.card


def test_the_wear_of_a_drive_is_saved_with_its_study(here: Path) -> None:
    tread = {"base": "rubber-tread-aircraft", "friction": {"coefficient": 1.0, "source": "test"}}
    rolling = {"boundaries.sliding": "rolling", "drive.load": "4 kN", "materials.tread": tread}
    wear = tf.study(STUDY, CHANGES | rolling).wear()
    assert wear.save("out", pictures=False) == Path("out")
    summary = json.loads((here / "out" / "summary.json").read_text())
    assert summary["distance_m"] == pytest.approx(wear.distance)
    assert tf.study("out/study.toml").card.boundaries.sliding.rolls
