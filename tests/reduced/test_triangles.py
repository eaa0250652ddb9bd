"""Reduced models on meshes of six-node triangles, whose corners have no volume of their own."""

from __future__ import annotations

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.reduced.training import hot_nodes, snapshots, weight

QUICK = {"mesh.size": "10 mm", "mesh.mesher": "gmsh", "drive.duration": "120 s"}


@pytest.mark.usefixtures("needs_gmsh")
@pytest.mark.parametrize("element", ["P1", "P2"])
def test_every_node_of_triangles_counts(element: str) -> None:
    result = tf.study("nasa-22x5.5-8pr", {**QUICK, "mesh.element": element}).run()
    weights = weight(result.tyre, hot_nodes(result.tyre, [snapshots(result, 3)]))
    assert (weights > 0).all()
    assert weights.sum() == pytest.approx(1.0)


@pytest.mark.usefixtures("needs_gmsh")
def test_variants_on_triangles_by_a_reduced_model_are_the_runs_of_their_studies() -> None:
    study = tf.study("nasa-22x5.5-8pr", QUICK)
    table = study.sweep({"drive.speed": ("10 mph", "20 mph", 12)}, reduced="always").table
    assert (table["by"] == "reduced").all()
    for place in (0, 6):
        row = table.iloc[place]
        run = study.replace({"drive.speed": f"{row['drive.speed [mph]']:.9g} mph"}).run()
        assert row["hottest_degC"] == pytest.approx(run.history.maximum.temperature, abs=0.01)
        ends = [run.readings[name].iloc[-1] for name in study.sensors]
        assert np.abs([row[f"{name}_degC"] for name in study.sensors] - np.array(ends)).max() < 0.01


@pytest.mark.usefixtures("needs_gmsh")
def test_a_page_with_sliders_of_a_gmsh_mesh() -> None:
    box = tf.study("nasa-22x5.5-8pr", QUICK).explore({"drive.speed": ("10 mph", "20 mph")})
    assert box.certificate.worst < 0.3
