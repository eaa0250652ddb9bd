"""Meshes from and to files, in any format of meshio, with their named regions and boundaries."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from tyrefem.errors import InputError, nearest
from tyrefem.geometry.meshing.groups import named_from
from tyrefem.geometry.meshing.mesh import TyreMesh
from tyrefem.geometry.section import Section
from tyrefem.output import atomic_path, note_input
from tyrefem.output.file import MARK
from tyrefem.quantity import parse

#: Indices of the file's coordinates for radius and axial position (or x and y of a planar mesh).
AXES = {"rz": (0, 1), "zr": (1, 0), "xy": (0, 1), "yz": (1, 2), "zy": (2, 1), "xz": (0, 2), "zx": (2, 0)}
#: Largest difference of a region's area between a mesh and its section, over the area.
AREA_TOLERANCE = 0.1
#: Largest difference of a region's mean radius over the radius, and of a whole section's middle over the width: an
#: estimate.
RADIUS_TOLERANCE = 0.02
#: m; largest distance of the symmetry's nodes from the mid plane, as of rounded coordinates: an estimate.
PLANE = 1e-5
#: Formats in which `write` keeps names, with the options for meshio.
WRITTEN: dict[str, dict[str, Any]] = {
    # Format 2.2 can be read by all programs that read gmsh files.
    ".msh": {"file_format": "gmsh22"},
    ".vtu": {},
    ".vtk": {},
}

#: Signs that meshio writes into a name without the format's escapes.
UNREADABLE = {".msh": '"', ".vtu": '"&<'}


def read(
    path: str | Path,
    *,
    names: Mapping[str, str] | None = None,
    axes: str = "rz",
    unit: str = "m",
    regions: Iterable[str] = (),
    boundaries: Iterable[str] = (),
) -> Any:
    """scikit-fem mesh from a file, named groups as ``subdomains`` and ``boundaries``.

    Parameters
    ----------
    path : any format that meshio reads; groups may be gmsh physical names, cell sets, MED families, point sets
        (boundaries), or cell data ``region:NAME`` and ``boundary:NAME`` that are 1 in the group.
    names : names in the file -> new names.
    axes : indices of (r, z): ``"rz"`` and ``"xy"`` for the first two, ``"zr"`` for the second and the first.
    unit : unit of the coordinates, e.g. ``"mm"``.
    regions, boundaries : required names; every element and every surface facet must belong to one. Further groups are
        left out where these name every part.

    Raises
    ------
    InputError : unreadable file, unknown unit, a missing name, parts without a name; the message lists the file's
    names.
    """
    path = Path(path)
    if axes not in AXES:
        raise InputError(f"no axes '{axes}'{nearest(axes, AXES)}", field="axes")
    try:
        scale = parse(f"1 {unit}", "m")
    except InputError as error:
        raise error.within(field="unit") from None
    raw = _meshio_mesh(path)
    columns = list(AXES[axes])
    points = np.asarray(raw.points, dtype=float)
    if points.shape[1] <= max(columns):
        raise InputError(f"its points have {points.shape[1]} coordinates, too few for axes '{axes}'", file=path)
    points = points[:, columns] * scale
    if not np.isfinite(points).all():
        raise InputError("a coordinate is not a finite number", file=path)
    try:
        return named_from(raw, points=points, names=names, regions=regions, boundaries=boundaries)
    except InputError as error:
        raise error.within(file=path) from None


def read_for(
    section: Section,
    path: str | Path,
    *,
    names: Mapping[str, str] | None = None,
    axes: str = "rz",
    unit: str = "m",
) -> TyreMesh:
    """A mesh from a file for a section, with the section's names and about its areas.

    Raises
    ------
    InputError : errors of `read`; an area differs by more than a tenth, as with a wrong unit; a mean radius by more
    than a fiftieth; r is negative; a half mesh is not at z >= 0; an element is folded or not convex.
    """
    mesh = read(path, names=names, axes=axes, unit=unit, regions=section.regions, boundaries=section.boundaries)
    if mesh.p[0].min() < 0:
        raise InputError(f"r is negative, down to {mesh.p[0].min():.4g} m; are the axes '{axes}'?", file=path)
    if section.half and mesh.p[1].min() < -PLANE:
        raise InputError(
            f"z is negative, down to {mesh.p[1].min():.4g} m: a half section lies at z >= 0, its symmetry at z = 0",
            file=path,
        )
    edges = mesh.p[:, mesh.facets[0]] - mesh.p[:, mesh.facets[1]]
    cell = "tri" if mesh.t.shape[0] == 3 else "quad"
    tyre = TyreMesh(mesh, section, "file", float(np.hypot(*edges).max()), cell)
    try:
        _check_shapes(tyre)
        _check_sizes(tyre, unit)
    except InputError as error:
        raise error.within(file=path) from None
    return tyre


def _check_shapes(tyre: TyreMesh) -> None:
    """Raise an error for elements with a corner above 180 degrees or without a side: their integrals are wrong."""
    bad = ~(tyre.corner_sines.min(axis=0) > 0)
    if bad.any():
        r, z = tyre.mesh.p[:, tyre.mesh.t[:, int(np.argmax(bad))]].mean(axis=1)
        raise InputError(
            f"{int(bad.sum())} of {tyre.n_elements} elements are folded, not convex or without area at a corner,"
            f" as one near r = {r:.4g} m, z = {z:.4g} m"
        )


def _check_sizes(tyre: TyreMesh, unit: str) -> None:
    """Compare areas and mean radii of the regions, and the symmetry's plane, with those of the section."""
    section = tyre.section
    for region in section.regions:
        area, radius = tyre.area(region), tyre.volume(region) / tyre.area(region) / (2 * np.pi)
        ratio, of_section = area / section.area(region), section.volume(region) / section.area(region) / (2 * np.pi)
        if abs(ratio - 1) > AREA_TOLERANCE:
            raise InputError(
                f"region '{region}' has {ratio:.4g} times the area it has in section '{section.name}':"
                f" wrong unit ('{unit}'), a half for a full section, or another tyre"
            )
        if abs(radius / of_section - 1) > RADIUS_TOLERANCE:
            raise InputError(
                f"region '{region}' is at a mean radius of {radius * 1e3:.4g} mm, in section '{section.name}' at"
                f" {of_section * 1e3:.4g} mm: r is from the wheel's axis; or another tyre"
            )
    if section.half:
        off = np.abs(tyre.mesh.p[1, tyre.mesh.facets[:, tyre.mesh.boundaries["symmetry"]]]).max()
        if off > PLANE:
            raise InputError(f"boundary 'symmetry' is not at z = 0: up to {off * 1e3:.4g} mm from it")
        return
    middle = float(tyre.mesh.p[1, tyre.mesh.t].mean(axis=0) @ tyre.element_areas / tyre.element_areas.sum())
    if abs(middle) > RADIUS_TOLERANCE * section.overall_width:
        raise InputError(f"its middle is at z = {middle * 1e3:.4g} mm: z is from the mid plane of the tyre")


def write(mesh: Any, path: str | Path) -> Path:
    """Write a mesh with its names, for `read`.

    gmsh files (``.msh``) hold physical names; VTK files (``.vtu``, ``.vtk``) cell data
    ``region:NAME`` and ``boundary:NAME``. An older file survives a failure.

    Parameters
    ----------
    mesh : scikit-fem mesh with named subdomains and boundaries, or a `TyreMesh`.

    Raises
    ------
    InputError : a format without names, a name that it cannot keep, or the file cannot be written.
    """
    import meshio

    path = Path(path)
    if path.suffix.lower() not in WRITTEN:
        raise InputError(f"names cannot be kept in a '{path.suffix}' file{nearest(path.suffix, WRITTEN)}", file=path)
    mesh = getattr(mesh, "mesh", mesh)
    cell = "triangle" if mesh.t.shape[0] == 3 else "quad"
    points = np.column_stack([mesh.p.T, np.zeros(mesh.p.shape[1])])
    regions, boundaries = mesh.subdomains or {}, mesh.boundaries or {}
    if sum(map(len, regions.values())) > len(np.unique(np.concatenate([[], *regions.values()]))):
        raise InputError("its regions overlap; write the mesh without zones", file=path)
    _check_names(regions, boundaries, path)
    facets = np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *boundaries.values()]))
    cells = [(cell, mesh.t.T), ("line", mesh.facets[:, facets].T)]
    members = {("region", name): (numbers, 0) for name, numbers in regions.items()}
    members |= {("boundary", name): (np.searchsorted(facets, numbers), 1) for name, numbers in boundaries.items()}
    marks = {}
    for what, (numbers, block) in members.items():
        marks[what] = [np.zeros(mesh.t.shape[1], dtype=np.int32), np.zeros(len(facets), dtype=np.int32)]
        marks[what][block][numbers] = 1
    data: dict[str, Any] = {":".join(what): values for what, values in marks.items()}
    field_data = {}
    if path.suffix.lower() == ".msh":
        tags = [np.zeros(mesh.t.shape[1], dtype=np.int32), np.zeros(len(facets), dtype=np.int32)]
        for tag, (what, (numbers, block)) in enumerate(members.items(), start=1):
            tags[block][numbers] = tag
            field_data[what[1]] = np.array([tag, 2 - block])
        data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    content = meshio.Mesh(points, cells, cell_data=data, field_data=field_data)
    with atomic_path(path) as temporary:
        try:
            with contextlib.redirect_stdout(io.StringIO()):
                meshio.write(temporary, content, **WRITTEN[path.suffix.lower()])
        except (Exception, SystemExit) as error:  # each format raises other errors
            raise InputError(f"cannot be written: {error}", file=path) from error
        _name_writer(temporary)
    return path


def _check_names(regions: Iterable[str], boundaries: Iterable[str], path: Path) -> None:
    """Raise `InputError` for names that meshio writes, but cannot read again."""
    for name in [*regions, *boundaries]:
        if bad := [sign for sign in UNREADABLE.get(path.suffix.lower(), "") if sign in name]:
            raise InputError(f"a '{path.suffix}' file cannot keep the name '{name}': it has a {bad[0]}", file=path)
    both = sorted(set(regions) & set(boundaries))
    if both and path.suffix.lower() == ".msh":
        raise InputError(
            f"'{both[0]}' names a region and a boundary, of which a '.msh' file keeps one; '.vtu' and '.vtk' keep both",
            file=path,
        )


def _name_writer(path: Path) -> None:
    """Name the program that wrote the file, in a comment of the format."""
    if path.suffix.lower() == ".vtk":
        path.write_bytes(path.read_bytes().replace(b"written by meshio", MARK + b", by meshio", 1))
        return
    comment = b"$Comments\n%s\n$EndComments\n" if path.suffix.lower() == ".msh" else b"\n<!-- %s -->\n"
    with path.open("ab") as stream:
        stream.write(comment % MARK)


def _meshio_mesh(path: Path) -> Any:
    import meshio

    if not path.is_file():
        raise InputError("no such mesh file", file=path)
    note_input(path)
    printed = io.StringIO()
    try:
        # meshio prints its errors and ends the process where other libraries raise.
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
            return meshio.read(path)
    except (Exception, SystemExit) as error:
        reason = printed.getvalue().strip() or str(error)
        raise InputError(f"cannot be read as a mesh: {reason:.200}", file=path) from error
