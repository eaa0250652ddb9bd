"""Conduction with a temperature-dependent conductivity."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix, diags

from tyrefem.conduction.conditions import Material
from tyrefem.conduction.operators import Operators
from tyrefem.conduction.terms import SLOPE_STEP, STALE, LinearPart, Load, State
from tyrefem.errors import InputError

Array = NDArray[Any]


class VariableConduction(Load):
    """Conduction with k(T): K(T) u = K0 u + a remainder."""

    def __init__(self, ops: Operators, name: str, material: Material) -> None:
        self.name, self.k = name, material.conductivity
        self.q = ops.quadrature(name, material.direction)
        self.dofs = ops.dofs(name)

    def values(self, u: Array) -> tuple[Array, Array]:
        """(k_1, k_2) at the quadrature points."""
        T = self.q.value @ u
        k = self.k(T)
        pair = k if isinstance(k, (tuple, list)) else (k, k)
        first, second = (np.broadcast_to(np.asarray(value, float), T.shape) for value in pair)
        if not (np.min(first) > 0 and np.min(second) > 0):
            raise InputError(
                f"is not positive between {T.min():.6g} and {T.max():.6g} degC",
                field=f"regions.{self.name}.conductivity",
            )
        return first, second

    def freeze(self, t: float, y: State, linear: LinearPart) -> None:
        self.k0 = self.values(y.u)
        for scatter, k in zip(self.q.conduction, self.k0, strict=True):
            linear.add_conduction(scatter @ k)

    def stale(self, t: float, y: State) -> bool:
        return any(bool(np.any(np.abs(k - k0) > STALE * k0)) for k, k0 in zip(self.values(y.u), self.k0, strict=True))

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        for slope, transposed, k, k0 in zip(self.q.slopes, self.q.slopes_t, self.values(y.u), self.k0, strict=True):
            G -= transposed @ (self.q.weight * (k - k0) * (slope @ y.u))
        return 0.0

    def jacobian(self, t: float, y: State) -> csr_matrix | None:
        q, pairs = self.q, zip(self.values(y.u), self.values(y.u + SLOPE_STEP), strict=True)
        rises = [(bumped - k) / SLOPE_STEP for k, bumped in pairs]
        return -sum(
            transposed @ diags(q.weight * rise * (slope @ y.u)) @ q.value
            for slope, transposed, rise in zip(q.slopes, q.slopes_t, rises, strict=True)
        )

    def slope(self, t: float, y: State) -> csr_matrix:
        """d(remainder)/du (n, n) at any state: `jacobian`, and what k has changed since the freeze."""
        jacobian, q = self.jacobian(t, y), self.q
        assert jacobian is not None
        return jacobian - sum(
            transposed @ diags(q.weight * (k - k0)) @ slope
            for slope, transposed, k, k0 in zip(q.slopes, q.slopes_t, self.values(y.u), self.k0, strict=True)
        )
