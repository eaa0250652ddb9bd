"""Find the elements that hold given points, and evaluate a finite-element field there."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_matrix

from tyrefem.cache import Content
from tyrefem.conduction.operators import Operators
from tyrefem.errors import InputError

Array = NDArray[Any]

_SNAP = 1e-9


def as_points(points: ArrayLike) -> Array:
    """Points as an array (n, 2); a single pair is one point."""
    try:
        array = np.asarray(points, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"wanted finite pairs of coordinates, (n, 2); not {points!r:.60}", field="points") from None
    if array.ndim == 1 and array.size == 2:
        array = array[None]
    if array.ndim != 2 or array.shape[1] != 2 or not np.isfinite(array).all():
        raise InputError(f"wanted finite pairs of coordinates, (n, 2); got shape {array.shape}", field="points")
    return array


class OutsideMeshError(InputError):
    """Points outside a mesh: the message gives the first of them; ``numbers`` holds all."""

    def __init__(self, message: str, numbers: Array) -> None:
        super().__init__(message, field="points")
        self.numbers = numbers


class Located:
    """Element and reference coordinates of points in a mesh.

    Raises OutsideMeshError for points further outside than 1e-9 of the mesh's size.
    """

    def __init__(self, ops: Operators, points: Array) -> None:
        self.ops = ops
        mesh = ops.mesh
        corners = mesh.p[:, mesh.t[: 3 if "Tri" in type(mesh).__name__ else 4]]
        mapped = mesh.p[:, mesh.dofs.element_dofs] if mesh.p.shape[1] > mesh.nvertices else corners
        low, high = mapped.min(axis=1), mapped.max(axis=1)
        size = float(np.ptp(mesh.p, axis=1).max())
        curved = mapped.shape[1] > corners.shape[1]
        margin = (0.1 * (high - low).max(axis=0) if curved else 0.0) + _SNAP * size
        self.elements = np.empty(len(points), dtype=np.int64)
        self.local = np.empty((2, len(points)))
        chunk = max(1, 4_000_000 // low.shape[1])
        lost = [
            start
            + self._locate(points, slice(start, min(start + chunk, len(points))), low - margin, high + margin, size)
            for start in range(0, len(points), chunk)
        ]
        outside = np.concatenate(lost) if lost else np.zeros(0, dtype=np.int64)
        if outside.size:
            point = points[outside[0]]
            raise OutsideMeshError(
                f"point ({point[0]:.6g}, {point[1]:.6g}) m lies {distance(self.ops, point):.3g} m outside the mesh",
                outside,
            )

    def _locate(self, points: Array, part: slice, low: Array, high: Array, size: float) -> Array:
        """Find, among all elements whose box holds a point, the nearest one; return the numbers of points outside."""
        x, y = points[part, :1], points[part, 1:]
        boxed = (low[0] <= x) & (x <= high[0]) & (low[1] <= y) & (y <= high[1])
        owner, elements = np.nonzero(boxed)
        local, miss = self._nearest(points[part][owner], elements)
        order = np.lexsort((miss, owner))
        first = order[np.unique(owner[order], return_index=True)[1]]
        hit = first[miss[first] <= _SNAP * size]
        self.elements[part][owner[hit]], self.local[:, part][:, owner[hit]] = elements[hit], local[:, hit]
        return np.setdiff1d(np.arange(len(x)), owner[hit])

    def _nearest(self, points: Array, elements: Array) -> tuple[Array, Array]:
        """Reference coordinates of the nearest point of each element, and its distance, m."""
        mapping, triangle = self.ops.basis.mapping, self.ops.skfem_element.refdom.nnodes == 3
        target = points.T[:, :, None]
        X = np.full(target.shape, 1 / 3 if triangle else 0.5)
        for _ in range(30 if elements.size else 0):
            gap = target - mapping.F(X, tind=elements)
            step = np.einsum("ijkl,jkl->ikl", mapping.invDF(X, tind=elements), gap)
            X = np.clip(X + step, -2.0, 3.0)
            if np.max(np.abs(step)) < 1e-13:
                break
        inside = np.clip(X, 0.0, None if triangle else 1.0)
        if triangle:
            inside = inside / np.clip(inside.sum(axis=0), 1.0, None)
        miss = np.hypot(*(target - mapping.F(inside, tind=elements)))[:, 0] if elements.size else np.zeros(0)
        return inside[:, :, 0], miss

    def value(self) -> csr_matrix:
        """Matrix (n_points, n) from unknowns to values."""
        return self._matrix(0)[0]

    def gradient(self) -> tuple[csr_matrix, csr_matrix]:
        """Matrices (n_points, n) from unknowns to the two slopes."""
        first, second = self._matrix(1)
        return first, second

    def _matrix(self, order: int) -> list[csr_matrix]:
        ops, n = self.ops, self.elements.size
        X = self.local[:, :, None]
        columns = ops.element_dofs[:, self.elements]
        values = []
        for i in range(columns.shape[0]):
            shape = ops.skfem_element.gbasis(ops.basis.mapping, X, i, tind=self.elements)[0]
            values.append(np.asarray(shape.grad)[:, :, 0] if order else np.asarray(shape)[None, ..., 0])
        stacked = np.stack([np.broadcast_to(v, (v.shape[0], n)) for v in values], axis=-1)
        rows = np.arange(0, columns.size + 1, columns.shape[0])
        return [csr_matrix((v.reshape(-1), columns.T.reshape(-1), rows), (n, ops.size)) for v in stacked]


def distance(ops: Operators, point: Array) -> float:
    """Distance from a point to the boundary of the mesh (straight facets), m."""
    mesh = ops.mesh
    ends = mesh.p[:, mesh.facets[:, mesh.boundary_facets()]]
    a, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    part = np.clip(((point[:, None] - a) * along).sum(0) / (along**2).sum(0), 0.0, 1.0)
    return float(np.min(np.hypot(*(point[:, None] - a - part * along))))


def located(ops: Operators, points: ArrayLike) -> Located:
    """The located points; the operators keep the latest few sets."""
    array = as_points(points)
    place: Located = ops.located.get(Content.of(array), lambda: Located(ops, array))
    return place
