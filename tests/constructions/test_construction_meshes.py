"""Plies, belts and fillers that end: both meshers give every region, and no element is folded."""

from __future__ import annotations

import numpy as np
import pytest
from constructions import RADIALS

from tyrefem.geometry.meshing import build

BOUNDARIES = {"road", "outside_air", "rim", "contained_air", "symmetry"}


def faithful(mesh, section, tolerance):
    """Every region has its area and volume, and the elements fill the section without overlapping."""
    assert set(mesh.mesh.subdomains) == set(section.regions)
    assert set(mesh.mesh.boundaries) == BOUNDARIES
    for region in section.regions:
        assert mesh.area(region) == pytest.approx(section.area(region), rel=tolerance)
        assert mesh.volume(region) == pytest.approx(section.volume(region), rel=tolerance)
    assert (mesh.element_areas > 0).all()
    assert sum(map(len, mesh.mesh.subdomains.values())) == mesh.n_elements


@pytest.mark.parametrize("fineness", [1, 2])
@pytest.mark.parametrize("name", RADIALS)
def test_mapped_quadrilaterals(name, fineness):
    section = RADIALS[name].section
    mesh = build(section, size=RADIALS[name].size / fineness, through=1)
    faithful(mesh, section, 4e-3)
    # Right angles within 34 deg (where the tread thins out); ten rows of length per row of thickness, and what grading
    # adds.
    assert mesh.quality["scaled_jacobian"] > np.cos(np.radians(34))
    assert mesh.quality["edge_ratio"] < 15


@pytest.mark.parametrize("name", RADIALS)
def test_a_belt_ends_on_a_line_of_the_mesh(name):
    """Elements on either side of the belt's end, none across it; the layer goes on as another region."""
    section = RADIALS[name].section
    mesh = build(section, size=RADIALS[name].size, through=1)
    layer = next(candidate for candidate in section.layers if RADIALS[name].outermost_belt in candidate.regions.names)
    end = layer.regions.ends[0]
    belt = mesh.elements_between(0.0, end, RADIALS[name].outermost_belt)
    assert np.array_equal(belt, mesh.mesh.subdomains[RADIALS[name].outermost_belt])
    assert layer.regions.names[1] == "shoulder-cushion"


@pytest.mark.parametrize("name", RADIALS)
@pytest.mark.usefixtures("needs_gmsh")
def test_gmsh_triangles(name):
    section = RADIALS[name].section
    mesh = build(section, mesher="gmsh", size=RADIALS[name].size, through=1)
    faithful(mesh, section, 5e-3)
    assert mesh.quality["scaled_jacobian"] > 0.3
    assert mesh.quality["edge_ratio"] < 4


@pytest.mark.usefixtures("needs_gmsh")
def test_gmsh_quadrilaterals_are_not_inverted():
    """Recombined triangles: some are flat where a layer thins out, none is folded."""
    section = RADIALS["aircraft"].section
    faithful(build(section, mesher="gmsh", cell="quad", size=6e-3, through=1), section, 5e-3)
