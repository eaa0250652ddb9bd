"""Temperatures at the section's own outline, which straight-sided elements do not quite reach."""

from __future__ import annotations

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.geometry.meshing.sagitta import kept_inside, sagitta
from tyrefem.simulation.surroundings import Surroundings

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


@pytest.mark.parametrize("size", ["3 mm", "6 mm"])
def test_a_camera_on_the_surface_reads_the_temperature_that_the_films_have(size: str) -> None:
    """k dT/dn = (1 - f) h_air (T - T_a) + f h_road (T - T_r); on the sidewall f = 0."""
    depths, ambient, road = (0.0, 0.4, 0.8, 1.2), 25.0, 45.0
    sensors = {
        f"{name}-{number}": {"s": s, "below_surface": f"{depth} mm"}
        for name, s in (("tread", "0.30 in"), ("sidewall", "3.95 in"))
        for number, depth in enumerate(depths)
    }
    drive = {"drive.duration": "300 s", "drive.ambient": f"{ambient} degC", "drive.road_temperature": f"{road} degC"}
    study = tf.study("nasa-22x5.5-8pr", {"mesh.size": size, "sensors": sensors, "output.every": "50 s", **drive})
    last, around = study.run().readings.iloc[-1], Surroundings(study)
    f, h_air, h_road = around.road_fraction(300.0), around.air_film(300.0), around.road_film(300.0)
    k = around.tread[0]
    for name, share in (("tread", f), ("sidewall", 0.0)):
        read, *inside = (float(last[f"{name}-{number}"]) for number in range(4))
        slope = float(np.polyfit([0.4e-3, 0.8e-3, 1.2e-3], inside, 2)[1])
        to_air, to_road = (1 - share) * h_air, share * h_road
        surface = (k * slope + to_air * ambient + to_road * road) / (to_air + to_road)
        assert read == pytest.approx(surface, abs=0.2), name


def test_points_in_the_mesh_stay_where_they_are(result: tf.Result) -> None:
    mesh, section = result.tyre.mesh, result.study.section
    s = np.linspace(0.0, section.line.length, 101)
    for share in (0.2, 0.5, 0.9):
        points = section.place(s, share * section.rubber_thickness(s))
        np.testing.assert_array_equal(kept_inside(mesh, points), points)
    outline = section.place(s, section.rubber_thickness(s))
    moved = np.linalg.norm(kept_inside(mesh, outline) - outline, axis=1)
    edges = mesh.mesh.p.T[mesh.mesh.facets[:, mesh.mesh.boundary_facets()].T]
    assert 0.0 < moved.max() <= sagitta(mesh, edges).max() + 1e-9
