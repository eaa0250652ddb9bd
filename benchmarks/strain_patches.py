"""Means of strains over round patches of a tyre's section: quantities that converge where strains at points do not.

A sharp corner of two materials or of a held edge has an infinite strain: it grows with every finer mesh, in every code.
Its mean over a patch of a stated size is finite, because the strain grows slower than 1/distance.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array
from scipy.spatial import cKDTree

from tyrefem.mechanics.solid.elements import Rings

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
#: Largest cell of the means, and distance of the centres, over the radius; least share of the disc in the region.
CELL, SPACING, COVERED = 0.1, 0.125, 0.5


@dataclass(frozen=True, eq=False)
class Patches:
    """Discs of the section before inflation, cut to some elements. Their centres are those of a grid, not of a mesh.

    Parameters
    ----------
    rings : elements with 3 x 3 Gauss points; inside an element a strain is the polynomial through these points.
    elements : (k,) those of a region. radius : of the discs, m.
    centres : (2, n), m; None: all points of a grid whose disc lies at least half in the region.

    >>> import skfem
    >>> rings = Rings(skfem.MeshQuad.init_tensor([1.0, 1.1, 1.2], [0.0, 0.1]))
    >>> patches = Patches(rings, np.arange(2), 0.03, np.array([[1.1], [0.05]]))
    >>> patches.means(rings.points[0]).round(4)
    array([1.1])
    """

    rings: Rings
    elements: Indices
    radius: float
    centres: Array | None = None

    @functools.cached_property
    def _cells(self) -> tuple[Array, Array, Array]:
        """Places (2, k, c) and areas (k, c) of cells, m and m2, and values (c, 9) of the polynomials."""
        corners = self.rings.mesh.p[:, self.rings.mesh.t[:, self.elements]]
        edges = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=0).max(axis=1)
        # Cells of long elements are many along them, and few across.
        counts = [math.ceil(max(edges[k], edges[k + 2]) / (CELL * self.radius)) for k in (0, 1)]
        middles = ((np.arange(count) + 0.5) / count for count in counts)
        x = np.stack([a.ravel() for a in np.meshgrid(*middles, indexing="ij")])
        mapping = self.rings.mesh.mapping()
        places = np.asarray(mapping.F(x, self.elements))
        areas = np.abs(np.asarray(mapping.detDF(x, self.elements))) / math.prod(counts)

        def powers(at: Array) -> Array:
            return np.stack([at[0] ** i * at[1] ** j for i in range(3) for j in range(3)], axis=-1)

        return places, areas, powers(x) @ np.linalg.inv(powers(np.asarray(self.rings.basis.X)))

    @functools.cached_property
    def places(self) -> Array:
        """(2, n) centres, m."""
        return self._built[0]

    @property
    def weights(self) -> Any:
        """(n, elements x points) sparse: the mean is this times a strain at the points."""
        return self._built[1]

    @functools.cached_property
    def _built(self) -> tuple[Array, Any]:
        places, areas, values = self._cells
        flat = places.reshape(2, -1).T
        if self.centres is None:
            step = SPACING * self.radius
            low, high = (np.round(end / step) for end in (flat.min(axis=0), flat.max(axis=0)))
            grid = np.meshgrid(*(np.arange(a, b + 1) * step for a, b in zip(low, high, strict=True)))
            candidates = np.stack([axis.ravel() for axis in grid], axis=-1)
        else:
            candidates = np.asarray(self.centres).T
        pairs = cKDTree(candidates).sparse_distance_matrix(cKDTree(flat), self.radius, output_type="ndarray")
        inside = csr_array(
            (areas.ravel()[pairs["j"]], (pairs["i"], pairs["j"])), shape=(len(candidates), areas.size)
        )  # fmt: skip
        covered = np.asarray(inside.sum(axis=1))
        least = COVERED * math.pi * self.radius**2 if self.centres is None else 0.0
        chosen = np.flatnonzero(covered > least)
        of_cells = diags_array(1 / covered[chosen]) @ inside[chosen]
        return candidates[chosen].T, of_cells @ self._at_cells(values)

    def _at_cells(self, values: Array) -> Any:
        """(cells, elements x points) sparse: a strain at the cells is this times that at the points."""
        count, points = values.shape
        columns = self.elements[:, None, None] * points + np.arange(points)
        rows = np.arange(len(self.elements) * count).reshape(-1, count, 1)
        every = np.broadcast_arrays(values[None], rows, columns)
        entries, rows, columns = (part.ravel() for part in every)
        return csr_array((entries, (rows, columns)), shape=(len(self.elements) * count, self.rings.radii.size))

    def means(self, strain: Array) -> Array:
        """Means (..., n, angles) of (..., e, 9, angles); (n,) of (e, 9)."""
        if strain.ndim == 2:
            return np.asarray(self.weights @ strain.ravel())
        before, (points, angles) = strain.shape[:-3], (self.weights.shape[1], strain.shape[-1])
        flat = np.moveaxis(strain.reshape(-1, points, angles), 0, 1).reshape(points, -1)
        made = (self.weights @ flat).reshape(len(self.places[0]), -1, angles)
        return np.asarray(np.moveaxis(made, 0, 1).reshape(*before, -1, angles))
