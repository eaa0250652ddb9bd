"""Deviations on the section: each state on its own side, sensors at the crown too."""

from __future__ import annotations

import numpy as np
from matplotlib.collections import PathCollection

import tyrefem as tf
from tyrefem.reports.diagnosis_energy import sensor_stations
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
