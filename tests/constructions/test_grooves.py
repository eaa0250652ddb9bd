"""Circumferential grooves: cut out of section, meshes and footprint; their walls are cooled by the air."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from constructions import RADIALS

import tyrefem as tf
from tyrefem.geometry import Section, load
from tyrefem.geometry.meshing import build
from tyrefem.geometry.wall import wall_of
from tyrefem.materials.cord_layers import masses
from tyrefem.mechanics.footprint.press import Pressed, press
from tyrefem.reports.figures.footprint import pressure_map
from tyrefem.variants.answers import answers

ROAD_TYRES = ("passenger", "truck")
SMOOTH = {"section.grooves.width": "0 mm"}


def smooth(name: str) -> Section:
    return tf.study(RADIALS[name].study, SMOOTH).section


def length(mesh, boundary: str) -> float:
    ends = mesh.mesh.p[:, mesh.mesh.facets[:, mesh.mesh.boundaries[boundary]]]
    return float(np.hypot(*(ends[:, 1] - ends[:, 0])).sum())


@pytest.mark.usefixtures("needs_gmsh")
@pytest.mark.parametrize(("name", "mesher"), [("passenger", "mapped"), ("truck", "mapped"), ("passenger", "gmsh")])
def test_the_walls_of_grooves_belong_to_the_air(name, mesher):
    """What the road loses the air gains: bottoms at the depth of the tread, and two walls of every groove."""
    size = RADIALS[name].size
    grooved, whole = RADIALS[name].section, smooth(name)
    meshes = [build(shape, size=size, mesher=mesher, through=1) for shape in (grooved, whole)]
    tops = bottoms = walls = 0.0
    for start, end in grooved.grooves:
        s = np.linspace(start, end, 40)
        for total, index in (("tops", -1), ("bottoms", -2)):
            line = grooved.line.position(s) + grooved.interfaces(s)[index][:, None] * grooved.line.normal(s)
            run = float(np.hypot(*np.diff(line, axis=0).T).sum())
            tops, bottoms = (tops + run, bottoms) if total == "tops" else (tops, bottoms + run)
        walls += float(grooved.thickness(grooved.layers[-1].name, np.array([start, end])).sum())
    assert length(meshes[1], "road") - length(meshes[0], "road") == pytest.approx(tops, rel=0.01)
    gained = length(meshes[0], "outside_air") - length(meshes[1], "outside_air")
    assert gained == pytest.approx(bottoms + walls, rel=0.01)
    assert {len(set(shape.mesh.boundaries)) for shape in meshes} == {5}
    assert len(meshes[0].mesh.boundary_facets()) == sum(map(len, meshes[0].mesh.boundaries.values()))


@pytest.mark.parametrize("name", ROAD_TYRES)
def test_a_fifth_of_the_tread_is_groove(name):
    cards = tf.study(RADIALS[name].study).materials
    grooved, whole = (masses(shape, cards) for shape in (RADIALS[name].section, smooth(name)))
    assert 0.15 < 1 - grooved["tread"] / whole["tread"] < 0.3
    assert {region: grooved[region] for region in grooved if region != "tread"} == pytest.approx(
        {region: whole[region] for region in whole if region != "tread"}
    )


def test_a_place_in_a_groove_is_no_rubber():
    section = load("truck-295-80r22.5")
    (start, end), *_ = section.grooves
    middle, total = (start + end) / 2, float(section.total_thickness((start + end) / 2))
    bottom = total - float(section.thickness(section.layers[-1].name, middle))
    assert str(section.region_at(middle, total - 1e-3)) == "groove"
    inside = section.contains(
        section.place([middle, middle, start - 1e-3], [bottom - 1e-4, bottom + 1e-4, total - 1e-4])
    )
    assert inside.tolist() == [True, False, True]
    assert "groove" not in section.regions


def test_wear_leaves_the_bottoms_of_grooves_where_they_are():
    new = load("truck-295-80r22.5")
    worn = new.worn("tread", 0.6)
    at = np.array(new.grooves).mean(axis=1)
    assert worn.interfaces(at)[-2] == pytest.approx(new.interfaces(at)[-2], abs=1e-12)
    left = worn.thickness(new.layers[-1].name, at) / new.thickness(new.layers[-1].name, at)
    assert left == pytest.approx(0.4, abs=1e-9)


@pytest.mark.parametrize(
    ("changes", "field", "words"),
    [
        ({"section.grooves.at": ["17 mm", "20 mm"]}, "grooves.at.1", "does not lie within one part"),
        ({"section.grooves.at": ["90 mm"]}, "grooves.at.0", "beyond 'road'"),
        ({"section.grooves.width": "-1 mm"}, "grooves.width", "at least 0"),
        ({"section.grooves.boundary": "outside-air"}, "grooves.boundary", "did you mean 'outside_air'"),
    ],
)
def test_impossible_grooves_are_refused(changes, field, words):
    with pytest.raises(tf.InputError, match=words) as caught:
        tf.study("passenger-205-55r16", changes)
    assert str(caught.value.field).endswith(field)


@functools.cache
def pressed(width: str) -> Pressed:
    return press(
        tf.study("passenger-205-55r16", {"mesh.size": "12 mm", "section.grooves.width": width}), motion="linear"
    )


def test_the_footprint_is_as_wide_as_its_outline_and_empty_in_the_grooves():
    footprint = pressed("9 mm").footprint
    # Shoulder ribs touch: the whole tread's width, grooves included.
    assert footprint.width == pytest.approx(pressed("0 mm").footprint.width, rel=0.02)
    _, z, pressure = pressure_map(footprint)
    for low, high in footprint.grid.tread.grooves:
        within = (np.abs(z) > low + 1e-7) & (np.abs(z) < high - 1e-7)
        assert within.sum() == 4
        assert (pressure[within] == 0).all()
    assert footprint.area < footprint.length * (footprint.width - 4 * 8.9e-3)


def test_ribs_that_bulge_into_grooves_lose_more_than_a_slick():
    """Less rubber carries the load and is free at its sides; slicks and worn tyres are known to roll easier."""
    grooved, slick = (pressed(width).loss.coefficient for width in ("9 mm", "0 mm"))
    assert 1.03 < grooved / slick < 1.5


def test_the_wall_ends_at_the_bottoms_of_grooves():
    """Its gradient is asked of every variant of a sweep: both surfaces are in the mesh, and as far apart as is said."""
    quick = {
        "mechanics.strain": "given", "mesh.size": "8 mm", "mesh.element": "P1", "drive.duration": "60 s",
        "output.every": "20 s",
    }  # fmt: skip
    tyre = tf.study(RADIALS["passenger"].study, quick)
    result = tyre.run()
    section = tyre.section
    wall = wall_of(result.tyre.mesh)
    across = section.in_groove(wall.s)
    assert across.any()
    thinner = section.total_thickness(wall.s) - wall.thickness
    assert (thinner[across] > 5e-3).all()
    assert (thinner[~across] == 0).all()
    apart = np.hypot(*(wall.outer - wall.inner).T)
    np.testing.assert_allclose(apart, wall.thickness, atol=3e-3)
    assert section.contains(wall.outer).all()
    s, steep = result.wall_gradient
    assert len(s) == len(wall.s)
    assert np.isfinite(steep).all()
    assert answers(result)["gradient_K_m"] == steep.max()


def test_a_sensor_stated_in_a_groove_is_refused():
    (start, end), *_ = RADIALS["passenger"].section.grooves
    middle = f"{(start + end) / 2 * 1e3:.2f} mm"
    inside = float(RADIALS["passenger"].section.total_thickness((start + end) / 2)) - 1e-3
    sensor = {"s": middle, "depth": f"{inside * 1e3:.2f} mm"}
    with pytest.raises(tf.InputError, match=r"sensors\.hollow: depth = .* mm is outside the rubber"):
        tf.study(RADIALS["passenger"].study, {"sensors.hollow": sensor})


MIDDLE = {"at": ["0 mm"], "width": "9 mm", "source": "test"}


def test_a_groove_at_the_mid_plane_is_a_groove_there_too():
    section = load({"base": "nasa-22x5.5-8pr", "grooves": MIDDLE})
    assert section.in_groove([0.0, 0.004, 0.005]).tolist() == [True, True, False]
    np.testing.assert_allclose(section.rubber_thickness(0.0), section.thickness("carcass", 0.0))
    r = section.outer_diameter / 2 - 1e-3
    assert section.contains([[r, 0.0], [r, 1e-3]]).tolist() == [False, False]
    (line,) = section.boundary_line("symmetry")
    mesh = build(section, size=4e-3)
    assert float(np.hypot(*np.diff(line[[0, -1]], axis=0)[0])) == pytest.approx(length(mesh, "symmetry"))
    with pytest.raises(tf.InputError, match="outside the rubber, which is 5"):
        tf.study("nasa-22x5.5-8pr", {"section.grooves": MIDDLE, "sensors.x": {"s": "0 mm", "depth": "8 mm"}})


def test_a_run_with_a_groove_at_the_mid_plane_ends_with_its_warnings():
    study = tf.study("nasa-22x5.5-8pr", {"section.grooves": MIDDLE, "mesh.size": "8 mm", "drive.duration": "10 s"})
    assert isinstance(study.run().warnings, tuple)
