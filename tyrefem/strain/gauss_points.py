"""From the Gauss points of a mechanical mesh to any points of the section."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.strain import Zone

if TYPE_CHECKING:
    from tyrefem.solid.elements import Rings

Array = NDArray[np.float64]
#: So many Gauss points make a value; their weights stay finite where a point meets one.
NEAREST, SMALLEST = 4, 1e-12


@dataclass(frozen=True, eq=False)
class GaussPoints:
    """Gauss points of a mesh, region by region: no value crosses the border between two compounds.

    >>> import skfem
    >>> from tyrefem.solid.elements import Rings
    >>> mesh = skfem.MeshQuad.init_tensor([1.0, 1.1, 1.2], [0.0, 0.1]).with_subdomains({"rubber": np.arange(2)})
    >>> points = GaussPoints(Rings(mesh))
    >>> points.interpolate(np.full((2, 9), 3.0), "rubber", np.array([[1.05], [0.02]])).round(9).tolist()
    [3.0]
    """

    rings: Rings
    _trees: dict[str, Any] = field(default_factory=dict, init=False, repr=False)

    def interpolate(self, values: Array, region: str, points: Array) -> Array:
        """(..., n) values (..., n_elements, n_points) at points (2, n) in (r, z) of the undeformed section: the mean of
        the four nearest Gauss points of the region, weighted with 1 / distance^2."""
        members = self.rings.mesh.subdomains[region]
        here = values[..., members, :].reshape(*values.shape[:-2], -1)
        count = min(NEAREST, here.shape[-1])
        distance, nearest = self._tree(region).query(np.asarray(points, dtype=float).T, k=count)
        weights = 1 / (distance.reshape(-1, count) ** 2 + SMALLEST)
        return np.asarray((weights * here[..., nearest.reshape(-1, count)]).sum(axis=-1) / weights.sum(axis=-1))

    def _tree(self, region: str) -> Any:
        if region not in self._trees:
            from scipy.spatial import cKDTree

            members = self.rings.mesh.subdomains[region]
            self._trees[region] = cKDTree(self.rings.points[:, members].reshape(2, -1).T)
        return self._trees[region]


@dataclass(frozen=True, eq=False)
class PointEnergies:
    """A strain cycle as energies at Gauss points: ``densities`` (orders, n_elements, n_points) U, J/m3, by
    `strain.ORDERS`, of ``zones`` that are whole regions."""

    zones: tuple[Zone, ...]
    points: GaussPoints
    densities: Array

    @functools.cached_property
    def density(self) -> Array:
        """(n_elements, n_points) U, J/m3."""
        return np.asarray(self.densities.sum(axis=0))

    def energy_density(self, zone: str, points: Array) -> Array:
        """U, J/m3, at points (2, n) in (r, z) of a region of the undeformed section."""
        return self.points.interpolate(self.density, zone, points)

    def spectrum(self, zone: str, points: Array) -> Array:
        """(orders, n) the same by `strain.ORDERS`."""
        return self.points.interpolate(self.densities, zone, points)

    def moved(self, others: Sequence[tuple[PointEnergies, float]]) -> PointEnergies:
        """U + sum_i w_i (U_i - U) with shares w_i of the way to other cycles at the same points; nowhere below 0."""
        size = max(len(one.densities) for one in (self, *(other for other, _ in others)))
        found = _padded(self.densities, size)
        for other, share in others:
            found = found + share * (_padded(other.densities, size) - _padded(self.densities, size))
        return PointEnergies(self.zones, self.points, np.maximum(found, 0.0))


def _padded(densities: Array, size: int) -> Array:
    return np.pad(densities, ((0, size - len(densities)), (0, 0), (0, 0)))
