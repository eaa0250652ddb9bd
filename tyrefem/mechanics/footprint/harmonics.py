"""Stiffness of every Fourier harmonic about a pre-stressed axisymmetric state, from three assemblies.

Load and stiffness of the follower pressure on the wall, by harmonic.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.conduction.linear_solver import Ordering
from tyrefem.errors import InputError, nearest
from tyrefem.mechanics.footprint.elements import COMPONENTS, NODES, SectionElements
from tyrefem.mechanics.solid.body import Prestressed

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


def along_wall(facets: Any) -> tuple[Indices, Array, Array, Array, Array, Array]:
    """Dofs (f, 27), values and tangential derivatives (f, q, 9), normals (2, f, q), radii and weights (f, q)."""
    nodes = np.asarray(facets.element_dofs, dtype=np.int64).T
    dofs = (COMPONENTS * nodes[:, :, None] + np.arange(COMPONENTS)).reshape(len(nodes), -1)
    radii, weights = np.asarray(facets.global_coordinates())[0], np.asarray(facets.dx)
    values = np.stack([np.broadcast_to(np.asarray(f[0]), radii.shape) for f in facets.basis], axis=-1)
    normals = np.asarray(facets.normals)
    by_r, by_z = np.stack([np.asarray(f[0].grad) for f in facets.basis], axis=-1)
    along = by_r * normals[1][..., None] - by_z * normals[0][..., None]
    return dofs, values, along, normals, radii, weights


def pressure_load(elements: SectionElements, boundary: str) -> Array:
    """(n_dofs,) load per radian of unit pressure on a boundary, n = 0: - int n . v r ds, m2."""
    dofs, values, _, normals, radii, weights = along_wall(elements.facet_basis(boundary))
    local = np.zeros((*values.shape[::2], COMPONENTS))
    for component in (0, 1):
        local[..., component] = -np.einsum("fqa,fq->fa", values, normals[component] * radii * weights)
    load = np.zeros(elements.n_dofs)
    np.add.at(load, dofs, local.reshape(dofs.shape))
    return load


def follower_stiffness(elements: SectionElements, boundary: str) -> tuple[Indices, Array, Array]:
    """Stiffness of unit pressure on a boundary: dofs (f, 27), P_0 and P_1 (f, 27, 27), m; P_n = P_0 + n P_1.

    With x(s, t) on the wall, the force p (x_s x x_t) changes by p (u_s x x_t + x_s x u_t):

    v P_n u = int v_r (n_r (n u_t + u_r) - r u_z') + v_z (n_z (n u_t + u_r) + r u_r')
              + v_t (n_r (n u_r + u_t) + n_z n u_z) ds,

    ' is the derivative along the wall, (n_r, n_z) the outward normal. The matrix is made symmetric. This changes
    nothing if the wall is closed, or ends on a fixed edge or on the mid plane.
    """
    dofs, values, along, (n_r, n_z), radii, weights = along_wall(elements.facet_basis(boundary))
    n_faces, nodes = values.shape[::2]
    constant, linear = np.zeros((2, n_faces, nodes, COMPONENTS, nodes, COMPONENTS))
    by_r = np.einsum("fqa,fqb,fq->fab", values, values, n_r * weights)
    by_z = np.einsum("fqa,fqb,fq->fab", values, values, n_z * weights)
    slope = np.einsum("fqa,fqb,fq->fab", values, along, radii * weights)
    constant[:, :, 0, :, 0] = by_r
    constant[:, :, 0, :, 1] = -slope
    constant[:, :, 1, :, 0] = by_z + slope
    constant[:, :, 2, :, 2] = by_r
    linear[:, :, 0, :, 2] = by_r
    linear[:, :, 1, :, 2] = by_z
    linear[:, :, 2, :, 0] = by_r
    linear[:, :, 2, :, 1] = by_z

    def symmetric(matrix: Array) -> Array:
        square = matrix.reshape(n_faces, nodes * COMPONENTS, nodes * COMPONENTS)
        return np.asarray((square + square.transpose(0, 2, 1)) / 2)

    return dofs, symmetric(constant), symmetric(linear)


#: A motion counts as free if its energy over the sum of its parts' sizes is smaller.
ROUND_OFF = 1e-12


#: Pivots on the diagonal: the matrices are symmetric, and positive definite if the state is stable.
SYMMETRIC: dict[str, Any] = {"diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}


@dataclass(frozen=True, eq=False)
class Harmonics(Brief):
    """K_n = A + n B + n^2 C of small motions (u_r cos n t, u_z cos n t, u_t sin n t) about a state.

    v K_n u = int [e_n(v) : c : e_n(u) + kappa d_n(v) d_n(u) + s_ij H_ki(v) H_kj(u)] r dA + p v P_n u

    d_n : dilatation projected on the linear polynomials of each element (Q2/P1-discontinuous: no locking);
    H : gradient, rows (u_r,r, u_r,z, -(n u_r + u_t)/r), (u_z,r, u_z,z, -n u_z/r), (u_t,r, u_t,z, (n u_t + u_r)/r);
    P_n : stiffness of the follower pressure (`follower`). The state's ``support`` is added to A. All values are per
    radian: the energy of an amplitude u round the wheel is pi/2 u K_n u, and pi u K_0 u for n = 0.

    Raises
    ------
    InputError : a boundary that the state names is not in the mesh; stresses or tangent that couple the symmetric with
        the antisymmetric motions (layers whose +angle and -angle do not balance).
    """

    state: Prestressed
    #: Harmonic -> number of motions with negative stiffness (buckling cords), written by `compliance`.
    negative_pivots: dict[int, int] = field(default_factory=dict, init=False, repr=False)
    #: Lowest such harmonic -> place (r, z), m, of the largest displacement of such a motion.
    buckling_place: dict[int, tuple[float, float]] = field(default_factory=dict, init=False, repr=False)
    _orders: dict[bytes, Indices] = field(default_factory=dict, init=False, repr=False)

    def __post_init__(self) -> None:
        state = self.state
        named = [*state.fixed, *([state.pressurised] if state.pressure else [])]
        for name in named:
            if name not in (state.mesh.boundaries or {}):
                raise InputError(f"the mesh has no boundary '{name}'{nearest(name, state.mesh.boundaries or {})}")
        coupled = max(np.abs(state.tangent[:4, 4:]).max(), np.abs(state.stress[4:]).max())
        if coupled > 1e-6 * np.abs(state.tangent).max():
            raise InputError("layers whose + and - angles do not balance couple bending with twist: average them")

    @functools.cached_property
    def elements(self) -> SectionElements:
        """Shape functions and strains."""
        return SectionElements(self.state.mesh)

    @functools.cached_property
    def matrices(self) -> tuple[Any, Any, Any]:
        """A, B and C as sparse matrices of one pattern (n_dofs, n_dofs), N/m per radian."""
        elements, state = self.elements, self.state
        weights = elements.weights
        e0, e1 = elements.strains
        d0, d1 = elements.dilatations
        n_elements, size = elements.dofs.shape
        c = np.moveaxis(state.tangent, (0, 1), (-2, -1)) * weights[..., None, None]
        rows = (n_elements, -1, size)
        s0, s1 = (c @ e0).reshape(rows), (c @ e1).reshape(rows)
        e0t, e1t = (e.reshape(rows).transpose(0, 2, 1) for e in (e0, e1))
        k = state.bulk * weights
        v0, v1 = k[..., None] * d0, k[..., None] * d1
        d0t, d1t = d0.transpose(0, 2, 1), d1.transpose(0, 2, 1)
        a = e0t @ s0 + d0t @ v0
        b = e0t @ s1 + e1t @ s0 + d0t @ v1 + d1t @ v0
        cc = e1t @ s1 + d1t @ v1
        for matrix, stress in zip((a, b, cc), self._initial_stress(), strict=True):
            matrix += stress
        return self._assembled(a, b, cc)

    def _initial_stress(self) -> tuple[Array, Array, Array]:
        """int s_ij H_ki H_kj r dA of each element as powers of n, (n_elements, 27, 27)."""
        elements, s = self.elements, self.state.stress * self.elements.weights
        (by_r, by_z), values = elements.gradients, elements.values / elements.radii[..., None]
        plane = np.einsum("eqa,eqb->eab", by_r, s[0][..., None] * by_r + s[3][..., None] * by_z)
        plane += np.einsum("eqa,eqb->eab", by_z, s[1][..., None] * by_z + s[3][..., None] * by_r)
        hoop = np.einsum("eqa,eqb->eab", values, s[2][..., None] * values)
        shape = (len(plane), NODES, COMPONENTS, NODES, COMPONENTS)
        a, b, c = np.zeros(shape), np.zeros(shape), np.zeros(shape)
        for component in range(COMPONENTS):
            a[:, :, component, :, component] = plane + (hoop if component != 1 else 0.0)
            c[:, :, component, :, component] = hoop
        b[:, :, 0, :, 2] = b[:, :, 2, :, 0] = 2 * hoop
        size = NODES * COMPONENTS
        return a.reshape(-1, size, size), b.reshape(-1, size, size), c.reshape(-1, size, size)

    def _assembled(self, a: Array, b: Array, c: Array) -> tuple[Any, Any, Any]:
        dofs, n = self.elements.dofs, self.elements.n_dofs
        rows = [np.repeat(dofs, dofs.shape[1], axis=1).ravel()]
        columns = [np.tile(dofs, (1, dofs.shape[1])).ravel()]
        data = [[matrix.ravel()] for matrix in (a, b, c)]
        if self.state.pressure:
            wall, constant, linear = follower_stiffness(self.elements, self.state.pressurised)
            rows.append(np.repeat(wall, wall.shape[1], axis=1).ravel())
            columns.append(np.tile(wall, (1, wall.shape[1])).ravel())
            for parts, matrix in zip(data, (constant, linear, np.zeros_like(constant)), strict=True):
                parts.append(self.state.pressure * matrix.ravel())
        if self.state.support is not None:
            support = self.state.support.tocoo()
            rows.append(support.row)
            columns.append(support.col)
            for parts, values in zip(data, (support.data, *2 * [np.zeros(support.nnz)]), strict=True):
                parts.append(values)
        place = (np.concatenate(rows), np.concatenate(columns))
        matrices = [sp.coo_matrix((np.concatenate(parts), place), shape=(n, n)).tocsc() for parts in data]
        return matrices[0], matrices[1], matrices[2]

    def stiffness(self, n: float) -> Any:
        """K_n as a sparse matrix, N/m per radian."""
        a, b, c = self.matrices
        return sp.csc_matrix((a.data + n * b.data + n * n * c.data, a.indices, a.indptr), shape=a.shape)

    @functools.cached_property
    def held(self) -> Indices:
        """Fixed degrees of freedom: all at fixed boundaries, u_z on the mid plane."""
        boundaries, elements = self.state.mesh.boundaries or {}, self.elements
        dofs = [np.zeros(0, dtype=np.int64)]
        for name in self.state.fixed:
            nodes = elements.boundary_nodes(name)
            dofs.append((COMPONENTS * nodes[:, None] + np.arange(COMPONENTS)).ravel())
        if self.state.symmetric in boundaries:
            dofs.append(COMPONENTS * elements.boundary_nodes(self.state.symmetric) + 1)
        return np.unique(np.concatenate(dofs))

    @functools.cached_property
    def free(self) -> Indices:
        """Degrees of freedom that are not fixed."""
        return np.setdiff1d(np.arange(self.elements.n_dofs), self.held)

    @functools.cached_property
    def _ordering(self) -> Ordering:
        """Elimination order of the free degrees of freedom: banded for the thin section of most tyres."""
        pattern = self.matrices[0]
        return Ordering(pattern.indptr, pattern.indices, self.free)

    def solve(self, n: float, loads: Array) -> Array:
        """Amplitudes (n_dofs, k), m, under loads (n_dofs, k) in N per radian: one factorisation.

        Raises
        ------
        InputError : the state is not stable in harmonic n, or a rigid motion is free.
        """
        free, stiffness, loads = self.free, self.stiffness(n), np.asarray(loads)
        displacements = np.zeros_like(loads)
        displacements[free] = self._factor(n, stiffness).solve(np.ascontiguousarray(loads[free]))
        work = np.einsum("i...,i...->...", displacements, loads)
        size = np.abs(displacements)
        parts = np.einsum("i...,i...->...", size, abs(stiffness) @ size)
        # A free rigid motion has a stiffness of rounding errors, of either sign.
        if not (np.abs(work) >= ROUND_OFF * parts).all():
            raise InputError(f"harmonic {n:g} has no stiffness: nothing holds the body")
        if (work < 0).any():
            raise InputError(f"the state is not stable: harmonic {n:g} has negative stiffness")
        return displacements

    def _factor(self, n: float, stiffness: Any) -> Any:
        """K_n of the free degrees of freedom, factored: by Cholesky, or by SuperLU where it is not positive."""
        from scipy.sparse.linalg import splu

        try:
            return self._ordering.factor(stiffness.data)
        except RuntimeError:
            reduced = stiffness[self.free][:, self.free].tocsc()
        try:
            return splu(reduced, permc_spec="MMD_AT_PLUS_A", **SYMMETRIC)
        except RuntimeError:
            raise InputError(f"harmonic {n:g} has no stiffness: nothing holds the body") from None

    def _last(self, dofs: Indices) -> Indices:
        """Order of the free degrees of freedom that keeps the factor sparse, with ``dofs`` last; with a cache."""
        key = dofs.tobytes()
        if key not in self._orders:
            from scipy.sparse.linalg import splu

            among = np.setdiff1d(self.free, dofs)
            factor = splu(self.stiffness(1)[among][:, among].tocsc(), permc_spec="MMD_AT_PLUS_A", **SYMMETRIC)
            self._orders[key] = np.concatenate([among[np.argsort(factor.perm_c)], dofs])
        return self._orders[key]

    def condensed(self, n: int, dofs: Indices) -> Any:
        """(k, k) stiffness of some degrees of freedom, held or not, while no force acts on the others that are free,
        N/m per radian.

        Raises
        ------
        InputError : harmonic n has no stiffness at the others.
        """
        factor, k = self.factor_with_last(n, dofs)[1], len(dofs)
        condensed = (factor.L[-k:, -k:] @ factor.U[-k:, -k:]).toarray()
        return (condensed + condensed.T) / 2

    def factor_with_last(self, n: int, dofs: Indices, like: Harmonics | None = None) -> tuple[Indices, Any]:
        """Order of the free degrees of freedom with ``dofs`` last, and the SuperLU factors of K_n in it; ``like``: a
        tyre with the same mesh, whose order serves.

        Raises
        ------
        InputError : harmonic n has no stiffness.
        """
        from scipy.sparse.linalg import splu

        order = (like or self)._last(dofs)
        try:
            return order, splu(self.stiffness(n)[order][:, order].tocsc(), permc_spec="NATURAL", **SYMMETRIC)
        except RuntimeError:
            raise InputError(f"harmonic {n:g} has no stiffness: nothing holds the body") from None

    def compliance(self, n: int, dofs: Indices) -> Array:
        """(k, k) displacements of some free degrees of freedom under unit loads on them, m per N per radian.

        Raises
        ------
        InputError : harmonic n has no positive stiffness at these degrees of freedom.
        """
        return self.compliance_of(n, self.factor_with_last(n, dofs), len(dofs))

    def compliance_of(self, n: int, factor: tuple[Indices, Any], k: int) -> Array:
        """`compliance` from `factor_with_last` of k degrees of freedom.

        With these last, the last blocks of the factors are those of the Schur complement: no right-hand side is solved.

        Raises
        ------
        InputError : harmonic n has no positive stiffness at these degrees of freedom.
        """
        from scipy.linalg import LinAlgError, cho_factor, cho_solve

        order, lu = factor
        upper = lu.U
        self.negative_pivots[n] = int((upper.diagonal() < 0).sum())
        if self.negative_pivots[n] and n < min(self.buckling_place, default=n + 1):
            self.buckling_place.clear()
            self.buckling_place[n] = self._largest(order, upper)
        condensed = (lu.L[-k:, -k:] @ upper[-k:, -k:]).toarray()
        try:
            return np.asarray(cho_solve(cho_factor((condensed + condensed.T) / 2), np.eye(k)))
        except LinAlgError:
            raise InputError(f"the state is not stable: harmonic {n:g} has negative stiffness") from None

    def _largest(self, order: Indices, upper: Any) -> tuple[float, float]:
        """Place of the largest motion of the most negative pivot: U x = e_i; x K x has the pivot's sign."""
        from scipy.sparse.linalg import spsolve_triangular

        pivot = int(upper.diagonal().argmin())
        unit = np.zeros(pivot + 1)
        unit[pivot] = 1.0
        motion = spsolve_triangular(upper[: pivot + 1, : pivot + 1].tocsr(), unit, lower=False)
        node = int(order[int(np.abs(motion).argmax())]) // COMPONENTS
        r, z = self.elements.nodes[:, node]
        return float(r), float(z)

    def inflated_by(self, pressure: float) -> Array:
        """(n_dofs,) small axisymmetric displacement, m, under additional ``pressure`` (Pa) on the wall: K_0 u = p F."""
        return self.solve(0, pressure * pressure_load(self.elements, self.state.pressurised))
