"""The structured mesher: quadrilaterals laid along the layers, everywhere available."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.meshing.grid import Grid, make_grid
from tyrefem.meshing.named import bare_edges, mirrored, named_mesh
from tyrefem.section.section import GROOVE, Section

Indices = NDArray[np.int64]


def mapped_mesh(section: Section, size: float, cell: str, through: int) -> Any:
    """scikit-fem mesh of a section, grid lines on every border of layers, regions and boundaries."""
    half = section.as_half()
    grid = make_grid(half, size, through)
    columns, rows = len(grid.s), len(grid.y)
    points = half.line.position(grid.s) + grid.y[..., None] * half.line.normal(grid.s)
    points = points.reshape(-1, 2)
    node = np.arange(rows * columns).reshape(rows, columns)
    points[node[:, 0], 1] = 0.0
    quads = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], axis=-1).reshape(-1, 4)
    names = _region_names(half, grid)
    if cell == "tri":
        elements, names = _triangles(points, quads), np.repeat(names, 2)
    else:
        elements = quads
    edges = _edges(half, grid, node)
    if half.grooves:
        elements, names = elements[names != GROOVE], names[names != GROOVE]
        walls = bare_edges(elements, edges.values())
        edges[half.groove_boundary] = np.concatenate([edges[half.groove_boundary], walls])
    regions = {name: np.flatnonzero(names == name) for name in half.regions}
    mesh = named_mesh(points, elements, regions, edges)
    return mesh if section.half else mirrored(mesh)


def _region_names(section: Section, grid: Grid) -> NDArray[np.str_]:
    middle = (grid.s[:-1] + grid.s[1:]) / 2
    return np.concatenate([section.layers[index].regions.at(middle) for index in grid.layer])


def _edges(section: Section, grid: Grid, node: Indices) -> dict[str, Indices]:
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
