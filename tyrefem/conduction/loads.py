"""How sources and variable conduction act on the unknowns: a frozen linear part plus a remainder.

How a film that follows the surface temperature acts on the unknowns.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from tyrefem.conduction.conditions import Convection, Material, checked, is_number
from tyrefem.conduction.operators import Operators, Surface
from tyrefem.errors import InputError

Array = NDArray[Any]


STALE = 0.2


class State:
    """Unknown temperatures: u (n,) of the body and g (m,) of the reservoirs."""

    __slots__ = ("g", "u")

    def __init__(self, u: Array, g: Array) -> None:
        self.u, self.g = u, g


class Linear:
    """The frozen linear part under construction: S u - B g for the body, D g - B^T u for the reservoirs."""

    def __init__(self, ops: Operators, n_reservoirs: int) -> None:
        self.S = np.zeros(ops.nnz)
        self.B = np.zeros((ops.size, n_reservoirs))
        self.D = np.zeros((n_reservoirs, n_reservoirs))


class Load(ABC):
    """One heat input. `slot` is its line in the ledger of powers into the body (W)."""

    slot = -1
    #: The condition or source that a user stated; loads of one cause act alike.
    cause: Any = None
    timed = False
    static = False

    def freeze(self, t: float, y: State, linear: Linear) -> None:  # noqa: B027 - most have no linear part
        """Put the frozen linear part into `linear`."""

    def stale(self, t: float, y: State) -> bool:
        """Whether the frozen part differs by more than a fifth from what it should be now."""
        return False

    @abstractmethod
    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        """Add what the linear part leaves out to G (body) and Gg (reservoirs); return the power, W."""

    def linear_power(self, y: State) -> float:
        """Power of the frozen linear part, W into the body."""
        return 0.0


class SourceLoad(Load):
    """Volumetric source, W/m3 at the nodes of a subdomain."""

    def __init__(self, ops: Operators, name: str, q: Any) -> None:
        self.name, self._field, self._ops = name, f"sources.{name}", ops
        self.static = is_number(q)
        if not self.static and not callable(q):
            raise InputError(f"must be a number or f(x, t, T), not {q!r}", field=self._field)
        self.q: Any = float(q) if self.static else q
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
        value = self.q if self.static else checked(self.q(self.x, t, T), self.dofs.size, self._field, t)
        return np.full(self.dofs.shape, value) if isinstance(value, float) else value

    def slope(self, t: float, u: Array, bump: float) -> Array:
        """Operator values of d(load)/d(temperature), by differences of so many K either way."""
        rise = np.zeros(u.size)
        rise[self.dofs] = (self.at_nodes(t, u + bump) - self.at_nodes(t, u - bump)) / (2 * bump)
        return np.asarray(self._ops.mass(self.name) * rise[self._ops.indices])

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        q = self.at_nodes(t, y.u)
        G += self.matrix @ q
        return float(self.row @ q)


class Sources:
    """Volumetric sources of several subdomains in one product: most of the time of a small product is the call."""

    def __init__(self, ops: Operators, loads: Sequence[SourceLoad]) -> None:
        self.loads, self.slots = loads, [load.slot for load in loads]
        self.matrix = ops.source(*(load.name for load in loads))
        self.row = np.concatenate([load.row for load in loads])
        self._first = np.cumsum([0, *(load.row.size for load in loads[:-1])])

    def remainder(self, t: float, y: State, G: Array) -> Array:
        """Add the load to G (n,); return the power of every source, W."""
        q = np.concatenate([load.at_nodes(t, y.u) for load in self.loads])
        G += self.matrix @ q
        return np.add.reduceat(self.row * q, self._first)


class VariableConduction(Load):
    """Conduction whose k depends on temperature: K(T) u = K0 u + the remainder kept here."""

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

    def freeze(self, t: float, y: State, linear: Linear) -> None:
        self.k0 = self.values(y.u)
        for scatter, k in zip(self.q.conduction, self.k0, strict=True):
            linear.S += scatter @ k

    def stale(self, t: float, y: State) -> bool:
        return any(bool(np.any(np.abs(k - k0) > STALE * k0)) for k, k0 in zip(self.values(y.u), self.k0, strict=True))

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        for slope, back, k, k0 in zip(self.q.slopes, self.q.slopes_t, self.values(y.u), self.k0, strict=True):
            G -= back @ (self.q.weight * (k - k0) * (slope @ y.u))
        return 0.0


#: Half the difference of temperature over which the slope of the heat flux is taken, K.
_BUMP = 0.05


class ConvectionLoad(Load):
    """h(T) (sink - T); its frozen part is the slope of h (T - sink) at the temperature of the last freeze."""

    def __init__(self, surface: Surface, convection: Convection, field: str) -> None:
        self.s, self.h, self.sink, self._field = surface, convection.h, float(convection.sink), f"{field}.h"

    def _loss(self, T: Array, t: float) -> Array:
        h = checked(self.h(T), T.size, self._field, t)
        if np.min(h) < 0:
            raise InputError(f"is negative between {T.min():.6g} and {T.max():.6g} degC", field=self._field)
        return np.asarray(h * (T - self.sink))

    def _slopes(self, t: float, y: State) -> Array:
        """Quadrature values of -dq/dT; never negative, which would feed the body."""
        T = self.s.trace @ y.u[self.s.dofs]
        slopes = (self._loss(T + _BUMP, t) - self._loss(T - _BUMP, t)) / (2 * _BUMP)
        return np.asarray(np.maximum(slopes, 0.0))

    def freeze(self, t: float, y: State, linear: Linear) -> None:
        self.h0 = self._slopes(t, y)
        weighted = self.s.weight * self.h0
        where, value = self.s.exchange(weighted)
        np.add.at(linear.S, where, value)
        self.row = self.s.trace_t @ weighted

    def stale(self, t: float, y: State) -> bool:
        # The largest film decides: near the sink's temperature the slope of natural convection is steep but small.
        now = self._slopes(t, y)
        return bool(np.max(np.abs(now - self.h0)) > STALE * max(np.max(now), np.max(self.h0)))

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        T = self.s.trace @ y.u[self.s.dofs]
        load = self.s.trace_t @ (self.s.weight * (self.h0 * T - self._loss(T, t)))
        G[self.s.dofs] += load
        return float(load.sum())

    def linear_power(self, y: State) -> float:
        return float(-self.row @ y.u[self.s.dofs])
