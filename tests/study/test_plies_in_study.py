"""Conductivity along and across the plies, in a study."""

from __future__ import annotations

import numpy as np

import tyrefem as tf

SHORT = {"drive.duration": "60 s", "mesh.size": "4 mm", "mesh.element": "P1"}


def test_conduction_along_the_plies_is_the_same_on_both_sides() -> None:
    plies = {"along": "0.4 W/m/K", "across": "0.2 W/m/K", "source": "estimate: for this test"}
    study = tf.study("nasa-22x5.5-8pr").replace(SHORT)
    tilted = study.replace({"materials.carcass.conductivity": plies})
    half = tilted.run().readings
    full = tilted.replace({"mesh.section": "full"}).run().readings
    assert np.abs(half - full).to_numpy().max() < 1e-6
    assert np.abs(half - study.run().readings).to_numpy().max() > 0.05
