"""Stiffness of every harmonic with loss: complex, each harmonic at its own frequency."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.harmonics import SYMMETRIC, Harmonics

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class LossyHarmonics(Harmonics):
    """K_n - i K''_n of u = Re((U_r, U_z, -i U_t) e^(i n t)), where material runs towards smaller angles t.

    K''_n = int tan d(n W/2 pi) e_n(v) : C' : e_n(u) r dA, C' the part of the tangent that dissipates. The angle t of
    rubber falls by W per second: it sees the wave as e^(-i n W time), so its stress is C' (1 - i tan d). K'' is
    symmetric, the matrices have the sparsity of K_n. A steady motion U loses 2 pi^2 n U* K''_n U, J, in a revolution of
    the body.

    Parameters
    ----------
    state : with the inertia of the steady motion (`Inflation.rolling_state`) where it counts.
    angular_speed : W, rad/s.
    tangents : frequency, Hz -> (n_elements,) tan d.
    dissipating : (6, 6, n_elements, n_points) C', Pa; by default the state's ``storage``.
    """

    angular_speed: float = 0.0
    tangents: Callable[[float], Array] | None = None
    dissipating: Array | None = None

    @functools.cached_property
    def _loss_parts(self) -> tuple[Array, Array, Array]:
        """e_0 : C' : e_0, the mixed and e_1 : C' : e_1 of every element, (n_elements, 27, 27)."""
        elements = self.elements
        moduli = self.state.storage if self.dissipating is None else self.dissipating
        c = np.moveaxis(moduli, (0, 1), (-2, -1)) * elements.weights[..., None, None]
        e0, e1 = elements.strains
        rows = (len(elements.dofs), -1, elements.dofs.shape[1])
        s0, s1 = (c @ e0).reshape(rows), (c @ e1).reshape(rows)
        e0t, e1t = (e.reshape(rows).transpose(0, 2, 1) for e in (e0, e1))
        return e0t @ s0, e0t @ s1 + e1t @ s0, e1t @ s1

    def loss(self, n: float) -> Any:
        """K''_n, sparse (n_dofs, n_dofs), N/m per radian; zero for n = 0."""
        dofs, size = self.elements.dofs, self.elements.n_dofs
        place = (np.repeat(dofs, dofs.shape[1], axis=1).ravel(), np.tile(dofs, (1, dofs.shape[1])).ravel())
        if self.tangents is None or not n:
            return sp.csc_matrix((size, size))
        a, b, c = self._loss_parts
        tangent = self.tangents(n * self.angular_speed / (2 * np.pi))
        values = tangent[:, None, None] * (a + n * b + n * n * c)
        return sp.coo_matrix((values.ravel(), place), shape=(size, size)).tocsc()

    def stiffness(self, n: float) -> Any:
        """K_n - i K''_n, sparse, N/m per radian."""
        return (super().stiffness(n) - 1j * self.loss(n)).tocsc()

    def solve(self, n: float, loads: Any) -> Any:
        """Complex amplitudes (n_dofs, k), m, under loads (n_dofs, k), N per radian.

        Raises
        ------
        InputError : nothing holds the body in harmonic n.
        """
        from scipy.sparse.linalg import splu

        free = self.free
        matrix = self.stiffness(n)[free][:, free].tocsc()
        try:
            factor = splu(matrix, permc_spec="MMD_AT_PLUS_A", **SYMMETRIC)
        except RuntimeError:
            raise InputError(f"harmonic {n:g} has no stiffness: nothing holds the body") from None
        loads = np.asarray(loads, dtype=complex)
        displacements = np.zeros_like(loads)
        displacements[free] = factor.solve(np.ascontiguousarray(loads[free]))
        return displacements

    def compliance(self, n: int, dofs: Indices) -> Any:
        """(k, k) complex displacements of some free degrees of freedom under unit loads on them, m per N per radian.

        Raises
        ------
        InputError : harmonic n is beyond its critical speed: the tread's stiffness is not positive.
        """
        from scipy.sparse.linalg import splu

        order = self._last(dofs)
        try:
            factor = splu(self.stiffness(n)[order][:, order].tocsc(), permc_spec="NATURAL", **SYMMETRIC)
        except RuntimeError:
            raise InputError(f"harmonic {n:g} has no stiffness: nothing holds the body") from None
        k, upper = len(dofs), factor.U
        self.negative_pivots[n] = int((upper.diagonal().real < 0).sum())
        condensed = (factor.L[-k:, -k:] @ upper[-k:, -k:]).toarray()
        return np.linalg.inv((condensed + condensed.T) / 2)
