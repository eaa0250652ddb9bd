"""Finite-element operators of one mesh: assembled once, then combined as sums of arrays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, hstack

from tyrefem.cache import Cache, fingerprint, read_only
from tyrefem.conduction.equation import conduction, storage
from tyrefem.conduction.function_space import FunctionSpace
from tyrefem.conduction.linear_solver import Ordering
from tyrefem.conduction.quadrature import Quadrature, Surface

Array = NDArray[Any]

#: Number of operators kept, by mesh, element and symmetry, beside those in use. 1 MB to some 100 MB each.
_OPERATORS: Cache[Operators] = Cache(size=6, shared=True)
#: Number of operators and quadratures that one mesh keeps: about seven for each of some dozen regions and boundaries.
KEPT = 512
#: Number of located sets of points that one mesh keeps.
POINT_SETS = 8


class Operators(FunctionSpace):
    """Mass, conduction and surface operators of a mesh, all on one sparsity pattern.

    Every operator is an array of values on the common CSR pattern, so K = sum k_i K_i + sum h_j R_j is a sum of
    arrays. In axisymmetry the volume element is 2 pi r dr dz: energies and powers are those of the full ring.

    Parameters
    ----------
    mesh : scikit-fem triangle or quadrilateral mesh with named subdomains and boundaries.
    element : "P1" (linear, bilinear) or "P2" (quadratic, biquadratic).
    axisymmetric : coordinates are (r, z); otherwise (x, y) and one metre of depth.

    Raises InputError for an unknown element, an unsupported mesh or a negative radius.
    """

    def __init__(self, mesh: Any, element: str = "P1", axisymmetric: bool = True) -> None:
        super().__init__(mesh, element, axisymmetric)
        self._assembled: Cache[Any] = Cache(size=KEPT)
        #: Located points of this mesh, by their content; see `tyrefem.conduction.points.located`.
        self.located: Cache[Any] = Cache(size=POINT_SETS)

    def __reduce__(self) -> tuple[Any, ...]:
        """For another process: it assembles the operators again, which is faster than their transfer."""
        return operators_of, (self.mesh, self.element, self.axisymmetric)

    def __repr__(self) -> str:
        shape = "axisymmetric" if self.axisymmetric else "planar"
        return f"Operators ({self.element}, {shape}, {self.size} unknowns)"

    def _cached(self, key: Any, make: Callable[[], Any]) -> Any:
        return self._assembled.get(key, make)

    def mean_weight(self) -> Array:
        """Weights (n,) whose product with the unknowns is the volume mean."""

        def make() -> Array:
            load = np.einsum("ieq,eq->ie", self.phi, self.weight)
            row = np.bincount(self.element_dofs.reshape(-1), weights=load.reshape(-1), minlength=self.size)
            return row / row.sum()

        return self._cached("mean", make)

    def dofs(self, name: str) -> Array:
        """Unknowns of a named subdomain, increasing."""
        return self._cached(("dofs", name), lambda: np.unique(self.element_dofs[:, self.elements(name)]))

    def nodes(self, name: str) -> Array:
        """Points (2, n) of a named subdomain: the same array object at every call, read-only."""
        return self._cached(("nodes", name), lambda: read_only(np.ascontiguousarray(self.points[:, self.dofs(name)])))

    def _gather(self, elements: Array, local: Array) -> Array:
        place = self.place[:, :, elements]
        return np.bincount(place.reshape(-1), weights=local.reshape(-1), minlength=self.nnz)

    def mass(self, name: str) -> Array:
        """Values of the integral of v u over a subdomain."""

        def make() -> Array:
            e = self.elements(name)
            return self._gather(e, self.integrals(storage, e))

        return self._cached(("mass", name), make)

    def mass_row(self, name: str) -> Array:
        """Integral of every shape function over a subdomain, (n,): the load of a unit heat source."""
        return self._cached(("mass row", name), lambda: self.matrix(self.mass(name)) @ np.ones(self.size))

    def conduction(self, name: str, direction: Callable[..., Any] | None) -> tuple[Array, Array]:
        """Values of the integrals of v,1 u,1 and v,2 u,2 (along, across `direction`) over a subdomain."""

        def make() -> tuple[Array, Array]:
            e = self.elements(name)
            even = self.constant_slopes and direction is None
            along, across = self.directions(name, direction)
            first, second = (self._gather(e, self.integrals(conduction, e, even, d=d)) for d in (along, across))
            return first, second

        return self._cached(("conduction", name, direction), make)

    def source(self, *names: str) -> csr_matrix:
        """Nodal source (W/m3 at `nodes(name)`) to nodal load (W): consistent mass, (n, n_nodes).

        For several subdomains, their nodes are concatenated.
        """

        def make() -> csr_matrix:
            return hstack([self.matrix(self.mass(name)).tocsc()[:, self.dofs(name)] for name in names], format="csr")

        return self._cached(("source", *names), make)

    def quadrature(self, name: str, direction: Callable[..., Any] | None = None) -> Quadrature:
        """Quadrature of a region for coefficients that depend on temperature."""
        return self._cached(("quadrature", name, direction), lambda: Quadrature(self, name, direction))

    def surface(self, name: str) -> Surface:
        """Quadrature of a named boundary."""
        return self._cached(("surface", name), lambda: Surface(self, name))

    def ordering(self, free: Array) -> Ordering:
        """Elimination order for the given free unknowns."""
        hint = None
        if self.element == "P2":
            hint = self._cached(("hint",), self._hint)
        key = ("ordering", free.tobytes())
        return self._cached(key, lambda: Ordering(self.indptr, self.indices, free, hint))

    def _hint(self) -> Array:
        """Order of the unknowns by corner nodes of their elements; the graph of quadratic elements orders badly."""
        linear = operators_of(self.mesh, "P1", self.axisymmetric)
        order = linear.ordering(np.arange(linear.size)).order
        place = np.empty(linear.size)
        place[order] = np.arange(linear.size)
        corner = place[linear.element_dofs]
        total, count = np.zeros(self.size), np.zeros(self.size)
        weights = np.abs(self.skfem_element.doflocs[:, None, :] - linear.skfem_element.doflocs[None]).max(2) < 0.75
        for i, row in enumerate(weights):
            near = corner[row] if row.any() else corner
            np.add.at(total, self.element_dofs[i], near.mean(axis=0))
            np.add.at(count, self.element_dofs[i], 1.0)
        return total / count


def operators_of(mesh: Any, element: str = "P1", axisymmetric: bool = True) -> Operators:
    """The operators of a mesh, shared by every problem on an equal mesh.

    >>> import skfem
    >>> operators_of(skfem.MeshTri().refined(2), "P1", False) is operators_of(skfem.MeshTri().refined(2), "P1", False)
    True
    """
    key = (_content(mesh), element, axisymmetric)
    return _OPERATORS.get(key, lambda: Operators(mesh, element, axisymmetric))


def _content(mesh: Any) -> tuple[Any, ...]:
    """The key of operators: the mesh's kind, nodes, elements, and named parts with their sides."""
    parts = [
        (name, fingerprint(numbers, getattr(numbers, "ori", np.zeros(0))))
        for named in (mesh.subdomains, mesh.boundaries)
        for name, numbers in (named or {}).items()
    ]
    count = len(mesh.subdomains or {})
    return type(mesh), fingerprint(mesh.doflocs, mesh.t), count, *parts
