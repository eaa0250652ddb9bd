"""Meshes to files and back, and files that are refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.geometry import Division, Section, load
from tyrefem.geometry.meshing import TyreMesh, build, read, read_for, write

pytestmark = pytest.mark.fast


@pytest.fixture(scope="module")
def section() -> Section:
    return load("nasa-22x5.5-8pr")


@pytest.fixture(scope="module")
def tyre(section: Section) -> TyreMesh:
    return build(section, size=5e-3)


def square(cell_sets: bool = True, **changes: object) -> meshio.Mesh:
    """Two unit squares side by side in mm, named ``left`` and ``right``; the surface is ``skin``."""
    points = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]], dtype=float)
    quads = np.array([[0, 1, 4, 3], [1, 2, 5, 4]])
    lines = np.array([[0, 1], [1, 2], [2, 5], [5, 4], [4, 3], [3, 0]])
    sets = {"left": [[0], []], "right": [[1], []], "skin": [[], [0, 1, 2, 3, 4, 5]]}
    sets |= changes.pop("sets", {})  # type: ignore[operator, arg-type]
    arrays = {name: [np.array(part, dtype=int) for part in parts] for name, parts in sets.items()}
    return meshio.Mesh(points, [("quad", quads), ("line", lines)], cell_sets=arrays if cell_sets else {}, **changes)


def given(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, mesh: meshio.Mesh) -> Path:
    """A path that meshio reads as this mesh: for groups that meshio reads in formats it does not write."""
    path = tmp_path / "given.med"
    path.touch()
    monkeypatch.setattr(meshio, "read", lambda _: mesh)
    return path


@pytest.mark.parametrize("suffix", [".msh", ".vtu", ".vtk"])
@pytest.mark.parametrize("cell", ["quad", "tri"])
@pytest.mark.parametrize("half", [True, False])
def test_round_trip(section: Section, tmp_path: Path, suffix: str, cell: str, half: bool) -> None:
    section = section if half else section.as_full()
    tyre = build(section, size=5e-3, cell=cell)
    back = read_for(section, write(tyre, tmp_path / f"tyre{suffix}"))
    assert (back.mesher, back.cell, back.section) == ("file", cell, section)
    assert np.allclose(back.mesh.p, tyre.mesh.p, atol=1e-15)
    assert np.array_equal(back.mesh.t, tyre.mesh.t)
    for name, members in tyre.mesh.subdomains.items():
        assert np.array_equal(back.mesh.subdomains[name], members)
    for name, members in tyre.mesh.boundaries.items():
        assert np.array_equal(np.sort(back.mesh.boundaries[name]), np.sort(members))


def test_units_and_axes(section: Section, tyre: TyreMesh, tmp_path: Path) -> None:
    path = write(tyre, tmp_path / "tyre.msh")
    mesh_data = meshio.read(path)
    mesh_data.points = mesh_data.points[:, [1, 0, 2]] * 1e3
    meshio.write(path, mesh_data, file_format="gmsh22")
    back = read_for(section, path, axes="zr", unit="mm")
    assert np.allclose(back.mesh.p, tyre.mesh.p, atol=1e-12)
    assert back.element_areas.min() > 0
    with pytest.raises(InputError, match=r"e\+05 times the area .*wrong unit"):
        read_for(section, path, axes="zr")


def test_names_of_the_file_may_differ(section: Section, tyre: TyreMesh, tmp_path: Path) -> None:
    path = write(tyre, tmp_path / "tyre.msh")
    path.write_bytes(path.read_bytes().replace(b'"tread"', b'"LAUFFLAECHE"'))
    with pytest.raises(InputError, match=r"no region 'tread'.*LAUFFLAECHE") as error:
        read_for(section, path)
    assert error.value.file == path
    back = read_for(section, path, names={"LAUFFLAECHE": "tread"})
    assert back.area("tread") == pytest.approx(tyre.area("tread"))
    with pytest.raises(InputError, match="did you mean 'LAUFFLAECHE'"):
        read_for(section, path, names={"LAUFFLACHE": "tread"})


def test_cell_sets_and_planar_millimetres(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    path = given(monkeypatch, tmp_path, square())
    mesh = read(path, axes="xy", unit="mm", regions=["left", "right"], boundaries=["skin"])
    assert mesh.p.max() == pytest.approx(2e-3)
    assert mesh.subdomains["right"].tolist() == [1]
    assert np.array_equal(np.sort(mesh.boundaries["skin"]), mesh.boundary_facets())


def test_abaqus_element_sets(tmp_path: Path) -> None:
    path = tmp_path / "square.inp"
    path.write_text(
        "*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 2., 0., 0.\n4, 0., 1., 0.\n5, 1., 1., 0.\n6, 2., 1., 0.\n"
        "*ELEMENT, TYPE=CPS4, ELSET=LEFT\n1, 1, 2, 5, 4\n*ELEMENT, TYPE=CPS4, ELSET=RIGHT\n2, 2, 3, 6, 5\n"
        "*NSET, NSET=SKIN\n1, 2, 3, 4, 5, 6\n"
    )
    mesh = read(path, unit="mm", regions=["LEFT", "RIGHT"], boundaries=["SKIN"])
    assert mesh.t.shape[1] == 2
    assert len(mesh.boundaries["SKIN"]) == 6


def test_med_families(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    mesh_data = square(cell_sets=False, cell_data={"cell_tags": [np.array([-1, -2]), np.full(6, -3)]})
    mesh_data.cell_tags = {-1: ["left"], -2: ["right"], -3: ["skin"]}
    mesh = read(given(monkeypatch, tmp_path, mesh_data), regions=["left", "right"], boundaries=["skin"])
    assert mesh.subdomains["left"].tolist() == [0]


def test_quadratic_cells_are_read_by_their_corners(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    points = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]])
    cells = [("triangle6", np.array([[0, 1, 2, 3, 4, 5]])), ("line3", np.array([[0, 1, 3], [1, 2, 4], [2, 0, 5]]))]
    sets = {"body": [np.array([0]), np.array([], int)], "skin": [np.array([], int), np.array([0, 1, 2])]}
    mesh = read(given(monkeypatch, tmp_path, meshio.Mesh(points, cells, cell_sets=sets)), boundaries=["skin"])
    assert mesh.p.shape[1] == 3
    assert len(mesh.boundaries["skin"]) == 3


def test_lines_inside_the_body_are_no_boundary(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    mesh_data = square()
    mesh_data.cells.append(meshio.CellBlock("line", np.array([[1, 4]])))
    for parts in mesh_data.cell_sets.values():
        parts.append(np.array([], dtype=int))
    mesh_data.cell_sets["interface"] = [np.array([], int), np.array([], int), np.array([0])]
    mesh = read(given(monkeypatch, tmp_path, mesh_data))
    assert set(mesh.boundaries) == {"skin"}


@pytest.mark.parametrize(
    ("sets", "words"),
    [
        ({"right": [[], []]}, "1 of 2 elements belong to no region"),
        ({"right": [[0, 1], []]}, "1 of 2 elements belong to more than one region"),
        ({"skin": [[], [0, 1, 2, 3, 4]]}, "1 of 6 side.* belong to no boundary, one near r = 0 m, z = "),
        ({"again": [[], [0]]}, "1 of 6 side.* belong to more than one boundary"),
    ],
)
def test_every_part_needs_one_name(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, sets: dict[str, object], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        read(given(monkeypatch, tmp_path, square(sets=sets)))


def test_missing_names_say_what_was_found(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    path = given(monkeypatch, tmp_path, square())
    with pytest.raises(InputError, match="no boundary 'skim'; did you mean 'skin'"):
        read(path, boundaries=["skim"])
    with pytest.raises(InputError, match="no region 'tread'; found: left, right"):
        read(path, regions=["tread"])


def test_mixed_cells_are_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    mesh_data = meshio.Mesh(np.eye(4, 3), [("quad", np.array([[0, 1, 2, 3]])), ("triangle", np.array([[0, 1, 2]]))])
    with pytest.raises(InputError, match="all triangles or all quadrilaterals; found: quad, triangle"):
        read(given(monkeypatch, tmp_path, mesh_data))


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("tyre.msh", "not a mesh", "cannot be read as a mesh"),
        ("tyre.xyz0", "", "cannot be read as a mesh"),
        ("tyre.vtu", "<VTKFile", "cannot be read as a mesh"),
    ],
)
def test_files_that_are_no_mesh(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], name: str, text: str, words: str
) -> None:
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(InputError, match=words) as error:
        read(path)
    assert error.value.file == path
    assert capfd.readouterr().out == ""


def test_bad_arguments(tyre: TyreMesh, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such mesh file"):
        read(tmp_path / "nothing.msh")
    path = write(tyre, tmp_path / "tyre.msh")
    with pytest.raises(InputError, match="no axes 'rx'"):
        read(path, axes="rx")
    with pytest.raises(InputError, match="not a unit"):
        read(path, unit="kg")
    with pytest.raises(InputError, match="names cannot be kept"):
        write(tyre, tmp_path / "tyre.stl")
    with pytest.raises(InputError, match="cannot be written"):
        write(tyre, path / "tyre.msh")
    with pytest.raises(InputError, match="overlap"):
        write(tyre.with_zones({"zone": ("tread", 0.0, tyre.section.line.shoulder_s)}), tmp_path / "tyre.msh")


def test_a_failure_keeps_the_older_file(tyre: TyreMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write(tyre, tmp_path / "tyre.msh")
    before = path.read_bytes()

    def full_disk(target: Path, *_: object, **__: object) -> None:
        Path(target).write_bytes(b"half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(meshio, "write", full_disk)
    with pytest.raises(InputError, match=r"cannot be written: .*No space left"):
        write(tyre, path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def changed(tyre: TyreMesh, path: Path, change: Callable[[meshio.Mesh], None]) -> Path:
    """The tyre's file after a change of its points, cells and tags; cells[0] are elements, cells[1] lines."""
    content = meshio.read(write(tyre, path))
    change(content)
    meshio.write(path, content, file_format="gmsh22")
    return path


def moved(r: float = 0.0, z: float = 0.0, factor_z: float = 1.0) -> Callable[[meshio.Mesh], None]:
    def change(content: meshio.Mesh) -> None:
        content.points = content.points * [1.0, factor_z, 1.0] + [r, z, 0.0]

    return change


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (moved(factor_z=-1.0), "z is negative, down to .* a half section lies at z >= 0"),
        (moved(z=1e-3), r"boundary 'symmetry' is not at z = 0: up to 1 mm"),
        (moved(r=10e-3), "is at a mean radius of .* r is from the wheel's axis"),
    ],
)
def test_a_mesh_in_another_place_is_refused(
    section: Section, tyre: TyreMesh, tmp_path: Path, change: Callable[[meshio.Mesh], None], words: str
) -> None:
    path = changed(tyre, tmp_path / "tyre.msh", change)
    with pytest.raises(InputError, match=words) as error:
        read_for(section, path)
    assert error.value.file == path


def test_a_whole_section_lies_about_its_mid_plane(section: Section, tmp_path: Path) -> None:
    """As drawn from one side of the tyre on: areas and radii are right, all places are not."""
    whole = section.as_full()
    path = changed(build(whole, size=5e-3), tmp_path / "tyre.msh", moved(z=0.079))
    with pytest.raises(InputError, match=r"its middle is at z = 79 mm: z is from the mid plane of the tyre"):
        read_for(whole, path)


def inner_element(content: meshio.Mesh) -> tuple[int, NDArray[np.int64]]:
    """An element without a node on the surface, and its nodes."""
    inside = ~np.isin(content.cells[0].data, content.cells[1].data).any(axis=1)
    number = int(np.flatnonzero(inside)[0])
    return number, content.cells[0].data[number]


def element_twice(content: meshio.Mesh) -> None:
    """One element more, which would heat and store twice."""
    number, nodes = inner_element(content)
    content.cells[0] = meshio.CellBlock("quad", np.vstack([content.cells[0].data, nodes]))
    for parts in content.cell_data.values():
        parts[0] = np.append(parts[0], parts[0][number])


def node_moved(share: float) -> Callable[[meshio.Mesh], None]:
    """A node on its way to the opposite corner of an element: beyond the middle the element is not convex."""

    def change(content: meshio.Mesh) -> None:
        _, nodes = inner_element(content)
        content.points[nodes[0]] += share * (content.points[nodes[2]] - content.points[nodes[0]])

    return change


def side_collapsed(content: meshio.Mesh) -> None:
    _, nodes = inner_element(content)
    content.points[nodes[0]] = content.points[nodes[1]]


def parts_not_joined(content: meshio.Mesh) -> None:
    """The tread has nodes of its own where it meets the carcass, as an assembly of single meshes has."""
    elements, tags = content.cells[0].data, content.cell_data["gmsh:physical"][0]
    tread = tags == content.field_data["tread"][0]
    shared = np.intersect1d(elements[tread], elements[~tread])
    shared = shared[~np.isin(shared, content.cells[1].data)]
    number = np.arange(len(content.points))
    number[shared] = len(content.points) + np.arange(len(shared))
    content.points = np.vstack([content.points, content.points[shared]])
    elements[tread] = number[elements[tread]]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (element_twice, "4 sides belong to more than two elements, one near r = "),
        (node_moved(0.8), "1 of .* elements are folded, not convex or without area at a corner, as one near r = "),
        (node_moved(1.4), "elements are folded, not convex or without area at a corner"),
        (side_collapsed, "elements are folded, not convex or without area at a corner"),
        (
            parts_not_joined,
            r"belong to no boundary.*; \d+ nodes lie on others: parts are not joined, merge their nodes",
        ),
    ],
)
def test_elements_that_would_give_wrong_integrals_are_refused(
    section: Section, tyre: TyreMesh, tmp_path: Path, change: Callable[[meshio.Mesh], None], words: str
) -> None:
    """One element twice made a tyre 2.5 K hotter, without a word."""
    path = changed(tyre, tmp_path / "tyre.msh", change)
    with pytest.raises(InputError, match=words):
        read_for(section, path)


def test_further_sets_of_a_program_are_left_out(tmp_path: Path) -> None:
    """Abaqus files name each part by its surface, its material and in a set of all; the section's names are enough."""
    path = tmp_path / "square.inp"
    path.write_text(
        "*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 2., 0., 0.\n4, 0., 1., 0.\n5, 1., 1., 0.\n6, 2., 1., 0.\n"
        "*ELEMENT, TYPE=CPS4, ELSET=Surface1\n1, 1, 2, 5, 4\n2, 2, 3, 6, 5\n"
        "*ELSET, ELSET=LEFT\n1\n*ELSET, ELSET=RIGHT\n2\n*ELSET, ELSET=EALL\n1, 2\n"
        "*NSET, NSET=SKIN\n1, 2, 3, 4, 5, 6\n*NSET, NSET=NALL\n1, 2, 3, 4, 5, 6\n"
    )
    mesh = read(path, unit="mm", regions=["LEFT", "RIGHT"], boundaries=["SKIN"])
    assert set(mesh.subdomains) == {"LEFT", "RIGHT"}
    assert set(mesh.boundaries) == {"SKIN"}
    with pytest.raises(InputError, match="2 of 2 elements belong to more than one region"):
        read(path, regions=["LEFT"])


def renamed(section: Section, old: str, new: str) -> Section:
    """The section with another name of a region or boundary."""

    def named(division: Division) -> Division:
        return Division(tuple(new if name == old else name for name in division.names), division.ends)

    layers = tuple(replace(layer, regions=named(layer.regions)) for layer in section.layers)
    return replace(section, layers=layers, outer=named(section.outer))


def test_a_region_and_a_boundary_of_one_name_are_kept_or_refused(section: Section, tmp_path: Path) -> None:
    """gmsh's names are a table with one entry by name: the region would be lost."""
    tyre = build(renamed(section, "outside_air", "sidewall"), size=8e-3)
    with pytest.raises(InputError, match=r"'sidewall' names a region and a boundary"):
        write(tyre, tmp_path / "tyre.msh")
    assert not (tmp_path / "tyre.msh").exists()
    back = read_for(tyre.section, write(tyre, tmp_path / "tyre.vtu"))
    assert np.array_equal(back.mesh.subdomains["sidewall"], tyre.mesh.subdomains["sidewall"])


@pytest.mark.parametrize(("suffix", "name"), [(".msh", 'tread "A"'), (".vtu", "belt & cap"), (".vtu", "a<b")])
def test_names_that_cannot_be_read_again_are_refused(section: Section, tmp_path: Path, suffix: str, name: str) -> None:
    with pytest.raises(InputError, match=f"a '{suffix}' file cannot keep the name '{name}'"):
        write(build(renamed(section, "tread", name), size=8e-3), tmp_path / f"tyre{suffix}")
