"""`tyrefem press --critical-speed`: files, lists, refusals."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from pathlib import Path

import pytest

import tyrefem as tf
from tyrefem.cli import main
from tyrefem.cli.critical_speed import _words
from tyrefem.mechanics.rolling.critical_speed import CriticalSpeed

STUDY = "nasa-22x5.5-8pr"
COARSE = ["--set", "mesh.size=16 mm"]


def test_pressure_raises_the_critical_speed(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    line = ["press", STUDY, "--critical-speed", "--pressure", "50 psi, 100 psi", "--out", "out", *COARSE]
    assert main([*line, "--json"]) == 0
    rows = json.loads(capfd.readouterr().out)["critical"]
    soft, hard = (row["speed_m_s"] for row in rows)
    # The tension of the bias carcass is that of the pressure, so speeds grow by less than the root of two.
    assert 1.05 < hard / soft < 1.42
    folder = here / "out"
    assert json.loads((folder / "critical-speed.json").read_text(encoding="utf-8"))["critical"] == rows
    with (folder / "critical-speed.csv").open(encoding="utf-8") as lines:
        assert [float(row["speed_m_s"]) for row in csv.DictReader(lines)] == [soft, hard]
    assert (folder / "critical-speed.png").read_bytes().startswith(b"\x89PNG")
    for row in rows:
        assert row["any_wave_m_s"] <= row["speed_m_s"] * 1.001
        assert row["speed_without_centrifugal_tension_m_s"] < row["speed_m_s"]
        assert row["radius_growth_m"] > 0.005


def test_a_drive_beyond_it_gets_a_warning(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    line = ["press", STUDY, "--critical-speed", "--set", "drive.speed=100 m/s", "--no-pictures", *COARSE]
    assert main(line) == 0
    assert "warning: the drive's 100 m/s are above the critical speed of" in capfd.readouterr().out


def test_a_tyre_that_tears_first_may_have_waves() -> None:
    """At 22 bar this tyre has no equilibrium from some 130 m/s on: no shape was looked at up to 200 m/s."""
    torn = CriticalSpeed(tf.study(STUDY), 2.2e6, None, None, None, 138.0, 10)
    (line,) = [line for line in _words([torn]).splitlines() if "kPa" in line]
    assert "none, or no equilibrium, below 200 m/s" in line


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--critical-speed", "--load", "3 kN"], "--load: no road acts on critical speeds"),
        (["--critical-speed", "--balanced"], "--balanced: no road acts on critical speeds"),
        (["--critical-speed", "--pressure", "2 bar, 0 bar"], "--pressure: '0 bar' is out of range"),
        (["--critical-speed", "--temperature", "60 degC"], "--temperature: no card gives 'softening'"),
        (["--temperature", "60 degC"], "--temperature: is for --critical-speed"),
    ],
)
def test_bad_input_is_one_line(refused: Callable[..., str], arguments: list[str], words: str) -> None:
    assert words in refused("press", STUDY, *arguments)
