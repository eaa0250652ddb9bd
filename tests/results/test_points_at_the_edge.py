"""Temperatures at the section's own outline, which straight-sided elements do not quite reach."""

from __future__ import annotations

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.geometry.meshing.sagitta import sagitta

pytestmark = pytest.mark.fast


@pytest.fixture(scope="module")
def result() -> tf.Result:
    return tf.study("nasa-22x5.5-8pr", {"mesh.size": "8 mm", "drive.duration": "30 s"}).run()


def test_the_whole_outline_can_be_read(result: tf.Result) -> None:
    section = result.study.section
    s = np.linspace(0.0, section.line.length, 301)
    thickness = section.rubber_thickness(s)
    for depth in (np.zeros_like(s), thickness):
        on_outline = result.at(section.place(s, depth))
        close = result.at(section.place(*section.clamp(s, depth, 2e-4)))
        assert np.abs(on_outline - close).max() < 1.0


def test_a_point_beyond_the_outline_is_an_error_that_names_it(result: tf.Result) -> None:
    section = result.study.section
    inside, beyond = section.place([0.02, 0.02], section.rubber_thickness([0.02, 0.02]) + np.array([-0.001, 0.0004]))
    with pytest.raises(tf.InputError, match=rf"point \({beyond[0]:.6g}, {beyond[1]:.6g}\) m lies 0\.0004\d* m outside"):
        result.at([inside, beyond])
    with pytest.raises(tf.InputError, match="outside the mesh"):
        result.at([(0.1, 0.0)])


def test_the_sagitta_of_an_arc_is_h2_over_8r(result: tf.Result) -> None:
    mesh = result.tyre.mesh
    ends = mesh.mesh.p.T[mesh.mesh.facets[:, mesh.mesh.boundaries["road"]].T]
    middle = ends.mean(axis=1)
    on_crown = np.abs(middle[:, 1]) < 0.03
    h = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)[on_crown]
    line, section = result.study.section.line, result.study.section
    radius = line.crown_radius + float(section.interfaces(0.0)[-1])
    # Towards the shoulder the tread gets thinner, so that its outside is curved a little more.
    assert sagitta(mesh, ends[on_crown]) == pytest.approx(h**2 / (8 * radius), rel=0.02)
