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


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "materials.tread.wear: the card of region 'tread' has no table [wear]"),
        (["--slip-angle", "1"], "--slip-angle: '1' has no unit"),
        (["--distance", "0 km"], "--distance: '0 km' is out of range"),
    ],
)
def test_bad_input_is_one_line(refused: Callable[..., str], arguments: list[str], words: str) -> None:
    assert words in refused("wear", "nasa-22x5.5-8pr", *arguments)
