"""A section as blocks for an unstructured mesher: each layer is cut at every mark; all sides are points."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tyrefem.geometry.meshing.mapped import graded, knots
from tyrefem.geometry.outlines import face
from tyrefem.geometry.section import Section

Array = NDArray[np.float64]
#: Edges on the outer face over the size: the road's film cools the face within millimetres.
SURFACE_SHARE = 0.5
#: Near a change of boundary the surface temperature bends sharply: edges are still shorter and grow away from it.
CHANGE_SHARE, GROWTH = 0.25, 0.3


@dataclass(frozen=True)
class Blocks:
    """Sides of the blocks of a half section as points, both ends included.

    ``along[i, k]`` (n, 2) is on face i (0 inside) over span k of the meridian; ``across[i, k]`` goes through layer i
    at station k. ``spans`` are the stations.
    """

    spans: Array
    along: dict[tuple[int, int], Array]
    across: dict[tuple[int, int], Array]

    def middle(self, k: int) -> float:
        """The middle station of span k, where names are evaluated."""
        return float(self.spans[k] + self.spans[k + 1]) / 2


def make_blocks(section: Section, size: float, through: int) -> Blocks:
    """Blocks with edges near ``size``, shorter in thin layers and at the outer face."""
    length, n = section.line.length, len(section.layers)
    spans = np.array([0.0, *section.marks, length])
    kinks = knots(section, size)
    along: dict[tuple[int, int], Array] = {}
    for i in range(n + 1):

        def target_size(s: Array, i: int = i) -> Array:
            return _edge_length(section, i, s, size, through) / _stretch(section, i, s)

        for k, (start, end) in enumerate(pairwise(spans)):
            stops = np.unique([start, *(s for s in kinks if start + 1e-9 < s < end - 1e-9), end])
            runs = [graded(a, b, target_size)[:-1] for a, b in pairwise(stops)]
            along[i, k] = face(section, i, np.concatenate([*runs, stops[-1:]]))
            if k:
                # Worked out among other stations a corner may differ in its last digit.
                along[i, k][0] = along[i, k - 1][-1]
    across = {(i, k): _across(section, i, s, size, through) for i in range(n) for k, s in enumerate(spans)}
    for (i, k), points in across.items():
        for other, end in ((i, 0), (i + 1, -1)):
            corner = along[other, k][0] if k < len(spans) - 1 else along[other, k - 1][-1]
            points[end] = corner
    return Blocks(spans, along, across)


def _edge_length(section: Section, i: int, s: Array, size: float, through: int) -> Array:
    """Target edge length on face i, with ``through`` elements through each adjacent layer."""
    n = len(section.layers)
    target_size = np.full_like(s, size)
    if i == n:
        changes = np.array([end for _, _, end in section.outer.parts()])
        away = np.abs(np.asarray(s)[:, None] - changes).min(axis=1)
        target_size = np.minimum(SURFACE_SHARE * size, CHANGE_SHARE * size + GROWTH * away)
    for layer in section.layers[max(i - 1, 0) : i + 1]:
        target_size = np.minimum(target_size, layer.thickness(s) / through)
    return np.asarray(target_size)


def _stretch(section: Section, i: int, s: Array) -> Array:
    """Length along face i per length along the meridian."""
    y, slope = section.interfaces(s)[i], section.interface_slopes(s)[i]
    return np.hypot(1 + section.line.curvature(s) * y, slope)


def _across(section: Section, i: int, s: float, size: float, through: int) -> Array:
    """Points through layer i at station s, edges growing away from both faces."""
    faces = section.interfaces(s)
    low, high = float(faces[i]), float(faces[i + 1])
    at = np.array([s])
    first, last = (float(_edge_length(section, j, at, size, through)[0]) for j in (i, i + 1))

    def target_size(y: Array) -> Array:
        return np.minimum(size, np.minimum(first + GROWTH * (y - low), last + GROWTH * (high - y)))

    y = graded(low, high, target_size, through)
    return np.asarray(section.line.position(s) + y[:, None] * section.line.normal(s))
