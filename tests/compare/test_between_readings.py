"""Computed readings that are too far apart in time for the measured ones: interpolated in between, with a note."""

from __future__ import annotations

import numpy as np
import pytest
from toy_study import Phase

import tyrefem as tf
from tyrefem.compare.between_readings import bend

COARSE = {"mesh.size": "12 mm", "mesh.through": 1}
LAP = [
    {"name": f"{name} {lap}", "duration": duration, "speed": "60 mph", **slip}
    for lap in range(2)
    for name, duration, slip in (("straight", "12 s", {}), ("braking", "3 s", {"slip_ratio": 0.1}))
]
SENSORS = {"infrared": {"s": "10 mm", "below_surface": "0 mm", "lag": "0 s"}, "deep": {"s": "10 mm", "depth": "2 mm"}}


def test_a_parabola_between_two_readings_is_off_by_a_quarter_of_its_bend() -> None:
    saved = np.arange(0.0, 50.0, 10.0)
    times = np.linspace(0.0, 40.0, 41)
    exact = 20.0 + 0.03 * times**2
    off = np.interp(times, saved, 20.0 + 0.03 * saved**2) - exact
    assert bend(saved, 20.0 + 0.03 * saved**2, times, []) == pytest.approx(off, abs=1e-9)


def test_a_kink_between_phases_is_no_error() -> None:
    saved, times = np.arange(0.0, 41.0, 5.0), np.linspace(0.0, 40.0, 81)
    readings = np.where(saved < 20.0, 25.0, 25.0 + 2.0 * (saved - 20.0))
    assert bend(saved, readings, times, []).max() > 1.0
    phases = [Phase("rest", 0.0, 20.0), Phase("rolling", 20.0, 40.0)]
    assert bend(saved, readings, times, phases).max() == 0.0


def test_few_readings_need_no_note() -> None:
    assert bend(np.array([0.0, 1.0]), np.array([20.0, 30.0]), np.array([0.5]), []).tolist() == [0.0]
    assert bend(np.array([0.0, 1.0, 2.0]), np.array([20.0, 30.0, 20.0]), np.array([]), []).size == 0


def test_a_surface_that_brakes_needs_readings_as_often_as_the_logger_has_them() -> None:
    study = tf.study("nasa-22x5.5-8pr", COARSE | {"drive.phases": LAP, "sensors": SENSORS, "output.every": "0.1 s"})
    table = study.run().readings[["time_s", "infrared", "deep"]]
    fine, coarse = (each.compare(table, inputs=False) for each in (study, study.replace({"output.every": "5 s"})))
    assert fine.rms_K == 0.0
    assert not any("interpolated" in note for note in fine.notes)
    assert coarse.by_sensor["infrared"] > 1.0, "the same study is off by that much"
    (note,) = [note for note in coarse.notes if "interpolated" in note]
    assert "run 'measured'" in note
    assert "infrared" in note
    assert "deep" not in note
    assert '[output] every = "0.1 s"' in note
