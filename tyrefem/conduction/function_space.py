"""The function space of a mesh: shape functions at quadrature points and one sparsity pattern for all operators."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import skfem
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from skfem.assembly.form.form import FormExtraParams

from tyrefem.cache import read_only
from tyrefem.errors import InputError, nearest

Array = NDArray[Any]

_ELEMENTS = {
    ("tri", "P1"): skfem.ElementTriP1,
    ("tri", "P2"): skfem.ElementTriP2,
    ("quad", "P1"): skfem.ElementQuad1,
    ("quad", "P2"): skfem.ElementQuad2,
}

#: Largest number of values of an integrand at a time, so that it fits a processor's cache.
_CHUNK = 500_000


def integrand(form: skfem.BilinearForm, phi: Array, slopes: Array | None = None, **data: Array) -> Array:
    """A form for every pair of shape functions: (test i, trial j, element, point).

    ``phi`` (i, element, point) are the shape functions, ``slopes`` (2, i, element, point) their gradients, ``data``
    values for the names ``w.name`` in the form.
    """
    T = skfem.DiscreteField(phi[None], None if slopes is None else slopes[:, None])
    v = skfem.DiscreteField(phi[:, None], None if slopes is None else slopes[:, :, None])
    return np.asarray(form.form(T, v, FormExtraParams(data)))


def kind_of(mesh: Any) -> str:
    """Kind of a mesh's elements, "tri" or "quad".

    Raises
    ------
    InputError : an unsupported mesh.

    >>> kind_of(skfem.MeshTri())
    'tri'
    """
    kind = {"MeshTri": "tri", "MeshQua": "quad"}.get(type(mesh).__name__[:7])
    if kind is None:
        raise InputError(f"a {type(mesh).__name__} is not supported; use MeshTri or MeshQuad", field="mesh")
    return kind


class FunctionSpace:
    """Shape functions, quadrature and the common CSR pattern of a mesh.

    In axisymmetry the volume element is 2 pi r dr dz: energies and powers are those of the full ring.

    Parameters
    ----------
    mesh : scikit-fem triangle or quadrilateral mesh with named subdomains and boundaries.
    element : "P1" (linear, bilinear) or "P2" (quadratic, biquadratic).
    axisymmetric : coordinates are (r, z); otherwise (x, y) and one metre of depth.

    Raises
    ------
    InputError : an unknown element, an unsupported mesh, a negative radius.

    >>> space = FunctionSpace(skfem.MeshTri().refined(1), "P1", axisymmetric=False)
    >>> space.size, round(float(space.weight.sum()), 12)
    (9, 1.0)
    """

    def __init__(self, mesh: Any, element: str = "P1", axisymmetric: bool = True) -> None:
        kind = kind_of(mesh)
        if element not in ("P1", "P2"):
            raise InputError(f"unknown element {element!r}{nearest(str(element), ['P1', 'P2'])}", field="element")
        if axisymmetric and mesh.p[0].min() < -1e-12 * np.ptp(mesh.p, axis=1).max():
            raise InputError(f"radius is negative: {mesh.p[0].min():.6g} m", field="mesh")
        self.mesh, self.element, self.axisymmetric = mesh, element, axisymmetric
        self.skfem_element = _ELEMENTS[kind, element]()
        self.intorder = 3 if element == "P1" else 5
        self.basis = skfem.Basis(mesh, self.skfem_element, intorder=self.intorder)
        self.size = int(self.basis.N)
        #: Read-only: problems on an equal mesh share the space.
        self.points: Array = read_only(self.basis.doflocs)
        self.element_dofs: Array = self.basis.element_dofs
        shape = self.basis.dx.shape
        self.phi = np.broadcast_to(
            np.stack([np.broadcast_to(np.asarray(b[0]), shape)[:1] for b in self.basis.basis]),
            (len(self.basis.basis), *shape),
        )
        self._grad = np.stack([b[0].grad for b in self.basis.basis], axis=1)
        self.x: Array = np.asarray(self.basis.global_coordinates())
        self.weight: Array = self.basis.dx * (2 * np.pi * self.x[0] if axisymmetric else 1.0)
        self.constant_slopes = type(mesh) is skfem.MeshTri1 and element == "P1"
        self._pattern()

    def _pattern(self) -> None:
        n, dofs = self.size, self.element_dofs.astype(np.int64)
        keys = dofs[:, None, :] * n + dofs[None, :, :]
        unique, self.place = np.unique(keys.reshape(-1), return_inverse=True)
        self.place = self.place.reshape(keys.shape)
        self.keys = unique
        self.indices = (unique % n).astype(np.int32)
        self.indptr = np.concatenate(([0], np.cumsum(np.bincount(unique // n, minlength=n)))).astype(np.int32)

    @property
    def nnz(self) -> int:
        """Number of stored values of every operator."""
        return int(self.indices.size)

    def matrix(self, data: Array) -> csr_matrix:
        """Values on the common pattern as a sparse matrix (n, n)."""
        return csr_matrix((data, self.indices, self.indptr), (self.size, self.size))

    def elements(self, name: str) -> Array:
        """Element numbers of a named subdomain."""
        subdomains = self.mesh.subdomains or {}
        if name not in subdomains:
            raise InputError(f"unknown region {name!r}{nearest(name, subdomains)}", field="regions")
        return np.asarray(subdomains[name], dtype=np.int64)

    def directed_gradients(self, name: str, direction: Callable[..., Any] | None) -> tuple[Array, Array]:
        """Shape-function slopes along and across `direction` at the quadrature points, (n_local, n_el, n_q)."""
        e = self.elements(name)
        grad = self._grad[:, :, e]
        if direction is None:
            return grad[0], grad[1]
        d, across = self.directions(name, direction)
        return d[0] * grad[0] + d[1] * grad[1], across[0] * grad[0] + across[1] * grad[1]

    def directions(self, name: str, direction: Callable[..., Any] | None) -> tuple[Array, Array]:
        """Unit vectors along and across `direction` at a subdomain's quadrature points: (2, n_el, n_q) or (2, 1, 1)."""
        if direction is None:
            return np.array([[[1.0]], [[0.0]]]), np.array([[[0.0]], [[1.0]]])
        e = self.elements(name)
        x = self.x[:, e]
        d = np.asarray(direction(x.reshape(2, -1)), dtype=float)
        if d.shape != (2, x[0].size) or not np.allclose(np.hypot(*d), 1.0, atol=1e-6):
            raise InputError("direction must return unit vectors of shape (2, n)", field=f"regions.{name}")
        d = d.reshape(x.shape)
        return d, np.stack([-d[1], d[0]])

    def _integrand(self, form: skfem.BilinearForm, e: Array, points: slice, data: dict[str, Array]) -> Array:
        # The shape functions are the same in every element, their slopes are not.
        return integrand(form, self.phi[:, :1, points], self._grad[:, :, e, points], **data)

    def integrands(self, form: skfem.BilinearForm, elements: Array, **data: Array) -> Array:
        """`integrand` of elements, times the volume weight of each quadrature point."""
        return np.asarray(self._integrand(form, elements, slice(None), data) * self.weight[elements])

    def integrals(self, form: skfem.BilinearForm, elements: Array, even: bool = False, **data: Array) -> Array:
        """The integral of a form over each element, (i, j, n_elements).

        ``even``: the integrand is constant within an element, so one point is enough.
        """
        weight = self.weight[elements]
        points = slice(0, 1) if even else slice(None)
        weight = weight.sum(axis=1, keepdims=True) if even else weight
        n = len(self.phi)
        local = np.empty((n, n, elements.size))
        size = max(1, _CHUNK // (n * n * weight.shape[1]))
        for first in range(0, elements.size, size):
            part = slice(first, first + size)
            here = {name: value if value.shape[1] == 1 else value[:, part] for name, value in data.items()}
            pairs = self._integrand(form, elements[part], points, here)
            if pairs.shape[2] == 1:
                local[:, :, part] = pairs[:, :, 0] @ weight[part].T
            else:
                np.einsum("ijeq,eq->ije", pairs, weight[part], out=local[:, :, part])
        return local
