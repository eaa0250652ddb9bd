"""Nine-node rings: shape functions, Gauss points, projected dilatation, boundaries, edges under pressure.

Large displacements use them directly; `tyrefem.mechanics.footprint.elements` builds the strains of harmonics on them.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError, nearest

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


#: 3 x 3 Gauss points on quadrilaterals, three on an edge.
INTORDER = 5


@dataclass(frozen=True, eq=False)
class Rings:
    """Biquadratic elements of a quadrilateral mesh in (r, z), m. Degree of freedom 2 i + c is component c of node i.

    >>> import skfem
    >>> rings = Rings(skfem.MeshQuad.init_tensor([1.0, 1.1, 1.2], [0.0, 0.1]))
    >>> rings.n_nodes, rings.weights.shape, round(float(rings.weights.sum()), 6)
    (15, (2, 9), 0.022)
    """

    mesh: Any

    def __post_init__(self) -> None:
        import skfem

        if not isinstance(self.mesh, skfem.MeshQuad):
            raise InputError("finite-element mechanics needs quadrilaterals: mesh.cell = 'quad'", field="mesh.cell")

    @functools.cached_property
    def basis(self) -> Any:
        """scikit-fem basis of the scalar biquadratic element."""
        import skfem

        return skfem.Basis(self.mesh, skfem.ElementQuad2(), intorder=INTORDER)

    @property
    def n_nodes(self) -> int:
        """Vertices, edge middles and element middles."""
        return int(self.basis.N)

    @functools.cached_property
    def nodes(self) -> Array:
        """(2, n_nodes) positions of the nodes, m."""
        return np.asarray(self.basis.doflocs)

    @functools.cached_property
    def element_nodes(self) -> Indices:
        """(n_elements, 9)."""
        return np.asarray(self.basis.element_dofs, dtype=np.int64).T

    @functools.cached_property
    def points(self) -> Array:
        """(2, n_elements, n_points) Gauss points, m."""
        return np.asarray(self.basis.global_coordinates())

    @property
    def radii(self) -> Array:
        """(n_elements, n_points) radius of the Gauss points, m."""
        return np.asarray(self.points[0])

    @functools.cached_property
    def weights(self) -> Array:
        """(n_elements, n_points) r dA, m3 per radian."""
        return np.asarray(self.basis.dx) * self.radii

    @functools.cached_property
    def values(self) -> Array:
        """(n_points, 9) shape functions."""
        return np.stack([np.asarray(f[0])[0] for f in self.basis.basis], axis=-1)

    @functools.cached_property
    def gradients(self) -> Array:
        """(2, n_elements, n_points, 9) derivatives by r and z, 1/m."""
        return np.stack([np.asarray(f[0].grad) for f in self.basis.basis], axis=-1)

    @functools.cached_property
    def linear_functions(self) -> Array:
        """(n_elements, n_points, 3): 1, xi, eta of every element, orthonormal with weight r dA."""
        xi, eta = 2 * np.asarray(self.basis.X) - 1
        functions = np.stack([np.ones_like(xi), xi, eta], axis=-1)
        mass = np.einsum("eq,qa,qb->eab", self.weights, functions, functions)
        inverse = np.linalg.inv(np.linalg.cholesky(mass))
        return np.asarray(np.einsum("eab,qb->eqa", inverse, functions))

    def boundary(self, name: str) -> Indices:
        """Facets of a named boundary.

        Raises
        ------
        InputError : the mesh has no such boundary.
        """
        boundaries = self.mesh.boundaries or {}
        if name not in boundaries:
            raise InputError(f"the mesh has no boundary '{name}'{nearest(name, boundaries)}")
        return np.asarray(boundaries[name], dtype=np.int64)

    def boundary_nodes(self, name: str) -> Indices:
        """Sorted nodes of a named boundary."""
        return np.unique(self.basis.get_dofs(facets=self.boundary(name)).flatten()).astype(np.int64)

    def edge_nodes(self, facets: Indices) -> Indices:
        """(n_facets, 3) nodes of facets: end, end, middle; their functions are `edge_functions`."""
        ends = np.asarray(self.basis.nodal_dofs)[0][np.asarray(self.mesh.facets)[:, facets]]
        return np.vstack([ends, np.asarray(self.basis.facet_dofs)[0][facets]]).T.astype(np.int64)

    def facet_basis(self, name: str) -> Any:
        """scikit-fem basis on the facets of a named boundary."""
        import skfem

        facets = self.boundary(name)
        try:
            return skfem.FacetBasis(self.mesh, skfem.ElementQuad2(), facets=facets, intorder=INTORDER)
        except Exception as error:  # scikit-fem raises a bare Exception where its own iteration does not converge
            if "Newton" not in str(error):
                raise
            raise InputError(
                f"an element at '{name}' is distorted too far to be computed with: less speed, load or pressure, or a "
                "smaller mesh.size"
            ) from None

    def region_of(self, element: int) -> str:
        """Name of the region that holds an element."""
        regions = [name for name, members in (self.mesh.subdomains or {}).items() if element in members]
        return regions[0] if regions else "no region"


def edge_functions(count: int) -> tuple[Array, Array, Array]:
    """Values and derivatives (count, 3 nodes) at Gauss points of [-1, 1], and weights (count,); end, end, middle."""
    x, weights = np.polynomial.legendre.leggauss(count)
    values = np.stack([x * (x - 1) / 2, x * (x + 1) / 2, 1 - x * x], axis=-1)
    return values, np.stack([x - 0.5, x + 0.5, -2 * x], axis=-1), weights


@dataclass(frozen=True, eq=False)
class PressedWall:
    """Edges of a boundary under a follower pressure; force on the body per radian

    f = -p int N n r ds,  n r ds = +-(r dz, -r dr) outwards  [N].
    """

    rings: Rings
    boundary: str

    @functools.cached_property
    def nodes(self) -> Indices:
        """(n_edges, 3): end, end, middle."""
        return self.rings.edge_nodes(self.rings.boundary(self.boundary))

    @functools.cached_property
    def outwards(self) -> Array:
        """(n_edges,) +1 where (dz, -dr) along the edge's nodes points out of the body."""
        mesh, facets = self.rings.mesh, self.rings.boundary(self.boundary)
        start, end = np.moveaxis(self.rings.nodes[:, self.nodes[:, :2]], -1, 0)
        centre = mesh.p[:, mesh.t[:, mesh.f2t[0, facets]]].mean(axis=1)
        out, along = (start + end) / 2 - centre, end - start
        return np.sign(out[0] * along[1] - out[1] * along[0])

    def force(self, places: Array) -> Array:
        """(n_edges, 3, 2) force of unit pressure at nodes (2, n_nodes), m2 per radian."""
        (r, dr, dz), values, _, weights = self._along(places)
        signed = -self.outwards[:, None] * weights * r
        return np.stack([np.einsum("fq,qa->fa", signed * part, values) for part in (dz, -dr)], axis=-1)

    def stiffness(self, places: Array) -> Array:
        """(n_edges, 3, 2, 3, 2) derivative of `force` with respect to node positions, m per radian."""
        (r, dr, dz), values, slopes, weights = self._along(places)
        signed = -self.outwards[:, None] * weights
        blocks = np.zeros((len(r), 3, 2, 3, 2))

        def integral(factor: Array, other: Array) -> Array:
            return np.einsum("fq,qa,qb->fab", signed * factor, values, other)

        blocks[:, :, 0, :, 0] = integral(dz, values)
        blocks[:, :, 0, :, 1] = integral(r, slopes)
        blocks[:, :, 1, :, 0] = -integral(dr, values) - integral(r, slopes)
        return blocks

    def _along(self, places: Array) -> tuple[tuple[Array, Array, Array], Array, Array, Array]:
        values, slopes, weights = edge_functions(3)
        r, z = places[:, self.nodes]
        return (r @ values.T, r @ slopes.T, z @ slopes.T), values, slopes, weights
