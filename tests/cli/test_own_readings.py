"""A run's own readings are a measured table: the run has no gap to them."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import pytest
from terminal import BARE

from tyrefem.cli import main

QUICK = ("--set", "mesh.size=8 mm", "--set", "drive.phases.0.duration=40 s", "--set", "drive.phases.1.duration=20 s")


@pytest.fixture
def readings(here: Path, capfd: pytest.CaptureFixture[str]) -> Path:
    assert main(["run", "example-validation", *QUICK, *BARE, "--out", "run"]) == 0
    capfd.readouterr()
    return here / "run/readings.csv"


def test_read_by_check_and_compare(readings: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(readings)]) == 0
    assert "left out: contained-air pressure [kPa]" in capfd.readouterr().out
    assert main(["compare", "example-validation", str(readings), *QUICK, "--no-inputs", "--out", "out", "--json"]) == 0
    compared = json.loads(capfd.readouterr().out)
    assert "contained-air" in compared["rms_by_sensor_K"]
    assert compared["overall"]["rms_K"] < 1e-3


def test_compare_renames_a_loggers_columns(readings: Path, capfd: pytest.CaptureFixture[str]) -> None:
    text = readings.read_text(encoding="utf-8").replace("crown-inner", "T1").replace("crown-middle", "T2")
    readings.write_text(text, encoding="utf-8")
    options = (*QUICK, "--no-inputs", "--out", "out")
    assert main(["compare", "example-validation", str(readings), *options]) == 2
    assert "columns 'T1', 'T2' are no sensors" in capfd.readouterr().err
    names = ("--rename", "T1=crown-inner", "--rename", "T2=crown-middle")
    assert main(["compare", "example-validation", str(readings), *options, *names]) == 0
    assert pd.read_csv("out/residuals.csv")["error_K"].abs().max() < 1e-3


def test_times_of_a_long_run_stay_apart(here: Path) -> None:
    """After a week, half a second is told apart: six digits would give three rows the same time."""
    import tyrefem as tf
    from tyrefem.measured import read_table

    study = tf.study("nasa-22x5.5-8pr", {
        "mesh.size": "12 mm", "drive.duration": "7 day", "drive.speed": "0 mph", "output.every": "25200.5 s",
    })  # fmt: skip
    result = study.run()
    result.save(here / "long")
    (run,) = read_table(here / "long/readings.csv")
    assert run.times == pytest.approx(result.times, rel=1e-9)
