"""A run in which rubber gets hotter than it bears says so."""

from __future__ import annotations

import tyrefem as tf

SMALL = {"mesh.size": "12 mm", "drive.duration": "20 min"}


def test_a_run_with_hot_rubber_warns_with_region_and_temperature() -> None:
    result = tf.study("nasa-22x5.5-8pr", SMALL).scaled("materials.carcass.loss_tangent.value", 8.0).run()
    hottest = result.peaks["tyre"]
    assert hottest.temperature > 150
    (warning,) = (each for each in result.warnings if "loses its strength" in each)
    assert f"{hottest.temperature:.0f} degC at {hottest.time:g} s" in warning
    assert warning.split(":")[0] in result.study.section.regions


def test_a_run_at_usual_temperatures_does_not_warn() -> None:
    result = tf.study("nasa-22x5.5-8pr", SMALL).run()
    assert not any("loses its strength" in each for each in result.warnings)
