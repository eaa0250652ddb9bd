"""From the Gauss points of a mechanical mesh to any points of the section."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

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
