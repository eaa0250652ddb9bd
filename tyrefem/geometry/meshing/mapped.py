"""The structured mesher: quadrilaterals along the layers, without further libraries.

Its grid has stations along the meridian and rows through the layers.

Node spacing along a line follows a given local size.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.geometry.meshing.groups import mirrored, named_mesh, unnamed_edges
from tyrefem.geometry.outlines import stations
from tyrefem.geometry.section import GROOVE, Section

Array = NDArray[np.float64]


#: A kink of the geometry closer than this share of the size to another grid line has no grid line.
KINK_SHARE = 0.25


def knots(section: Section, size: float) -> Array:
    """Stations with a grid line at ``size`` [m]: all marks, and kinks that are not too close to another one."""
    kept = [0.0, *section.marks, section.line.length]
    for s in section.breaks:
        if min(abs(s - other) for other in kept) > KINK_SHARE * size:
            kept.append(s)
    return np.unique(kept)


def graded(start: float, end: float, size: Callable[[Array], Array], least: int = 1) -> Array:
    """Stations from start to end, both included, with gaps of about ``size(s)`` or smaller.

    The number of gaps is the integral of ds/size(s), rounded up; all gaps have the same share of it.

    >>> graded(0.0, 1.0, lambda s: np.full_like(s, 0.3)).round(9).tolist()
    [0.0, 0.25, 0.5, 0.75, 1.0]
    """
    s = np.linspace(start, end, 400)
    density = 1 / size(s)
    count = np.concatenate([[0.0], np.cumsum((density[1:] + density[:-1]) / 2 * np.diff(s))])
    gaps = max(least, int(np.ceil(count[-1] - 1e-6)))
    stations = np.interp(np.linspace(0.0, count[-1], gaps + 1), count, s)
    stations[0], stations[-1] = start, end
    return stations


def rows_needed(thickness: float, first: float, largest: float) -> int:
    """Smallest number of rows through ``thickness`` that grow geometrically from ``first`` up to ``largest``."""
    for rows in range(1, 1000):
        if np.diff(row_fractions(thickness, first, rows)).max() * thickness <= largest * (1 + 1e-9):
            return rows
    return 1000


def row_fractions(thickness: float, first: float, rows: int) -> Array:
    """Row borders, 0 to 1 from the coarse to the fine side: the last row has thickness ``first``, the others grow.

    If ``thickness`` is less than ``rows`` times ``first``, all rows are equal.

    >>> row_fractions(3.0, 1.0, 3).round(9).tolist()
    [0.0, 0.333333333, 0.666666667, 1.0]
    """
    sizes = _ratio(thickness, first, rows) ** np.arange(rows)[::-1]
    return np.concatenate([[0.0], np.cumsum(sizes) / sizes.sum()])


def _ratio(thickness: float, first: float, rows: int) -> float:
    """Growth q >= 1 with first (q^rows - 1)/(q - 1) = thickness; by bisection."""
    if rows == 1 or thickness <= first * rows:
        return 1.0
    low, high, powers = 1.0, 1.0 + thickness / first, np.arange(rows)
    with np.errstate(over="ignore"):
        for _ in range(80):
            middle = (low + high) / 2
            low, high = (middle, high) if first * (middle**powers).sum() < thickness else (low, middle)
    return (low + high) / 2


#: Rows next to the road and the rim over the size: a strong film cools them within millimetres.
SURFACE_SHARE = 0.25


#: Thickest row away from the surface over the size: heat sources jump between layers.
CORE_SHARE = 1.0


#: Longest edge along the meridian over the thinnest row.
ASPECT = 10.0


#: Growth of the gaps away from a change of boundary.
GROWTH = 0.3


@dataclass(frozen=True)
class MappedGrid:
    """Stations (n_columns + 1,), and heights of the nodes above the meridian (n_rows + 1, n_columns + 1) [m].

    ``layer`` is the layer index of each row.
    """

    s: Array
    y: Array
    layer: NDArray[np.int64]


@dataclass(frozen=True)
class Counts:
    """Numbers of rows of every layer, and of gaps between neighbouring `knots`."""

    rows: tuple[int, ...]
    gaps: tuple[int, ...]


def make_grid(section: Section, size: float, through: int, counts: Counts | None = None) -> MappedGrid:
    """Rows and stations for a size [m], conforming to every layer, region and boundary.

    ``counts``: at least so many rows and gaps; None: as many as the size needs.
    """
    rows = [rows_of(section, index, size, through) for index in range(len(section.layers))]
    if counts is not None:
        rows = [max(pair) for pair in zip(rows, counts.rows, strict=True)]
    s = _stations(section, size, rows, None if counts is None else counts.gaps)
    faces = section.interfaces(s)
    heights = []
    for index, count in enumerate(rows):
        thickness = faces[index + 1] - faces[index]
        share = np.stack([_fractions(section, index, t, size, count) for t in thickness], axis=1)
        level = faces[index] + share * thickness
        heights.append(level if index == 0 else level[1:])
    return MappedGrid(s, np.concatenate(heights), np.repeat(np.arange(len(rows)), rows))


def grid_lines(section: Section, size: float, through: int) -> tuple[int, int]:
    """Number of lines of `make_grid` across the meridian and along it."""
    rows = [rows_of(section, index, size, through) for index in range(len(section.layers))]
    return len(_stations(section, size, rows)), sum(rows) + 1


def _outermost(section: Section, index: int) -> bool:
    return index == len(section.layers) - 1


def rows_of(section: Section, index: int, size: float, through: int) -> int:
    """Number of rows that a layer needs at its thickest place."""
    s = stations(section, 0.0, section.line.length, size)
    thickest = float(section.built_layers[index].thickness(s).max())
    first = size * SURFACE_SHARE if _outermost(section, index) else size * CORE_SHARE
    return max(through, rows_needed(thickest, first, size * CORE_SHARE))


def _fractions(section: Section, index: int, thickness: float, size: float, rows: int) -> Array:
    if _outermost(section, index):
        return row_fractions(thickness, size * SURFACE_SHARE, rows)
    return np.linspace(0.0, 1.0, rows + 1)


def target_size(section: Section, size: float, rows: Sequence[int]) -> Callable[[Array], Array]:
    """Local size along the meridian: at most ``size``, less at the rim's end face, at changes of boundary and in thin
    layers with so many ``rows``."""
    changes = np.array([end for _, _, end in section.outer.parts()])

    def local_size(s: Array) -> Array:
        rise = SURFACE_SHARE * size + GROWTH * np.abs(s[:, None] - changes).min(axis=1)
        thin = np.full_like(s, size)
        for index, (layer, count) in enumerate(zip(section.built_layers, rows, strict=True)):
            thickness = layer.thickness(s)
            row = thickness / count
            if _outermost(section, index):
                row = np.minimum(row, SURFACE_SHARE * size)
            thin = np.minimum(thin, ASPECT * row)
        return np.minimum(np.minimum(size, rise), thin)

    return local_size


def _stations(section: Section, size: float, rows: Sequence[int], gaps: Sequence[int] | None = None) -> Array:
    """Stations with gaps of the `target_size`; ``gaps``: at least so many between neighbouring knots."""
    local_size, spans = target_size(section, size, rows), list(pairwise(knots(section, size)))
    least = [1] * len(spans) if gaps is None else gaps
    runs = [graded(a, b, local_size, gap)[:-1] for (a, b), gap in zip(spans, least, strict=True)]
    return np.concatenate([*runs, [section.line.length]])


Indices = NDArray[np.int64]


def mapped_mesh(section: Section, size: float, cell: str, through: int) -> Any:
    """scikit-fem mesh of a section, grid lines on every border of layers, regions and boundaries."""
    return mesh_on(section, make_grid(section.as_half(), size, through), cell)


def grid_points(half: Section, s: Array, y: Array) -> Array:
    """(r, z) of the nodes of a grid, (n_rows + 1, n_columns + 1, 2) m: y (n_rows + 1, n_columns + 1) above s."""
    points = half.line.position(s) + y[..., None] * half.line.normal(s)
    points[:, 0, 1] = 0.0
    return np.asarray(points)


def mesh_on(section: Section, grid: MappedGrid, cell: str) -> Any:
    """scikit-fem mesh of a section on a grid of its half."""
    half = section.as_half()
    columns, rows = len(grid.s), len(grid.y)
    points = grid_points(half, grid.s, grid.y).reshape(-1, 2)
    node = np.arange(rows * columns).reshape(rows, columns)
    quads = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], axis=-1).reshape(-1, 4)
    names = _region_names(half, grid)
    if cell == "tri":
        elements, names = _triangles(points, quads), np.repeat(names, 2)
    else:
        elements = quads
    edges = _edges(half, grid, node)
    if half.grooves:
        elements, names = elements[names != GROOVE], names[names != GROOVE]
        walls = unnamed_edges(elements, edges.values())
        edges[half.groove_boundary] = np.concatenate([edges[half.groove_boundary], walls])
    regions = {name: np.flatnonzero(names == name) for name in half.regions}
    mesh = named_mesh(points, elements, regions, edges)
    return mesh if section.half else mirrored(mesh)


def _region_names(section: Section, grid: MappedGrid) -> NDArray[np.str_]:
    middle = (grid.s[:-1] + grid.s[1:]) / 2
    return np.concatenate([section.layers[index].regions.at(middle) for index in grid.layer])


def _edges(section: Section, grid: MappedGrid, node: Indices) -> dict[str, Indices]:
    """Node pairs of each boundary."""

    def along(line: Indices) -> Indices:
        return np.stack([line[:-1], line[1:]], axis=1)

    outer, middle = along(node[-1]), (grid.s[:-1] + grid.s[1:]) / 2
    names, rubber = section.outer.at(middle), ~section.in_groove(middle)
    edges = {name: outer[(names == name) & rubber] for name in dict.fromkeys(section.outer.names)}
    last = section.outer.names[-1]
    edges[last] = np.concatenate([edges[last], along(node[:, -1])])
    cut = grid.layer == len(section.layers) - 1 if section.in_groove(middle[0]) else np.zeros(len(grid.layer), bool)
    return {"contained_air": along(node[0]), **edges, "symmetry": along(node[:, 0])[~cut]}


def _triangles(points: NDArray[np.float64], quads: Indices) -> Indices:
    """Two triangles per quadrilateral, cut along its shorter diagonal; shape (2 n, 3)."""
    a, b, c, d = points[quads].transpose(1, 0, 2)
    first = (np.linalg.norm(c - a, axis=1) <= np.linalg.norm(d - b, axis=1))[:, None, None]
    by_ac = np.stack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]], axis=1)
    by_bd = np.stack([quads[:, [0, 1, 3]], quads[:, [1, 2, 3]]], axis=1)
    return np.asarray(np.where(first, by_ac, by_bd).reshape(-1, 3))
