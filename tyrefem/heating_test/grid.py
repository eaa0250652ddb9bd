"""The mesh of the patch: quadrilaterals in (distance along the face, depth), mapped to spherical shells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import skfem
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_matrix

from tyrefem.conduction import Operators

Array = NDArray[Any]


@dataclass(frozen=True)
class Fineness:
    """Number of elements under the spot, outside it, and per layer; finer at the spot's edge and the outer face."""

    spot: int = 4
    beyond: int = 9
    layer: int = 4


#: Its largest error, 0.15 K of 120 K, is below the cameras' noise.
USUAL = Fineness()


def graded(length: float, count: int, first: float) -> Array:
    """Nodes from 0 to `length` with the first interval `first` and a constant ratio of neighbouring intervals.

    >>> graded(7.0, 3, 1.0).round(3).tolist()
    [0.0, 1.0, 3.0, 7.0]
    """
    if count == 1 or first * count >= length:
        return np.linspace(0.0, length, count + 1)
    from scipy.optimize import brentq

    # As a sum of powers, which also holds near the ratio 1.
    ratio = brentq(lambda q: first * float((q ** np.arange(count)).sum()) - length, 1.0, length / first)
    nodes = np.concatenate([[0.0], first * np.cumsum(ratio ** np.arange(count))])
    return np.asarray(nodes * (length / nodes[-1]))


@dataclass(frozen=True, eq=False)
class PatchGrid:
    """A mesh with named layers and the boundaries ``outer``, ``spot`` (part of it), ``inner``, ``rim``.

    Attributes
    ----------
    mesh : scikit-fem quadrilaterals in (r, z), the beam along -z, the spot's centre at (0, 0).
    along, depths : the straight coordinates of the mesh lines, m.
    places : (2, n) (distance along the face, depth) of every unknown.
    """

    mesh: Any
    along: Array
    depths: Array
    operators: Operators

    @classmethod
    def make(
        cls,
        names: Sequence[str],
        thicknesses: Sequence[float],
        radius: float,
        curvature: float,
        spot_radius: float,
        fineness: Fineness,
    ) -> PatchGrid:
        """Mesh layers of given thicknesses (outer first), m."""
        edge = float(np.arcsin(curvature * spot_radius) / curvature) if curvature else spot_radius
        # Fine on both sides of the spot's edge, where the flux has a step.
        inside = edge - graded(edge, fineness.spot, 0.5 * edge / fineness.spot)[::-1]
        outside = edge + graded(radius - edge, fineness.beyond, 0.6 * edge / fineness.spot)[1:]
        along = np.concatenate([inside, outside])
        depths, top = [0.0], 0.0
        for number, thickness in enumerate(thicknesses):
            nodes = graded(
                thickness, fineness.layer, thickness / (2.5 * fineness.layer if number == 0 else fineness.layer)
            )
            depths += list(top + nodes[1:])
            top += thickness
        borders = np.concatenate([[0.0], np.cumsum(thicknesses)])
        flat = skfem.MeshQuad.init_tensor(along, np.array(depths))
        s, d = flat.p
        middle = flat.p[:, flat.t].mean(axis=1)[1]
        bent = skfem.MeshQuad(np.stack(bend(s, d, curvature)), flat.t)
        layers = {
            n: np.flatnonzero((middle > a) & (middle < b)) for n, a, b in zip(names, borders, borders[1:], strict=False)
        }
        ends = flat.p[:, flat.facets]
        tiny = 1e-9 * radius
        outer = np.flatnonzero((np.abs(ends[1]) < tiny).all(axis=0))
        faces = {
            "outer": outer,
            "spot": outer[(ends[0][:, outer] < edge + tiny).all(axis=0)],
            "inner": np.flatnonzero((np.abs(ends[1] - top) < tiny).all(axis=0)),
            "rim": np.flatnonzero((np.abs(ends[0] - radius) < tiny).all(axis=0)),
        }
        named = bent.with_subdomains(layers).with_boundaries(faces)
        return cls(named, along, np.array(depths), Operators(named, "P2", True))

    @cached_property
    def _number(self) -> Array:
        """Index of the unknown at (line along, line in depth), including midlines."""
        straight = skfem.MeshQuad.init_tensor(self.along, self.depths)
        places = skfem.Basis(straight, skfem.ElementQuad2(), intorder=1).doflocs
        order = np.lexsort((places[1], places[0].round(12)))
        return order.reshape(2 * self.along.size - 1, 2 * self.depths.size - 1)

    def at(self, along: ArrayLike, depth: ArrayLike) -> csr_matrix:
        """Interpolation matrix (points, unknowns) for points given by distance along and depth, m.

        Points outside the patch get the value at its border.
        """
        s, d = np.broadcast_arrays(np.asarray(along, float), np.asarray(depth, float))
        (i, a), (j, b) = _quadratic(self.along, s.ravel()), _quadratic(self.depths, d.ravel())
        columns = self._number[i[:, :, None], j[:, None, :]].reshape(s.size, -1)
        values = (a[:, :, None] * b[:, None, :]).reshape(s.size, -1)
        rows = np.arange(0, columns.size + 1, columns.shape[1])
        return csr_matrix((values.ravel(), columns.ravel(), rows), (s.size, self._number.size))


def bend(along: Array, depth: Array, curvature: float) -> tuple[Array, Array]:
    """(r, z) of points given along the outer face and in depth: concentric shells of radius 1/curvature - depth."""
    if abs(curvature) < 1e-9:
        return np.asarray(along, float), -np.asarray(depth, float)
    R = 1.0 / curvature
    return (R - depth) * np.sin(along / R), (R - depth) * np.cos(along / R) - R


def _quadratic(lines: Array, x: Array) -> tuple[Array, Array]:
    """Indices (n, 3) of the three nodal lines about each point, and their Lagrange weights."""
    x = np.clip(x, lines[0], lines[-1])
    e = np.clip(np.searchsorted(lines, x, side="right") - 1, 0, lines.size - 2)
    u = (x - lines[e]) / (lines[e + 1] - lines[e])
    weights = np.stack([(1 - u) * (1 - 2 * u), 4 * u * (1 - u), u * (2 * u - 1)], axis=1)
    return 2 * e[:, None] + np.arange(3), weights
