"""Strain energies at the Gauss points of a mechanical mesh, interpolated to any points of the section."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.strain_cycle import Zone

if TYPE_CHECKING:
    from tyrefem.mechanics.rolling.friction_rings import FrictionRings
    from tyrefem.mechanics.solid.elements import Rings

Array = NDArray[np.float64]
#: Number of Gauss points per interpolated value; weights stay finite where a point coincides with a Gauss point.
NEAREST, SMALLEST = 4, 1e-12


@dataclass(frozen=True, eq=False)
class GaussPoints:
    """Gauss points of a mesh by region: values are not interpolated across the border of two compounds.

    >>> import skfem
    >>> from tyrefem.mechanics.solid.elements import Rings
    >>> mesh = skfem.MeshQuad.init_tensor([1.0, 1.1, 1.2], [0.0, 0.1]).with_subdomains({"rubber": np.arange(2)})
    >>> points = GaussPoints.of(Rings(mesh))
    >>> points.interpolate(np.full((2, 9), 3.0), "rubber", np.array([[1.05], [0.02]])).round(9).tolist()
    [3.0]
    """

    #: (2, n_elements, n_points) in (r, z) of the undeformed section, m; region -> its elements.
    points: Array
    members: Mapping[str, Array]
    _trees: dict[str, Any] = field(default_factory=dict, init=False, repr=False)

    @classmethod
    def of(cls, rings: Rings) -> GaussPoints:
        """The Gauss points of a mesh."""
        return cls(rings.points, rings.mesh.subdomains)

    def interpolate(self, values: Array, region: str, points: Array) -> Array:
        """(..., n) values (..., n_elements, n_points) at points (2, n) in (r, z) of the undeformed section: the mean of
        the four nearest Gauss points of the region, weighted with 1 / distance^2."""
        members = self.members[region]
        region_values = values[..., members, :].reshape(*values.shape[:-2], -1)
        count = min(NEAREST, region_values.shape[-1])
        distance, nearest = self._tree(region).query(np.asarray(points, dtype=float).T, k=count)
        weights = 1 / (distance.reshape(-1, count) ** 2 + SMALLEST)
        return np.asarray(
            (weights * region_values[..., nearest.reshape(-1, count)]).sum(axis=-1) / weights.sum(axis=-1)
        )

    def kept(self, densities: Array, weights: Array, region: str, heated: tuple[Array, Array]) -> Array:
        """(orders,) factors with which densities (orders, n_elements, n_points), interpolated to nodes (2, n) and
        summed with their volumes (n,), m3, have their integral over a region; 1 where there is nothing.

        ``weights``: (n_elements, n_points) volume of the points per radian, m3. ``heated``: nodes and volumes.
        """
        members, (nodes, volumes) = self.members[region], heated
        exact = 2 * np.pi * (densities[:, members] * weights[members]).sum(axis=(1, 2))
        taken = self.interpolate(densities, region, nodes) @ volumes
        return np.divide(exact, taken, out=np.ones_like(exact), where=(exact > 0) & (taken > 0))

    def _tree(self, region: str) -> Any:
        if region not in self._trees:
            from scipy.spatial import cKDTree

            self._trees[region] = cKDTree(self.points[:, self.members[region]].reshape(2, -1).T)
        return self._trees[region]


@dataclass(frozen=True, eq=False)
class PointEnergies:
    """A strain cycle as energies at Gauss points: ``densities`` (orders, n_elements, n_points) U, J/m3, by
    `ORDERS`. Each of the ``zones`` is a whole region. ``friction``: of the tread's rings, if it rolls with
    friction."""

    zones: tuple[Zone, ...]
    points: GaussPoints
    densities: Array
    friction: FrictionRings | None = None

    @functools.cached_property
    def density(self) -> Array:
        """(n_elements, n_points) U, J/m3."""
        return np.asarray(self.densities.sum(axis=0))

    def energy_density(self, zone: str, points: Array) -> Array:
        """U, J/m3, at points (2, n) in (r, z) of a region of the undeformed section."""
        return self.points.interpolate(self.density, zone, points)

    def spectrum(self, zone: str, points: Array) -> Array:
        """(orders, n) U, J/m3, at points (2, n) by `ORDERS`."""
        return self.points.interpolate(self.densities, zone, points)

    def interpolated(self, others: Sequence[tuple[PointEnergies, float]]) -> PointEnergies:
        """U + sum_i w_i (U_i - U), never below 0: interpolation to other cycles at the same points with weights w_i."""
        size = max(len(energies.densities) for energies in (self, *(other for other, _ in others)))
        densities = padded(self.densities, size)
        for other, share in others:
            densities = densities + share * (padded(other.densities, size) - padded(self.densities, size))
        friction = self.friction
        if friction is not None:
            rings = [(other.friction, share) for other, share in others if other.friction is not None]
            friction = friction.interpolated(rings)
        return PointEnergies(self.zones, self.points, np.maximum(densities, 0.0), friction)


def padded(densities: Array, size: int) -> Array:
    """Densities (orders, n_elements, n_points) with zeros up to a number of orders."""
    return np.pad(densities, ((0, size - len(densities)), (0, 0), (0, 0)))
