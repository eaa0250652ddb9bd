"""Named groups of a meshio mesh, of any format, on a scikit-fem mesh.

Regions are named by element, boundaries by the two nodes of a facet. A half mesh can be mirrored.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError, nearest

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


def named_mesh(points: Array, elements: Indices, regions: Mapping[str, Indices], edges: Mapping[str, Indices]) -> Any:
    """scikit-fem mesh from points (n, 2), elements (n, 3 or 4), element indices per region, node pairs per boundary.

    Clockwise elements are reversed; nodes without elements are dropped.

    Raises
    ------
    ValueError : a node pair is not a facet of the mesh.
    """
    import skfem

    used, renumbered = np.unique(elements, return_inverse=True)
    new_number = np.full(len(points), -1, dtype=np.int64)
    new_number[used] = np.arange(len(used))
    points, elements = points[used], renumbered.reshape(elements.shape)
    corners = points[elements]
    after = np.roll(corners, -1, axis=1)
    clockwise = (corners[..., 0] * after[..., 1] - corners[..., 1] * after[..., 0]).sum(axis=1) < 0
    elements = np.where(clockwise[:, None], elements[:, ::-1], elements)
    kind = skfem.MeshTri if elements.shape[1] == 3 else skfem.MeshQuad
    mesh = kind(np.ascontiguousarray(points.T), np.ascontiguousarray(elements.T), sort_t=False)
    return mesh.with_subdomains(
        {name: np.sort(np.unique(numbers)) for name, numbers in regions.items()}
    ).with_boundaries({name: find_facets(mesh, new_number[pairs]) for name, pairs in edges.items()})


def unnamed_edges(elements: Indices, named: Iterable[Indices]) -> Indices:
    """Node pairs (n, 2) that belong to one element (n, 3 or 4) only and to none of the named boundaries."""
    pairs = np.sort(np.stack([elements, np.roll(elements, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    single, counts = np.unique(pairs, axis=0, return_counts=True)
    known = {(int(a), int(b)) for group in named for a, b in np.sort(group, axis=1)}
    return np.array([pair for pair in single[counts == 1] if (int(pair[0]), int(pair[1])) not in known]).reshape(-1, 2)


def find_facets(mesh: Any, pairs: Indices) -> Indices:
    """Facet indices of node pairs (n, 2).

    Raises
    ------
    ValueError : a pair is not a facet of the mesh.
    """
    n = int(mesh.p.shape[1])
    key = np.sort(mesh.facets, axis=0)
    key = key[0].astype(np.int64) * n + key[1]
    wanted = np.sort(np.asarray(pairs, dtype=np.int64), axis=1)
    wanted = wanted[:, 0] * n + wanted[:, 1]
    order = np.argsort(key)
    place = np.searchsorted(key[order], wanted)
    if (place >= len(key)).any() or (key[order][place] != wanted).any():
        raise ValueError("a named edge is not a facet of the mesh")
    return np.unique(order[place])


def facet_nodes(mesh: Any, name: str) -> Indices:
    """Node pairs (n, 2) of a named boundary."""
    return np.asarray(mesh.facets[:, mesh.boundaries[name]].T, dtype=np.int64)


def mirrored(mesh: Any, symmetry: str = "symmetry") -> Any:
    """The full mesh from the half z >= 0: joined with its mirror image at the nodes with z = 0, same names."""
    points, elements = mesh.p.T, np.asarray(mesh.t.T, dtype=np.int64)
    n = len(points)
    on_plane = np.zeros(n, dtype=bool)
    on_plane[facet_nodes(mesh, symmetry).ravel()] = True
    image = np.where(on_plane, np.arange(n), n - 1 + np.cumsum(~on_plane))
    all_points = np.concatenate([points, points[~on_plane] * [1.0, -1.0]])
    regions = {name: np.concatenate([members, members + len(elements)]) for name, members in mesh.subdomains.items()}
    edges = {}
    for name in mesh.boundaries:
        if name != symmetry:
            pairs = facet_nodes(mesh, name)
            edges[name] = np.concatenate([pairs, image[pairs]])
    return named_mesh(all_points, np.concatenate([elements, image[elements]]), regions, edges)


#: Corners of the cells that can be read; sides of quadratic cells become straight.
CORNERS = {"triangle": 3, "triangle6": 3, "triangle7": 3, "quad": 4, "quad8": 4, "quad9": 4}
EDGES = ("line", "line3")


#: Prefix of cell data that is 1 in a group, for formats without names.
MARKS = {"region": CORNERS, "boundary": EDGES}


def named_from(
    raw: Any,
    *,
    points: NDArray[np.float64] | None = None,
    names: Mapping[str, str] | None = None,
    regions: Iterable[str] = (),
    boundaries: Iterable[str] = (),
) -> Any:
    """scikit-fem mesh with named subdomains and boundaries from a ``meshio.Mesh``.

    Parameters
    ----------
    raw : meshio mesh; its groups may be gmsh physical names, cell sets, MED families, ``region:``/``boundary:``
        cell data, or (boundaries only) point sets.
    points : (n, 2) coordinates to use instead of the file's first two.
    names : names in the file -> new names.
    regions, boundaries : required names; where they name every part once, further groups are left out.

    Raises
    ------
    InputError : a missing name (with the nearest one in the file), an element in no or two regions, a surface facet
        in no or two boundaries, cells that are not all triangles or all quadrilaterals.
    """
    elements, faces, edges = _named_cells(raw, names or {})
    _known_names(raw, names)
    points = raw.points[:, :2] if points is None else points
    regions_found = {name: np.unique(np.concatenate(parts)) for name, parts in faces.items()}
    regions_found = _without_further(regions_found, regions, len(elements))
    _check_membership(regions_found, len(elements), "element", "region")
    _required(regions, regions_found, "region")
    try:
        mesh = named_mesh(points, elements, regions_found, {})
    except ValueError as error:
        raise InputError(f"its elements do not make a mesh: {error}") from error
    # find_facets counts nodes of the mesh, in which nodes without elements are dropped.
    number = np.full(len(points), -1, dtype=np.int64)
    used = np.unique(elements)
    number[used] = np.arange(len(used))
    _check_sides(mesh)
    surface = mesh.boundary_facets()
    named = _named_facets(raw, mesh, edges, names or {}, number, points)
    _required(boundaries, named, "boundary")
    places = {name: np.searchsorted(surface, facets) for name, facets in named.items()}
    places = _without_further(places, boundaries, len(surface))
    try:
        _check_membership(places, len(surface), "side of the surface", "boundary", mesh.p[:, mesh.facets[0, surface]])
    except InputError as error:
        raise InputError(f"{error.message}{_coincident(points)}") from None
    return mesh.with_boundaries({name: named[name] for name in places})


def _named_cells(
    raw: Any, names: Mapping[str, str]
) -> tuple[Indices, dict[str, list[Indices]], dict[str, list[Indices]]]:
    """Nodes of the elements, region -> parts of its elements, and boundary -> parts of its node pairs (n, 2)."""
    blocks = [index for index, block in enumerate(raw.cells) if block.type in CORNERS and len(block.data)]
    kinds = {CORNERS[raw.cells[index].type] for index in blocks}
    if len(kinds) != 1:
        listing = ", ".join(sorted({block.type for block in raw.cells})) or "none"
        raise InputError(f"needs cells that are all triangles or all quadrilaterals; found: {listing}")
    corners = kinds.pop()
    elements = np.concatenate([raw.cells[index].data[:, :corners] for index in blocks]).astype(np.int64)
    starts = dict(zip(blocks, np.cumsum([0, *(len(raw.cells[i].data) for i in blocks[:-1])]), strict=True))
    faces: dict[str, list[Indices]] = {}
    edges: dict[str, list[Indices]] = {}
    for name, block, members in _groups(raw):
        if len(members) == 0:
            continue
        name = names.get(name, name)
        if block in starts:
            faces.setdefault(name, []).append(members + starts[block])
        elif raw.cells[block].type in EDGES:
            edges.setdefault(name, []).append(raw.cells[block].data[members, :2].astype(np.int64))
    return elements, faces, edges


def _named_facets(
    raw: Any, mesh: Any, edges: Mapping[str, list[Indices]], names: Mapping[str, str], number: Indices, points: Array
) -> dict[str, Indices]:
    """Boundary -> its facets on the surface, by lines or point sets; ``number``: of the file's nodes in the mesh."""
    surface = mesh.boundary_facets()
    named: dict[str, Indices] = {}
    for name, parts in edges.items():
        try:
            facets = find_facets(mesh, number[np.concatenate(parts)])
        except ValueError:
            raise InputError(f"lines of boundary '{name}' are not sides of elements{_coincident(points)}") from None
        named[name] = facets[np.isin(facets, surface)]
    for name, nodes in (getattr(raw, "point_sets", None) or {}).items():
        name = names.get(name, name)
        if name not in named:
            here = np.isin(mesh.facets[:, surface], number[np.asarray(nodes, dtype=np.int64)]).all(axis=0)
            named[name] = surface[here]
    return {name: facets for name, facets in named.items() if len(facets)}


def _without_further(groups: dict[str, Indices], required: Iterable[str], count: int) -> dict[str, Indices]:
    """The required groups alone if every element or facet is in one of them: programs write sets of all elements, of
    single surfaces and of materials beside them."""
    kept = {name: groups[name] for name in required if name in groups}
    times = np.bincount(np.concatenate([np.zeros(0, dtype=np.int64), *kept.values()]), minlength=count)
    return kept if kept and (times == 1).all() else groups


def _groups(raw: Any) -> Iterable[tuple[str, int, Indices]]:
    """(name, cell block, members) of every named group of cells."""
    tags = {}
    for name, (tag, dimension) in ((name, data[:2]) for name, data in raw.field_data.items() if len(data) >= 2):
        tags[int(tag), int(dimension)] = name
    physical = raw.cell_data.get("gmsh:physical")
    families = raw.cell_data.get("cell_tags")
    sets = {name: parts for name, parts in raw.cell_sets.items() if not name.startswith("gmsh:")}
    for block, cells in enumerate(raw.cells):
        dimension = 2 if cells.type in CORNERS else 1
        if physical is not None:
            for (tag, of), name in tags.items():
                if of == dimension:
                    yield name, block, np.flatnonzero(physical[block] == tag)
        else:
            for name, parts in sets.items():
                if parts[block] is not None:
                    yield name, block, np.asarray(parts[block], dtype=np.int64)
        for family, family_names in (getattr(raw, "cell_tags", None) or {}).items():
            for name in family_names if families is not None else ():
                yield name, block, np.flatnonzero(families[block] == family)
        for key, data in raw.cell_data.items():
            what, _, name = key.partition(":")
            if name and what in MARKS and cells.type in MARKS[what]:
                yield name, block, np.flatnonzero(np.asarray(data[block]).ravel() == 1)


def _known_names(raw: Any, names: Mapping[str, str] | None) -> None:
    known = {name for name, _, _ in _groups(raw)} | set(getattr(raw, "point_sets", None) or {})
    for name in names or {}:
        if name not in known:
            raise InputError(f"the file has no group '{name}'{nearest(name, known)}", field="names")


def _required(required: Iterable[str], available: Mapping[str, Any], what: str) -> None:
    for name in required:
        if name not in available:
            hint = nearest(name, available) if available else "; it has no named groups of this kind"
            raise InputError(
                f"the mesh has no {what} '{name}'{hint.replace('Allowed', 'Found').replace('allowed', 'found')}"
            )


def _check_sides(mesh: Any) -> None:
    """Raise an error if a side belongs to more than two elements: elements that lie on each other count twice."""
    times = np.bincount(mesh.t2f.ravel(), minlength=mesh.facets.shape[1])
    if times.max() > 2:
        r, z = mesh.p[:, mesh.facets[:, int(np.argmax(times))]].mean(axis=1)
        raise InputError(
            f"{int((times > 2).sum())} sides belong to more than two elements, one near r = {r:.4g} m,"
            f" z = {z:.4g} m: an element twice, or elements that lie on each other"
        )


def _coincident(points: NDArray[np.float64]) -> str:
    """Words on nodes at the same place, to add to an error; empty if there are none."""
    grid = np.round((points - points.min(axis=0)) / (1e-7 * np.ptp(points, axis=0).max() or 1.0))
    twice = len(points) - len(np.unique(grid, axis=0))
    return f"; {twice} nodes lie on others: parts are not joined, merge their nodes" if twice else ""


def _check_membership(
    groups: Mapping[str, Indices], count: int, thing: str, what: str, at: NDArray[np.float64] | None = None
) -> None:
    """Raise an error if an element or facet belongs to no group or to several."""
    times = np.zeros(count, dtype=np.int64)
    for members in groups.values():
        times[members] += 1
    for wrong, words in ((times == 0, "no"), (times > 1, "more than one")):
        if wrong.any():
            first = int(np.argmax(wrong))
            place = "" if at is None else f", one near r = {at[0, first]:.4g} m, z = {at[1, first]:.4g} m"
            raise InputError(f"{int(wrong.sum())} of {count} {thing}s belong to {words} {what}{place}")
