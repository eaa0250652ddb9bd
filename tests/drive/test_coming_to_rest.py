"""A tyre that rolls out: its rolling resistance, and what its report says of it."""

from __future__ import annotations

import functools
import re

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.cli.run import _words

COARSE = {"mesh.size": "12 mm", "mesh.element": "P1", "output.every": "2 s"}


@functools.cache
def rolls(begins: str, ends: str, **changes: str) -> tf.Result:
    speed = {"drive.speed": {"from": begins, "to": ends}, "drive.duration": "20 s"}
    return tf.study("nasa-22x5.5-8pr").replace({**COARSE, **speed, **changes}).run()


def test_a_tyre_that_comes_to_rest_has_the_rolling_resistance_of_its_last_reading_before():
    """Loss per revolution does not depend on speed, so cold it is that of steady rolling."""
    out, steady = rolls("20 m/s", "0 m/s").rolling_resistance, rolls("20 m/s", "20 m/s").rolling_resistance
    assert out.phase == "rolling"
    assert out.cold_force == pytest.approx(steady.cold_force, rel=1e-6)
    assert 0.9 * out.cold_force < out.force < out.cold_force
    assert rolls("20 m/s", "0 m/s").rolling_reading == len(rolls("20 m/s", "0 m/s").times) - 2


@pytest.mark.parametrize(("ends", "words"), [("0 m/s", ", last reading before rest in rolling\n"), ("10 m/s", ")\n")])
def test_the_command_says_when_the_resistance_is_read(ends, words):
    line = next(line for line in _words(rolls("20 m/s", ends)).splitlines(keepends=True) if "rolling resist" in line)
    assert line.endswith(words)


def test_without_a_reading_before_rest_there_is_none():
    brief = rolls("20 m/s", "0 m/s", **{"drive.duration": "1 s", "output.fields": 2})
    assert list(brief.times) == [0.0, 1.0]
    assert brief.rolling_reading is None
    assert brief.rolling_resistance.force == 0


@pytest.mark.parametrize(("ends", "shown"), [("0 m/s", "–"), ("10 m/s", "number")])
def test_the_report_has_no_drag_at_rest(tmp_path, ends, shown):
    """Power and speed of the last instant, both next to nothing, gave a hundred times the force."""
    result = rolls("20 m/s", ends)
    page = result.report(tmp_path / "report.html").read_text(encoding="utf-8")
    cells = re.findall(r"<td[^>]*>([^<]*)</td>", page[page.index("drag [N]") :])
    drag = cells[10]
    assert cells[0] == "rolling"
    if shown == "–":
        assert drag == "–"
    else:
        assert float(drag) == pytest.approx(result.rolling_resistance.force, rel=0.01)


def test_a_phase_that_ends_at_an_unround_time_has_its_own_resistance():
    """Three times 10.1 s are 30.299999999999997 s: a reading at 30.3 s has the power after the wheel has stopped."""
    speeds = {"slow": "5 mph", "slower": "4 mph", "fast": "20 mph", "rest": "0 mph"}
    phases = [{"name": name, "duration": "10.1 s", "speed": speed} for name, speed in speeds.items()]
    result = tf.study("nasa-22x5.5-8pr").replace({**COARSE, "drive.phases": phases}).run()
    assert {*result.tyre.drive.starts, result.tyre.drive.end} <= set(result.times.tolist())
    assert np.diff(result.times).min() > 1e-6
    out = result.rolling_resistance
    assert out.phase == "fast"
    assert 0.9 * out.cold_force < out.force < out.cold_force


@pytest.mark.parametrize("carried", ["load", "deflection"])
def test_a_tyre_that_leaves_the_road_has_the_resistance_of_its_last_reading_on_it(carried):
    """Heat and load of the last instant, both next to nothing, gave a tenth of the coefficient."""
    first = {"load": "2700 lbf", "deflection": "30 mm"}[carried]
    drive = {key: value for key, value in tf.study("nasa-22x5.5-8pr").data["drive"].items() if key != "load"}
    lifts = {**drive, "duration": "20 s", carried: {"from": first, "to": first.replace(first.split()[0], "0")}}
    result = tf.study("nasa-22x5.5-8pr").replace({**COARSE, "drive": lifts}).run()
    out = result.rolling_resistance
    assert result.rolling_reading == len(result.times) - 2
    assert 0.9 * out.cold_coefficient < out.coefficient < out.cold_coefficient
    assert "last reading under load in rolling\n" in _words(result)
