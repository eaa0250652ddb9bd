"""Quadrature of regions and surfaces for data that vary with place or temperature."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import numpy as np
import skfem
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from tyrefem.cache import read_only
from tyrefem.conduction.equation import conduction, exchange, storage
from tyrefem.conduction.function_space import FunctionSpace, integrand
from tyrefem.errors import InputError, nearest

Array = NDArray[Any]

#: Largest number of unknowns of a surface for which a full matrix is faster than a sparse one.
_FEW = 128


class Quadrature:
    """Values and slopes of a field at a region's quadrature points, and operator values from coefficients there."""

    def __init__(self, space: FunctionSpace, name: str, direction: Callable[..., Any] | None) -> None:
        e = space.elements(name)
        self.weight = space.weight[e].reshape(-1)
        dofs = space.element_dofs[:, e]
        n_local, n_q = dofs.shape[0], space.weight.shape[1]
        columns = np.repeat(dofs.T[:, None, :], n_q, axis=1).reshape(-1)
        rows = np.arange(0, columns.size + 1, n_local)

        def at_points(local: Array) -> csr_matrix:
            return csr_matrix((np.moveaxis(local, 0, -1).reshape(-1), columns, rows), (rows.size - 1, space.size))

        phi = space.phi[:, e]
        slopes = space.directed_gradients(name, direction)
        self.value = at_points(phi)
        self.slopes = tuple(at_points(g) for g in slopes)
        self.slopes_t = tuple(g.T.tocsr() for g in self.slopes)
        place = space.place[:, :, e]
        q = np.broadcast_to(np.arange(self.weight.size).reshape(e.size, n_q), (n_local, n_local, e.size, n_q))
        where = np.broadcast_to(place[..., None], q.shape).reshape(-1)

        def scatter(form: skfem.BilinearForm, **data: Array) -> csr_matrix:
            """Matrix from a coefficient at the points to the operator values of the form."""
            values = space.integrands(form, e, **data)
            return csr_matrix((values.reshape(-1), (where, q.reshape(-1))), (space.nnz, self.weight.size))

        self.mass = scatter(storage)
        self.conduction = tuple(scatter(conduction, d=d) for d in space.directions(name, direction))


class Surface:
    """Quadrature of a named boundary: points x (2, n_q), weights, and the trace of the unknowns."""

    def __init__(self, space: FunctionSpace, name: str) -> None:
        boundaries = space.mesh.boundaries or {}
        if name not in boundaries:
            raise InputError(f"unknown boundary {name!r}{nearest(name, boundaries)}", field="boundaries")
        facets = np.asarray(boundaries[name], dtype=np.int64)
        if facets.size == 0:
            raise InputError(f"boundary {name!r} has no facets", field="boundaries")
        try:
            basis = skfem.FacetBasis(space.mesh, space.skfem_element, facets=facets, intorder=space.intorder)
        except Exception as error:  # scikit-fem raises a bare Exception where its inverse mapping does not converge
            message = f"elements at boundary {name!r} are too thin or distorted: {error}"
            raise InputError(message, field="boundaries") from error
        x = np.asarray(basis.global_coordinates())
        self.name, self.x = name, read_only(np.ascontiguousarray(x.reshape(2, -1)))
        self.weight = (basis.dx * (2 * np.pi * x[0] if space.axisymmetric else 1.0)).reshape(-1)
        self.area = float(self.weight.sum())
        phi = np.stack([np.broadcast_to(np.asarray(b[0]), basis.dx.shape) for b in basis.basis])
        dofs = np.broadcast_to(basis.element_dofs[:, :, None], phi.shape)
        q = np.broadcast_to(np.arange(self.weight.size).reshape(basis.dx.shape), phi.shape)
        used = np.abs(phi) > 1e-12
        self.dofs, column = np.unique(dofs[used], return_inverse=True)
        shape = (self.weight.size, self.dofs.size)
        self.trace = csr_matrix((phi[used], (q[used], column)), shape)
        self.trace_t = self.trace.T.tocsr()
        self.row = self.trace_t @ self.weight
        self.points = read_only(np.ascontiguousarray(space.points[:, self.dofs]))
        # From h times the weights at the points to the operator values of the film on the common pattern.
        shape = (len(phi), *phi.shape)
        i, j = np.broadcast_to(dofs[:, None], shape), np.broadcast_to(dofs[None], shape)
        both = used[:, None] & used[None]
        pairs, place = np.unique(i[both].astype(np.int64) * space.size + j[both], return_inverse=True)
        self._places = np.searchsorted(space.keys, pairs)
        points = np.broadcast_to(q, shape)[both]
        self._films = csr_matrix((integrand(exchange, phi)[both], (place, points)), (pairs.size, self.weight.size))

    def load(self, q: Any) -> Array:
        """Load (n_dofs,) W of a flux: a number or its values at the points, W/m2."""
        return self.row * q if isinstance(q, float) else np.asarray(self.trace_t @ (self.weight * q))

    def loss(self, h: Any, T: Array) -> Array:
        """Load (n_dofs,) W of the flux h T, with h a number or values at the points, T of the surface's unknowns."""
        if isinstance(h, float):
            return np.asarray(h * (self.unit_film @ T))
        return np.asarray(self.trace_t @ (self.weight * h * (self.trace @ T)))

    @functools.cached_property
    def unit_film(self) -> Any:
        """Matrix from T of the surface's unknowns to the load, W, of the flux h T with h = 1: (n_dofs, n_dofs)."""
        matrix = (self.trace_t.multiply(self.weight) @ self.trace).tocsr()
        return matrix.toarray() if self.dofs.size <= _FEW else matrix

    @functools.cached_property
    def unit_exchange(self) -> tuple[Array, Array]:
        """`exchange` for h = 1 everywhere."""
        return self._places, self._films @ self.weight

    def film_matrix(self, h: Any, n: int) -> csr_matrix:
        """int h v T dA (n, n)."""
        product = (self.trace_t.multiply(self.weight * h) @ self.trace).tocoo()
        return csr_matrix((product.data, (self.dofs[product.row], self.dofs[product.col])), (n, n))

    def exchange(self, h: Any) -> tuple[Array, Array]:
        """Positions and values on the common pattern of int h v T dA; h: a number or values at the points, W/m2/K."""
        if isinstance(h, float):
            where, value = self.unit_exchange
            return where, h * value
        return self._places, self._films @ (self.weight * h)
