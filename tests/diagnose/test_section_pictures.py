"""Deviations on the section: each state on its own side, sensors at the crown too."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.collections import PathCollection

import tyrefem as tf
from tyrefem.diagnose.heat.courses import FREE
from tyrefem.diagnose.heat.sources import UnknownSource
from tyrefem.diagnose.unknowns.heat_patches import ALL_LAYERS
from tyrefem.reports import diagnosis_figures
from tyrefem.reports.diagnosis_energy import sensor_stations
from tyrefem.reports.diagnosis_heat import heat_course_figure
from tyrefem.reports.diagnosis_sections import _residuals

SECTION = tf.study("nasa-22x5.5-8pr").section


def test_a_sensor_at_the_crown_has_each_state_on_its_own_side() -> None:
    crown = tuple(float(x) for x in SECTION.place(0.0, 0.004))
    drawn = _residuals(SECTION, {"crown": crown}, {"original": {"crown": -5.7}, "amended": {"crown": 0.1}}, 5.7)
    axes = drawn.axes[0]
    sides = {text.get_text(): text.get_position()[0] for text in axes.texts}
    assert sides["crown -5.7 K"] < 0 < sides["crown +0.1 K"]
    first, second = (points.get_offsets()[0][0] for points in axes.collections if isinstance(points, PathCollection))
    assert first < 0 < second


def test_a_sensor_has_its_tick_however_its_place_is_given() -> None:
    r, z = (float(x) for x in SECTION.place(0.03, 0.004))
    sensors = {"a": {"s": "20 mm", "depth": "2 mm"}, "b": {"at": [f"{r} m", f"{z} m"]}, "c": {"place": "crown-inner"}}
    study = tf.study("nasa-22x5.5-8pr", {"sensors": sensors})
    np.testing.assert_allclose(sensor_stations(study), [0.02, 0.03, 0.0], atol=1e-4)
    assert sensor_stations(study.replace({"sensors": {}})) == []


def test_the_course_of_heat_names_no_file_and_long_runs_leave_its_place_free() -> None:
    knots, runs = np.linspace(0.0, 600.0, 5), [f"proving ground, north course, lap {number}" for number in range(3)]
    source = UnknownSource(
        station=0.011, where=ALL_LAYERS, inside=True, amount=1e5, sd=1e4, stations={0.011: 1.0},
        depths={ALL_LAYERS: 1.0}, kind=FREE, kinds={FREE: 1.0}, time=math.nan, time_sd=math.nan,
        strength=(np.full(5, 1e5),) * 3, strength_sd=(np.full(5, 1e4),) * 3, gain=9.0,
    )  # fmt: skip
    over_time: Any = SimpleNamespace(
        sources=(source,), knots=(knots,) * 3, rolling=(np.ones(5, dtype=bool),) * 3, runs=runs
    )
    d: Any = SimpleNamespace(original=SimpleNamespace(section=SECTION))
    drawn = heat_course_figure(d, over_time)
    axes = drawn.axes[0]
    assert [text.get_text() for text in axes.texts] == ["It changes over time"]
    drawn.draw_without_rendering()
    renderer = drawn.canvas.get_renderer()  # type: ignore[attr-defined]
    legend, place = axes.get_legend(), axes._left_title  # type: ignore[attr-defined]
    assert not legend.get_window_extent(renderer).overlaps(place.get_window_extent(renderer))


def test_names_of_the_longest_sets_begin_on_the_paper(monkeypatch: pytest.MonkeyPatch) -> None:
    names = ["heat-capacity-temperature", "hot-road", "loss-temperature-law", "wind"]
    monkeypatch.setattr(diagnosis_figures, "set_rows", lambda d, most: [{"effects": names, "probability": 0.04}])
    monkeypatch.setattr(diagnosis_figures, "candidate_rows", lambda d: [])
    best: Any = SimpleNamespace(members=(), key="no effect")
    d: Any = SimpleNamespace(best=best, judgement=SimpleNamespace(best=best))
    drawn = diagnosis_figures.probabilities_figure(d)
    drawn.draw_without_rendering()
    renderer = drawn.canvas.get_renderer()  # type: ignore[attr-defined]
    assert drawn.axes[0].get_yticklabels()[0].get_window_extent(renderer).x0 > 2
