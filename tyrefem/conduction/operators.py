"""Finite-element operators of one mesh: assembled once, then combined by numbers only."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from typing import Any
from weakref import WeakValueDictionary

import numpy as np
import skfem
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, hstack

from tyrefem.conduction.factor import Ordering
from tyrefem.conduction.quadrature import Quadrature, Surface
from tyrefem.errors import InputError, nearest

Array = NDArray[Any]

_ELEMENTS = {
    ("tri", "P1"): skfem.ElementTriP1,
    ("tri", "P2"): skfem.ElementTriP2,
    ("quad", "P1"): skfem.ElementQuad1,
    ("quad", "P2"): skfem.ElementQuad2,
}
#: The latest; and all that are still held by anyone, however many meshes came since.
_RECENT: OrderedDict[tuple[int, str, bool], Operators] = OrderedDict()
_ALIVE: WeakValueDictionary[tuple[int, str, bool], Operators] = WeakValueDictionary()


class Operators:
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
        kind = {"MeshTri": "tri", "MeshQua": "quad"}.get(type(mesh).__name__[:7])
        if kind is None:
            raise InputError(f"a {type(mesh).__name__} is not supported; use MeshTri or MeshQuad", field="mesh")
        if element not in ("P1", "P2"):
            raise InputError(f"unknown element {element!r}{nearest(str(element), ['P1', 'P2'])}", field="element")
        if axisymmetric and mesh.p[0].min() < -1e-12 * np.ptp(mesh.p, axis=1).max():
            raise InputError(f"radius is negative: {mesh.p[0].min():.6g} m", field="mesh")
        self.mesh, self.element, self.axisymmetric = mesh, element, axisymmetric
        self.skfem_element = _ELEMENTS[kind, element]()
        self.intorder = 3 if element == "P1" else 5
        self.basis = skfem.Basis(mesh, self.skfem_element, intorder=self.intorder)
        self.size = int(self.basis.N)
        self.points: Array = self.basis.doflocs
        self.element_dofs: Array = self.basis.element_dofs
        shape = self.basis.dx.shape
        self.phi = np.broadcast_to(
            np.stack([np.broadcast_to(np.asarray(b[0]), shape)[:1] for b in self.basis.basis]),
            (len(self.basis.basis), *shape),
        )
        self._grad = np.stack([b[0].grad for b in self.basis.basis])
        self.x: Array = np.asarray(self.basis.global_coordinates())
        self.weight: Array = self.basis.dx * (2 * np.pi * self.x[0] if axisymmetric else 1.0)
        self.constant_slopes = type(mesh) is skfem.MeshTri1 and element == "P1"
        self._pattern()
        self.remembered: dict[Any, Any] = {}

    def __reduce__(self) -> tuple[Any, ...]:
        """Another process assembles them again: that takes less time than sending them."""
        return operators_of, (self.mesh, self.element, self.axisymmetric)

    def __repr__(self) -> str:
        shape = "axisymmetric" if self.axisymmetric else "planar"
        return f"Operators ({self.element}, {shape}, {self.size} unknowns)"

    def _pattern(self) -> None:
        n, dofs = self.size, self.element_dofs.astype(np.int64)
        keys = dofs[:, None, :] * n + dofs[None, :, :]
        unique, self.place = np.unique(keys.reshape(-1), return_inverse=True)
        self.place = self.place.reshape(keys.shape)
        self.keys = unique
        self.indices = (unique % n).astype(np.int32)
        self.indptr = np.concatenate(([0], np.cumsum(np.bincount(unique // n, minlength=n)))).astype(np.int32)

    def _once(self, key: Any, make: Callable[[], Any]) -> Any:
        if key not in self.remembered:
            self.remembered[key] = make()
        return self.remembered[key]

    @property
    def nnz(self) -> int:
        """Number of stored values of every operator."""
        return int(self.indices.size)

    def matrix(self, data: Array) -> csr_matrix:
        """Values on the common pattern as a sparse matrix (n, n)."""
        return csr_matrix((data, self.indices, self.indptr), (self.size, self.size))

    def mean_weight(self) -> Array:
        """Weights (n,) whose product with the unknowns is the volume mean."""

        def make() -> Array:
            load = np.einsum("ieq,eq->ie", self.phi, self.weight)
            row = np.bincount(self.element_dofs.reshape(-1), weights=load.reshape(-1), minlength=self.size)
            return row / row.sum()

        return self._once("mean", make)

    def elements(self, name: str) -> Array:
        """Element numbers of a named subdomain."""
        subdomains = self.mesh.subdomains or {}
        if name not in subdomains:
            raise InputError(f"unknown region {name!r}{nearest(name, subdomains)}", field="regions")
        return np.asarray(subdomains[name], dtype=np.int64)

    def dofs(self, name: str) -> Array:
        """Unknowns of a named subdomain, increasing."""
        return self._once(("dofs", name), lambda: np.unique(self.element_dofs[:, self.elements(name)]))

    def nodes(self, name: str) -> Array:
        """Points (2, n) of a named subdomain: the same array object at every call."""
        return self._once(("nodes", name), lambda: np.ascontiguousarray(self.points[:, self.dofs(name)]))

    def _gather(self, elements: Array, local: Array) -> Array:
        place = self.place[:, :, elements]
        return np.bincount(place.reshape(-1), weights=local.reshape(-1), minlength=self.nnz)

    def mass(self, name: str) -> Array:
        """Values of the integral of v u over a subdomain."""

        def make() -> Array:
            e = self.elements(name)
            phi = self.phi[:, 0]  # The same in every element: one matrix product assembles them all.
            products = (phi[:, None] * phi[None]).reshape(-1, phi.shape[1])
            local = products @ self.weight[e].T
            return self._gather(e, local.reshape(len(phi), len(phi), -1))

        return self._once(("mass", name), make)

    def mass_row(self, name: str) -> Array:
        """Integral of every shape function over a subdomain, (n,): what a unit of heat per volume does."""
        return self._once(("mass row", name), lambda: self.matrix(self.mass(name)) @ np.ones(self.size))

    def directed_gradients(self, name: str, direction: Callable[..., Any] | None) -> tuple[Array, Array]:
        """Shape-function slopes along and across `direction` at the quadrature points, (n_local, n_el, n_q)."""
        e = self.elements(name)
        grad = self._grad[:, :, e]
        if direction is None:
            return grad[:, 0], grad[:, 1]
        x = self.x[:, e]
        d = np.asarray(direction(x.reshape(2, -1)), dtype=float)
        if d.shape != (2, x[0].size) or not np.allclose(np.hypot(*d), 1.0, atol=1e-6):
            raise InputError("direction must return unit vectors of shape (2, n)", field=f"regions.{name}")
        d = d.reshape(x.shape)
        return d[0] * grad[:, 0] + d[1] * grad[:, 1], -d[1] * grad[:, 0] + d[0] * grad[:, 1]

    def conduction(self, name: str, direction: Callable[..., Any] | None) -> tuple[Array, Array]:
        """Values of the integrals of v,1 u,1 and v,2 u,2 (along, across `direction`) over a subdomain."""

        def make() -> tuple[Array, Array]:
            e = self.elements(name)
            w = self.weight[e]
            slopes = self.directed_gradients(name, direction)
            if self.constant_slopes and direction is None:
                slopes, w = (slopes[0][:, :, :1], slopes[1][:, :, :1]), w.sum(axis=1, keepdims=True)
            first, second = (self._gather(e, np.einsum("ieq,jeq->ije", g * w, g, optimize=True)) for g in slopes)
            return first, second

        return self._once(("conduction", name, direction), make)

    def source(self, *names: str) -> csr_matrix:
        """Nodal source (W/m3 at `nodes(name)`) to nodal load (W): consistent mass, (n, n_nodes).

        Several subdomains: their nodes one after the other.
        """

        def make() -> csr_matrix:
            return hstack([self.matrix(self.mass(name)).tocsc()[:, self.dofs(name)] for name in names], format="csr")

        return self._once(("source", *names), make)

    def quadrature(self, name: str, direction: Callable[..., Any] | None = None) -> Quadrature:
        """Quadrature of a region for coefficients that depend on temperature."""
        return self._once(("quadrature", name, direction), lambda: Quadrature(self, name, direction))

    def surface(self, name: str) -> Surface:
        """Quadrature of a named boundary."""
        return self._once(("surface", name), lambda: Surface(self, name))

    def ordering(self, free: Array) -> Ordering:
        """Elimination order for the given free unknowns."""
        hint = None
        if self.element == "P2":
            hint = self._once(("hint",), self._hint)
        key = ("ordering", free.tobytes())
        return self._once(key, lambda: Ordering(self.indptr, self.indices, free, hint))

    def _hint(self) -> Array:
        """Order every unknown by its element's corner nodes: the quadratic graph alone orders badly."""
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
    """The operators of a mesh, shared by every problem on the same mesh object.

    >>> import skfem
    >>> mesh = skfem.MeshTri().refined(2)
    >>> operators_of(mesh, "P1", False) is operators_of(mesh, "P1", False)
    True
    """
    key = (id(mesh), element, axisymmetric)
    found = _ALIVE.get(key)
    if found is None or found.mesh is not mesh:
        found = _ALIVE[key] = Operators(mesh, element, axisymmetric)
    _RECENT[key] = found
    _RECENT.move_to_end(key)
    while len(_RECENT) > 6:
        _RECENT.popitem(last=False)
    return found
