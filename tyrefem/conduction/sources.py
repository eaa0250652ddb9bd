"""Volumetric heat sources of subdomains."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from tyrefem.cache import read_only
from tyrefem.conduction.conditions import is_number
from tyrefem.conduction.datum import checked
from tyrefem.conduction.operators import Operators
from tyrefem.conduction.terms import SLOPE_STEP, Load, State
from tyrefem.errors import InputError

Array = NDArray[Any]


class SourceLoad(Load):
    """Volumetric source, W/m3 at the nodes of a subdomain."""

    def __init__(self, ops: Operators, name: str, q: Any) -> None:
        self.name, self._field, self._ops = name, f"sources.{name}", ops
        self.static = is_number(q)
        if not self.static and not callable(q):
            raise InputError(f"must be a number or f(x, t, T), not {q!r}", field=self._field)
        self.q: Any = float(q) if self.static else q
        if self.static and not math.isfinite(self.q):
            raise InputError(f"must be finite, not {self.q!r}", field=self._field)
        self.x, self.dofs = ops.nodes(name), ops.dofs(name)
        self.all_dofs = self.dofs.size == ops.size
        self.row = ops.mass_row(name)[self.dofs]

    @property
    def matrix(self) -> csr_matrix:
        """Values at the nodes to load, (n, n_nodes)."""
        return self._ops.source(self.name)

    def at_nodes(self, t: float, u: Array) -> Array:
        """Source at the nodes, (n_nodes,)."""
        T = u if self.all_dofs else u[self.dofs]
        value = self.q if self.static else checked(self.q(self.x, t, read_only(T)), self.dofs.size, self._field, t)
        return np.full(self.dofs.shape, value) if isinstance(value, float) else value

    def slope(self, t: float, u: Array, bump: float) -> Array:
        """Operator values of d(load)/d(temperature), by central differences over +-``bump`` K."""
        rise = np.zeros(u.size)
        rise[self.dofs] = (self.at_nodes(t, u + bump) - self.at_nodes(t, u - bump)) / (2 * bump)
        return np.asarray(self._ops.mass(self.name) * rise[self._ops.indices])

    def jacobian(self, t: float, y: State) -> csr_matrix | None:
        return None if self.static else self._ops.matrix(self.slope(t, y.u, SLOPE_STEP))

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        q = self.at_nodes(t, y.u)
        G += self.matrix @ q
        return float(self.row @ q)


class Sources(Load):
    """Volumetric sources of several subdomains in one product, as small products cost mostly their call."""

    def __init__(self, ops: Operators, loads: Sequence[SourceLoad]) -> None:
        self.loads, self.slot = loads, [load.slot for load in loads]
        self.matrix = ops.source(*(load.name for load in loads))
        self.row = np.concatenate([load.row for load in loads])
        self._first = np.cumsum([0, *(load.row.size for load in loads[:-1])])

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> Array:
        q = np.concatenate([load.at_nodes(t, y.u) for load in self.loads])
        G += self.matrix @ q
        return np.add.reduceat(self.row * q, self._first)
