"""`tyrefem wear`: files that agree with each other, a worn section that loads, refusals in one line."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Callable
from pathlib import Path

import pytest

import tyrefem as tf
from tyrefem.cli import main
from tyrefem.geometry import load


def test_the_command_writes_what_it_says(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    coarse = ["--set", "mesh.size=14 mm", "--set", "materials.tread=rubber-tread-aircraft"]
    line = ["wear", "nasa-22x5.5-8pr", *coarse, "--slip-angle", "0.5 deg", "--distance", "100 km", "--out", "out"]
    assert main([*line, "--json"]) == 0
    summary = json.loads(capfd.readouterr().out)
    with (here / "out" / "wear.csv").open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    power = sum(float(row["friction_power_W"]) for row in rows)
    assert power == pytest.approx(summary["friction_power_W"], rel=1e-5)
    assert max(float(row["wear_mm_per_1000_km"]) for row in rows) == pytest.approx(
        summary["most_wear_mm_per_1000_km"], rel=1e-6
    )
    assert (here / "out" / "wear.png").read_bytes().startswith(b"\x89PNG")
    assert "worn by 100 km" in (here / "out" / "worn-section.toml").read_text(encoding="utf-8")
    load(str(here / "out" / "worn-section.toml"))
    changes = {"mesh.size": "14 mm", "materials.tread": "rubber-tread-aircraft"}
    wear = tf.study("nasa-22x5.5-8pr", changes).roll(slip_angle=math.radians(0.5)).wear()
    assert wear.mean * 1e6 == pytest.approx(summary["mean_wear_mm_per_1000_km"], rel=1e-9)


def test_a_tread_worn_through_keeps_the_wear_that_was_computed(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    changes = ["--set", "mesh.size=14 mm", "--set", "materials.tread=rubber-tread-aircraft"]
    line = ["wear", "nasa-22x5.5-8pr", *changes, "--distance", "1000000 km", "--no-pictures", "--out", "out"]
    assert main(line) == 2
    captured = capfd.readouterr()
    assert "--distance: the tread is worn through" in captured.err
    assert "mm per 1000 km on average" in captured.out
    assert "without a worn section" in captured.out
    assert {path.name for path in (here / "out").iterdir()} == {"wear.csv", "summary.json", "study.toml"}


def test_without_options_the_drive_of_a_rolling_study_wears(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    tread = '{ base = "rubber-tread-aircraft", friction = { coefficient = 1.0, source = "test" } }'
    values = ["mesh.size=14 mm", f"materials.tread={tread}", "mechanics.strain=fem", "mechanics.motion=linear"]
    values += ["boundaries.sliding=rolling", "drive.slip_ratio=2 %", "drive.load=4 kN"]
    options = [word for value in values for word in ("--set", value)]
    assert main(["wear", "nasa-22x5.5-8pr", *options, "--no-pictures", "--out", "out", "--json"]) == 0
    summary = json.loads(capfd.readouterr().out)
    (phase,) = summary["phases"]
    assert phase["mean_wear_mm_per_1000_km"] == pytest.approx(summary["mean_wear_mm_per_1000_km"], rel=1e-9)
    assert phase["friction_work_J"] / phase["distance_m"] == pytest.approx(
        summary["friction_power_W"] / 8.9408, rel=0.01
    )
    assert (
        main(["wear", "nasa-22x5.5-8pr", *options, "--slip", "-2 %", "--slip-angle", "0 deg", "--out", "one", "--json"])
        == 0
    )
    one = json.loads(capfd.readouterr().out)
    assert one["slip"] == pytest.approx(-0.02)
    assert one["mean_wear_mm_per_1000_km"] == pytest.approx(summary["mean_wear_mm_per_1000_km"], rel=0.02)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "materials.tread.wear: the card of region 'tread' has no table [wear]"),
        (
            ["--set", "materials.tread=rubber-tread-aircraft", "--set", "drive.load=0 N"],
            "study.toml: drive.load: must be more than 0 N",
        ),
        (["--slip-angle", "1"], "--slip-angle: '1' has no unit"),
        (["--distance", "0 km"], "--distance: '0 km' is out of range"),
    ],
)
def test_bad_input_is_one_line(refused: Callable[..., str], arguments: list[str], words: str) -> None:
    assert words in refused("wear", "nasa-22x5.5-8pr", *arguments)
