"""Missing heat by station in watts: the volume integral of the patches."""

from __future__ import annotations

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.diagnose.heat.missing_heat import _watts
from tyrefem.diagnose.settings import DEFAULT
from tyrefem.diagnose.unknowns.heat_patches import stations

pytestmark = pytest.mark.fast


def test_the_heat_of_a_patch_is_its_volume_integral() -> None:
    """Patches overlap, so one of them is 1.5 times as wide as the distance between two."""
    study = tf.study("hidden-effect")
    section, places = study.section, np.array(stations(study, DEFAULT))
    width = round(section.line.length / DEFAULT.stations * 0.6, 6)
    s = np.linspace(0.0, section.line.length, 4001)
    per_length = 2 * 2 * np.pi * section.line.position(s)[:, 0] * np.asarray(section.rubber_thickness(s))
    shapes = np.exp(-(((s - places[:, None]) / width) ** 2) / 2)
    exact = np.trapezoid(1e5 * shapes * per_length, s, axis=1)
    watts = _watts(study, places, width, np.full(len(places), 1e5), np.zeros(len(places)))
    assert watts == pytest.approx(exact, rel=0.15)
    assert watts.sum() == pytest.approx(exact.sum(), rel=0.05)
