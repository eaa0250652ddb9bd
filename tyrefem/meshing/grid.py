"""The structured grid on a section: stations along the meridian, rows through the layers."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tyrefem.meshing.spacing import graded, knots, row_fractions, rows_needed
from tyrefem.section.outlines import stations
from tyrefem.section.section import Section

Array = NDArray[np.float64]
#: Rows next to the road and the rim are this share of the size: a strong film cools them within millimetres.
SURFACE_SHARE = 0.25
#: Thickest row away from the surface over the size: heat sources jump where layers meet.
CORE_SHARE = 1.0
#: Longest edge along the meridian over the thinnest row.
ASPECT = 10.0
#: Growth of the gaps away from a place where one boundary gives way to another.
GROWTH = 0.3


@dataclass(frozen=True)
class Grid:
    """Stations (n_columns + 1,), and heights of the nodes above the meridian (n_rows + 1, n_columns + 1) [m].

    ``layer`` is the layer of each row.
    """

    s: Array
    y: Array
    layer: NDArray[np.int64]


def make_grid(section: Section, size: float, through: int) -> Grid:
    """Rows and stations for a size [m]: conforming to every layer, region and boundary."""
    rows = [_rows(section, index, size, through) for index in range(len(section.layers))]
    s = _stations(section, size, rows)
    faces = section.interfaces(s)
    heights = []
    for index, count in enumerate(rows):
        thickness = faces[index + 1] - faces[index]
        share = np.stack([_fractions(section, index, t, size, count) for t in thickness], axis=1)
        level = faces[index] + share * thickness
        heights.append(level if index == 0 else level[1:])
    return Grid(s, np.concatenate(heights), np.repeat(np.arange(len(rows)), rows))


def grid_lines(section: Section, size: float, through: int) -> tuple[int, int]:
    """How many lines `make_grid` lays across the meridian and along it."""
    rows = [_rows(section, index, size, through) for index in range(len(section.layers))]
    return len(_stations(section, size, rows)), sum(rows) + 1


def _outermost(section: Section, index: int) -> bool:
    return index == len(section.layers) - 1


def _rows(section: Section, index: int, size: float, through: int) -> int:
    s = stations(section, 0.0, section.line.length, size)
    thickest = float(section.built_layers[index].thickness(s).max())
    first = size * SURFACE_SHARE if _outermost(section, index) else size * CORE_SHARE
    return max(through, rows_needed(thickest, first, size * CORE_SHARE))


def _fractions(section: Section, index: int, thickness: float, size: float, rows: int) -> Array:
    if _outermost(section, index):
        return row_fractions(thickness, size * SURFACE_SHARE, rows)
    return np.linspace(0.0, 1.0, rows + 1)


def _stations(section: Section, size: float, rows: list[int]) -> Array:
    """Stations at most ``size`` apart, closer at the rim's end face, at changes of boundary and in thin layers."""
    length = section.line.length
    changes = np.array([end for _, _, end in section.outer.parts()])

    def wanted(s: Array) -> Array:
        rise = SURFACE_SHARE * size + GROWTH * np.abs(s[:, None] - changes).min(axis=1)
        thin = np.full_like(s, size)
        for index, (layer, count) in enumerate(zip(section.built_layers, rows, strict=True)):
            thickness = layer.thickness(s)
            row = thickness / count
            if _outermost(section, index):
                row = np.minimum(row, SURFACE_SHARE * size)
            thin = np.minimum(thin, ASPECT * row)
        return np.minimum(np.minimum(size, rise), thin)

    runs = [graded(a, b, wanted)[:-1] for a, b in pairwise(knots(section, size))]
    return np.concatenate([*runs, [length]])
