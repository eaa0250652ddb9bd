"""What the shape of a section changes in the operators: volumes and metric tensors at the quadrature points.

With the places x of the corners and the Jacobian J of an element, the weights and tensors at a quadrature point are

    w = 2 pi r |J| W,      G = w (J^-1 d)(J^-1 d)^T,

so that a mass is sum w phi phi^T and a conduction along d is sum grad phi^T G grad phi, with the shape functions and
slopes of the reference element, which no shape changes.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
import skfem
from numpy.typing import NDArray

from tyrefem.conduction.operators import Operators
from tyrefem.geometry.meshing.mesh import TyreMesh

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class ReferenceElement:
    """Shape functions of a quadrilateral mesh's elements and corners at the quadrature points.

    Parameters
    ----------
    operators : of the reference shape.
    """

    operators: Operators

    @functools.cached_property
    def quadrature(self) -> tuple[Array, Array]:
        """Points (2, n_q) and weights (n_q,) in the reference element."""
        X, W = self.operators.basis.quadrature
        return np.asarray(X), np.asarray(W)

    @functools.cached_property
    def corners(self) -> tuple[Array, Array]:
        """Bilinear functions of the corners (4, n_q) and their slopes (2, 4, n_q)."""
        return shape_functions(skfem.ElementQuad1(), self.quadrature[0])

    @functools.cached_property
    def functions(self) -> tuple[Array, Array]:
        """Shape functions (n_local, n_q) and their slopes (2, n_local, n_q)."""
        return shape_functions(self.operators.skfem_element, self.quadrature[0])

    @functools.cached_property
    def _monomials(self) -> tuple[Array, Array, Array]:
        """Powers of X and of Y, (n_local,) each, and the shape functions' coefficients (n_local, n_local)."""
        at = np.asarray(self.operators.skfem_element.doflocs)
        degree = round(np.sqrt(len(at)))
        x, y = (each.reshape(-1) for each in np.meshgrid(np.arange(degree), np.arange(degree)))
        return x, y, np.linalg.inv(at[:, :1] ** x * at[:, 1:] ** y)

    def values(self, X: Array) -> Array:
        """Shape functions (n_local, k) at points (2, k) of the reference element."""
        x, y, coefficients = self._monomials
        return np.asarray(coefficients.T @ (X[0] ** x[:, None] * X[1] ** y[:, None]))

    @functools.cached_property
    def mass_pairs(self) -> Array:
        """(n_q, n_local^2): products of shape functions."""
        phi, _ = self.functions
        return np.asarray(np.einsum("iq,jq->qij", phi, phi).reshape(phi.shape[1], -1))

    @functools.cached_property
    def slope_pairs(self) -> Array:
        """(n_q, 3, n_local^2): products of slopes that belong to the tensor's entries 11, 12 and 22."""
        _, slopes = self.functions
        pair = np.einsum("aiq,bjq->abqij", slopes, slopes)
        entries = np.stack([pair[0, 0], pair[0, 1] + pair[1, 0], pair[1, 1]], axis=1)
        return np.asarray(entries.reshape(*entries.shape[:2], -1))


def shape_functions(element: skfem.Element, X: Array) -> tuple[Array, Array]:
    """Functions (n_local, k) and slopes (2, n_local, k) at points (2, k) of the reference element."""
    pairs = [element.lbasis(X, i) for i in range(len(element.doflocs))]
    k = X.shape[1]
    values = np.stack([np.broadcast_to(value, k) for value, _ in pairs])
    return values, np.stack([np.broadcast_to(slope, (2, k)) for _, slope in pairs], axis=1)


@dataclass(frozen=True, eq=False)
class QuadraturePlaces:
    """Quadrature points: places x (2, k) m, Jacobians J (2, 2, k), weights w (k,) m3."""

    x: Array
    J: Array
    w: Array

    @functools.cached_property
    def inverse(self) -> Array:
        """J^-1, (2, 2, k)."""
        a, b, c, d = self.J[0, 0], self.J[0, 1], self.J[1, 0], self.J[1, 1]
        return np.asarray(np.stack([np.stack([d, -b]), np.stack([-c, a])]) / (a * d - b * c))

    def even(self) -> Array:
        """(k, 3) entries 11, 12 and 22 of w J^-1 J^-T, for conduction that is the same in all directions."""
        first, second = self.inverse[:, 0], self.inverse[:, 1]
        return _entries(self.w, first) + _entries(self.w, second)

    def directed(self, d: Array) -> tuple[Array, Array]:
        """`even`'s entries along unit vectors d (2, k), and across them."""
        along = np.einsum("abk,bk->ak", self.inverse, d)
        across = np.einsum("abk,bk->ak", self.inverse, np.stack([-d[1], d[0]]))
        return _entries(self.w, along), _entries(self.w, across)


def _entries(w: Array, v: Array) -> Array:
    return np.asarray(np.stack([w * v[0] * v[0], w * v[0] * v[1], w * v[1] * v[1]], axis=1))


def places(reference: ReferenceElement, p: Array, t: Array, elements: Numbers, points: Numbers) -> QuadraturePlaces:
    """Quadrature points, by element and number, of a mesh with nodes p (2, n) and elements t (4, n_elements)."""
    functions, slopes = reference.corners
    corners = p[:, t[:, elements]]
    x = np.einsum("cik,ik->ck", corners, functions[:, points])
    J = np.einsum("cik,dik->cdk", corners, slopes[:, :, points])
    determinant = J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]
    return QuadraturePlaces(x, J, 2 * np.pi * x[0] * np.abs(determinant) * reference.quadrature[1][points])


@dataclass(frozen=True, eq=False)
class Edges:
    """The sides of elements on a boundary: nodes ends (2, k), and at their quadrature points shares (k, n_q) of the way
    from the first to the second, and weights over the length (k, n_q)."""

    ends: Numbers
    share: Array
    weight: Array

    @classmethod
    def of(cls, operators: Operators, mesh: TyreMesh, side: str) -> Edges:
        """The edges of a boundary of the reference mesh, with the quadrature of its `Surface`."""
        surface, p = operators.surface(side), mesh.mesh.p
        ends = np.asarray(mesh.mesh.facets[:, np.asarray(mesh.mesh.boundaries[side], dtype=np.int64)])
        x = surface.x.reshape(2, ends.shape[1], -1)
        start, along = p[:, ends[0]], p[:, ends[1]] - p[:, ends[0]]
        length = np.hypot(*along)
        share = ((x - start[:, :, None]) * along[:, :, None]).sum(axis=0) / length[:, None] ** 2
        weight = surface.weight.reshape(share.shape) / (2 * np.pi * x[0] * length[:, None])
        return cls(ends, share, weight)

    def weights(self, p: Array) -> Array:
        """Weights (k n_q,) m2 of a mesh with nodes p (2, n): 2 pi r dl."""
        (ra, za), (rb, zb) = p[:, self.ends[0]], p[:, self.ends[1]]
        r = ra[:, None] + self.share * (rb - ra)[:, None]
        return np.asarray((2 * np.pi * r * np.hypot(rb - ra, zb - za)[:, None] * self.weight).reshape(-1))
