"""The two meshers give the same temperatures."""

from __future__ import annotations

import pytest

import tyrefem as tf

#: K; the two meshes share nothing but the outline, so this bounds the error of both.
AGREEMENT = 0.1


@pytest.mark.usefixtures("needs_gmsh")
@pytest.mark.parametrize("name", ["nasa-22x5.5-8pr", "nasa-22x5.5-12pr"])
def test_every_sensor_agrees_at_default_size(name: str) -> None:
    study = tf.study(name)
    mapped = study.run().readings
    unstructured = study.replace({"mesh.mesher": "gmsh"}).run()
    assert unstructured.summary()["mesh"]["mesher"] == "gmsh"
    apart = (mapped - unstructured.readings).abs().max()
    assert set(study.sensors) <= set(apart.index)
    assert apart.max() < AGREEMENT, apart
