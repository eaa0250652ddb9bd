"""What every mesh of a section must have, whichever mesher made it."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem.errors import InputError
from tyrefem.geometry import Section, load
from tyrefem.geometry.meshing import TyreMesh, build


@pytest.fixture(params=["nasa-22x5.5-8pr", "nasa-22x5.5-12pr"])
def section(request: pytest.FixtureRequest) -> Section:
    return load(request.param)


WAYS = [("mapped", "quad"), ("mapped", "tri"), ("gmsh", "tri"), ("gmsh", "quad")]
both = pytest.mark.parametrize(("mesher", "cell"), WAYS)


@both
def test_names_areas_and_volumes_at_the_default_size(section: Section, mesher: str, cell: str) -> None:
    tyre = build(section, mesher=mesher, cell=cell)
    assert set(tyre.mesh.subdomains) == set(section.regions)
    assert set(tyre.mesh.boundaries) == set(section.boundaries)
    assert tyre.quality["scaled_jacobian"] > 0
    assert tyre.element_areas.min() > 0
    for region in section.regions:
        assert tyre.area(region) == pytest.approx(section.area(region), rel=3e-3)
        assert tyre.volume(region) == pytest.approx(section.volume(region), rel=3e-3)
        points, weights = tyre.ring_points(region)
        assert weights.sum() == pytest.approx((2 if section.half else 1) * tyre.volume(region), rel=1e-12)
        assert points.shape == (2, len(weights))


@both
def test_every_facet_of_the_surface_has_one_name_and_every_element_one_region(
    section: Section, mesher: str, cell: str
) -> None:
    mesh = build(section, mesher=mesher, cell=cell, size=4e-3).mesh
    facets = np.concatenate(list(mesh.boundaries.values()))
    assert np.array_equal(np.sort(facets), mesh.boundary_facets())
    elements = np.concatenate(list(mesh.subdomains.values()))
    assert np.array_equal(np.sort(elements), np.arange(mesh.t.shape[1]))


@both
def test_boundaries_lie_where_the_section_says(section: Section, mesher: str, cell: str) -> None:
    tyre = build(section, mesher=mesher, cell=cell)
    length, shoulder = section.line.length, section.line.shoulder_s
    s, depth = section.locate(tyre.mesh.p.T)
    # Quadrilaterals from gmsh have nodes in the middle of straight edges, a chord's height off the surface.
    slack = 1e-9 if (mesher, cell) != ("gmsh", "quad") else 5e-5
    nodes = {name: tyre.mesh.facets[:, members].ravel() for name, members in tyre.mesh.boundaries.items()}
    assert np.abs(depth[nodes["contained_air"]]).max() < slack
    for name in ("road", "outside_air"):
        assert np.abs(depth - section.total_thickness(s))[nodes[name]].max() < slack
    assert s[nodes["road"]].max() == pytest.approx(shoulder, abs=1e-9)
    assert s[nodes["outside_air"]].min() == pytest.approx(shoulder, abs=1e-9)
    assert s[nodes["outside_air"]].max() == pytest.approx(section.outer.ends[1], abs=1e-9)
    assert s[nodes["rim"]].min() == pytest.approx(section.outer.ends[1], abs=1e-9)
    assert s[nodes["rim"]].max() == pytest.approx(length, abs=1e-9)
    assert np.abs(tyre.mesh.p[1, nodes["symmetry"]]).max() < 1e-12
    lengths = {name: _length(tyre, name) for name in section.boundaries}
    for name in section.boundaries:
        drawn = sum(np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in section.boundary_line(name, 1e-4))
        assert lengths[name] == pytest.approx(drawn, rel=2e-3)


def _length(tyre: TyreMesh, name: str) -> float:
    a, b = tyre.mesh.p[:, tyre.mesh.facets[:, tyre.mesh.boundaries[name]]].transpose(1, 0, 2)
    return float(np.hypot(*(a - b)).sum())


@both
def test_regions_lie_where_the_section_says(section: Section, mesher: str, cell: str) -> None:
    mesh = build(section, mesher=mesher, cell=cell).mesh
    centres = mesh.p[:, mesh.t].mean(axis=1).T
    assert set(mesh.subdomains) == set(section.regions)
    for region, members in mesh.subdomains.items():
        assert (section.region_at(*section.locate(centres[members])) == region).all()


@both
def test_full_mesh_is_the_half_and_its_mirror_image(section: Section, mesher: str, cell: str) -> None:
    half = build(section, mesher=mesher, cell=cell, size=4e-3)
    full = build(section.as_full(), mesher=mesher, cell=cell, size=4e-3)
    assert full.n_elements == 2 * half.n_elements
    assert set(full.mesh.boundaries) == set(half.mesh.boundaries) - {"symmetry"}
    on_plane = len(half.mesh.boundaries["symmetry"]) + 1
    assert full.n_nodes == 2 * half.n_nodes - on_plane
    assert full.element_areas.min() > 0
    nodes = full.mesh.p.T
    image = nodes * [1.0, -1.0]
    order, image_order = np.lexsort(nodes.T.round(10)), np.lexsort(image.T.round(10))
    assert np.allclose(nodes[order], image[image_order], atol=1e-9)
    for region in section.regions:
        assert full.area(region) == pytest.approx(2 * half.area(region), rel=1e-12)
    for name in full.mesh.boundaries:
        assert _length(full, name) == pytest.approx(2 * _length(half, name), rel=1e-12)
    facets = np.concatenate(list(full.mesh.boundaries.values()))
    assert np.array_equal(np.sort(facets), full.mesh.boundary_facets())


@both
def test_same_input_gives_the_same_mesh(section: Section, mesher: str, cell: str) -> None:
    first, two = (build(section, mesher=mesher, cell=cell, size=4e-3).mesh for _ in range(2))
    assert np.array_equal(first.p, two.p)
    assert np.array_equal(first.t, two.t)


@both
def test_line_at_the_shoulder_goes_through_all_layers(section: Section, mesher: str, cell: str) -> None:
    tyre = build(section, mesher=mesher, cell=cell)
    crown = tyre.elements_between(0.0, section.line.shoulder_s)
    side = tyre.elements_between(section.line.shoulder_s, section.line.length)
    assert len(crown) + len(side) == tyre.n_elements
    zoned = tyre.with_zones({"under tread": ("carcass", 0.0, section.line.shoulder_s)})
    assert np.array_equal(zoned.mesh.subdomains["under tread"], np.intersect1d(crown, tyre.mesh.subdomains["carcass"]))
    with pytest.raises(InputError, match="no line at"):
        tyre.elements_between(0.0, section.line.shoulder_s - 3.3e-4)


@both
def test_smaller_size_gives_more_elements_in_proportion(section: Section, mesher: str, cell: str) -> None:
    coarse, fine = (build(section, mesher=mesher, cell=cell, size=size, through=1).n_elements for size in (3e-3, 1e-3))
    assert 5 < fine / coarse < 11


@pytest.mark.parametrize(("mesher", "cell"), WAYS[:3])
def test_areas_converge_with_order_two(section: Section, mesher: str, cell: str) -> None:
    errors = []
    for size in (4e-3, 2e-3, 1e-3):
        tyre = build(section, mesher=mesher, cell=cell, size=size, through=1)
        errors.append(max(abs(tyre.volume(r) / section.volume(r) - 1) for r in section.regions))
    assert np.log2(errors[0] / errors[2]) / 2 > 1.6


@pytest.mark.parametrize("mesher", ["mapped", "gmsh"])
def test_layers_have_as_many_elements_through_them_as_asked(section: Section, mesher: str) -> None:
    tyre = build(section, mesher=mesher, size=4e-3, through=6)
    element_at = tyre.mesh.element_finder()
    for s in np.linspace(0.002, section.line.length - 0.002, 25):
        for layer, (low, high) in enumerate(zip([0.0, *_tops(section, s)[:-1]], _tops(section, s), strict=True)):
            # The outline of the mesh is a chord's height, some 0.04 mm, off the section's.
            depths = np.linspace(low + 1e-4, high - 1e-4, 400)
            points = section.place(np.full(400, s), depths)
            elements = element_at(*points.T)
            assert len(np.unique(elements)) >= 6, (layer, s)


def _tops(section: Section, s: float) -> list[float]:
    faces = section.interfaces(s)
    return [float(face - faces[0]) for face in faces[1:]]


def test_meshes_can_be_compared_and_counted() -> None:
    """An equality of scikit-fem's meshes has no truth value: ``mesh in meshes`` ended with a ValueError of numpy."""
    first, second = (build(load("nasa-22x5.5-8pr"), size=12e-3, through=1) for _ in range(2))
    assert first == first
    assert first != second
    assert len({first, second}) == 2


@pytest.mark.parametrize(
    ("arguments", "field", "words"),
    [
        ({"mesher": "maped"}, "mesher", "did you mean 'mapped'"),
        ({"cell": "hex"}, "cell", "quad, tri"),
        ({"size": 0.0}, "size", "positive length"),
        ({"size": float("nan")}, "size", "positive length"),
        ({"size": 2e-6}, "size", "nodes; that takes about .* GiB of memory"),
        ({"size": 2.0}, "size", "too coarse"),
        ({"through": 0}, "through", "1 or more"),
        ({"through": "2"}, "through", "1 or more, not '2'"),
        ({"size": "2 mm"}, "size", "positive length, not '2 mm'"),
        ({"section": "nasa-22x5.5-8pr"}, "section", "must be a section, as tyrefem.geometry.load gives it"),
    ],
)
def test_bad_requests_name_the_field(arguments: dict[str, object], field: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as error:
        build(**{"section": load("nasa-22x5.5-8pr"), **arguments})  # type: ignore[arg-type]
    assert error.value.field == field
