"""How each condition, source and reservoir acts on the unknowns: a frozen linear part plus a remainder."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.conditions import Film, Flux, Material, Radiation, Reservoir, is_number
from tyrefem.conduction.operators import Operators, Surface
from tyrefem.errors import InputError

Array = NDArray[Any]

STEFAN_BOLTZMANN = 5.67e-8
_STALE = 0.2


class Datum:
    """A number or a function of (x, t), checked and remembered for the latest time."""

    def __init__(self, value: Any, x: Array, field: str, low: float = -np.inf) -> None:
        self.constant = is_number(value)
        self._x, self._field, self._low = x, field, low
        self._value: Any = float(value) if self.constant else value
        self._time: float | None = None
        self._latest: Any = None

    def __call__(self, t: float) -> Any:
        if self.constant:
            return self._value
        if t != self._time:
            self._latest, self._time = checked(self._value(self._x, t), self._x.shape[1], self._field, t), t
            if np.min(self._latest) < self._low:
                raise InputError(f"is below {self._low:g} at t = {t:g} s", field=self._field)
        return self._latest


def checked(value: Any, n: int, field: str, t: float) -> Any:
    """A float, or a finite array (n,): what a user's function returned."""
    array = np.asarray(value, dtype=float)
    if array.ndim == 0 or array.size == 1:
        array = np.float64(array.reshape(()))
    elif array.shape != (n,):
        raise InputError(f"the function returned shape {array.shape}; wanted a scalar or ({n},)", field=field)
    if not np.isfinite(array).all():
        raise InputError(f"the function returned a value that is not finite at t = {t:g} s", field=field)
    return float(array) if array.ndim == 0 else array


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


class Load:
    """One heat input. `slot` is its line in the ledger of powers into the body (W)."""

    slot = -1
    timed = False
    static = False

    def freeze(self, t: float, y: State, linear: Linear) -> None:
        """Put the frozen linear part into `linear`."""

    def stale(self, t: float, y: State) -> bool:
        """Whether the frozen part differs by more than a fifth from what it should be now."""
        return False

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        """Add what the linear part leaves out to G (body) and Gg (reservoirs); return the power, W."""
        raise InputError("a load must define its remainder")

    def linear_power(self, y: State) -> float:
        """Power of the frozen linear part, W into the body."""
        return 0.0


class SourceLoad(Load):
    """Volumetric source, W/m3 at the nodes of a subdomain."""

    def __init__(self, ops: Operators, name: str, q: Any) -> None:
        self._field = f"sources.{name}"
        self.static = is_number(q)
        if not self.static and not callable(q):
            raise InputError(f"must be a number or f(x, t, T), not {q!r}", field=self._field)
        self.q, self.x, self.dofs = q, ops.nodes(name), ops.dofs(name)
        self.all_dofs = self.dofs.size == ops.size
        self.matrix = ops.source(name)
        self.row = np.asarray(self.matrix.sum(axis=0)).ravel()

    def at_nodes(self, t: float, u: Array) -> Array:
        """Source at the nodes, (n_nodes,)."""
        T = u if self.all_dofs else u[self.dofs]
        value = self.q if self.static else checked(self.q(self.x, t, T), self.dofs.size, self._field, t)
        return np.broadcast_to(value, self.dofs.shape)

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        q = self.at_nodes(t, y.u)
        G += self.matrix @ q
        return float(self.row @ q)


class FilmLoad(Load):
    """h (sink - T), the sink a temperature or a reservoir."""

    def __init__(self, surface: Surface, film: Film, field: str, reservoir: int | None) -> None:
        self.s, self.reservoir = surface, reservoir
        self.h = Datum(film.h, surface.x, f"{field}.h", low=0.0)
        self.sink = Datum(0.0 if reservoir is not None else film.sink, surface.x, f"{field}.sink")
        self.timed = not (self.h.constant and self.sink.constant)
        self.static = not self.timed
        self.h0: Any = 0.0

    def freeze(self, t: float, y: State, linear: Linear) -> None:
        self.h0 = self.h(t)
        weighted = self.s.weight * self.h0
        where, value = self.s.exchange(weighted)
        np.add.at(linear.S, where, value)
        self.row, self.total = self.s.trace_t @ weighted, float(weighted.sum())
        if self.reservoir is not None:
            linear.B[self.s.dofs, self.reservoir] += self.row
            linear.D[self.reservoir, self.reservoir] += self.total

    def stale(self, t: float, y: State) -> bool:
        if self.h.constant:
            return False
        h = self.h(t)
        return bool(np.max(np.abs(h - self.h0)) > _STALE * max(np.max(h), np.max(self.h0)))

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        h, h0, s, r = self.h(t), self.h0, self.s, self.reservoir
        same = h is h0 or (h == h0 if np.ndim(h) == np.ndim(h0) == 0 else np.array_equal(h, h0))
        if r is not None:
            if same:
                return 0.0
            load = s.trace_t @ (s.weight * (h - h0) * (y.g[r] - s.trace @ y.u[s.dofs]))
        else:
            sink = self.sink(t)
            if same:
                load = s.row * (h * sink) if np.ndim(h) == np.ndim(sink) == 0 else s.trace_t @ (s.weight * h * sink)
            else:
                load = s.trace_t @ (s.weight * (h * sink - (h - h0) * (s.trace @ y.u[s.dofs])))
        G[s.dofs] += load
        power = float(load.sum())
        if r is not None:
            Gg[r] -= power
        return power

    def linear_power(self, y: State) -> float:
        back = 0.0 if self.reservoir is None else self.total * y.g[self.reservoir]
        return float(back - self.row @ y.u[self.s.dofs])

    def coupling(self, t: float, u: Array) -> tuple[float, float]:
        """Integrals of h T and of h over the surface now, W and W/K."""
        weighted = self.s.weight * self.h(t)
        return float(weighted @ (self.s.trace @ u[self.s.dofs])), float(weighted.sum())

    def slopes(self, t: float, y: State) -> tuple[Any, Any]:
        """Quadrature values h of -d(power)/dT, for Newton's method."""
        return self.h(t)


class FluxLoad(Load):
    """A given flux into the body."""

    def __init__(self, surface: Surface, flux: Flux, field: str) -> None:
        self.s, self.q = surface, Datum(flux.q, surface.x, f"{field}.q")
        self.static = self.q.constant
        self.timed = not self.static

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        q = self.q(t)
        load = self.s.row * q if np.ndim(q) == 0 else self.s.trace_t @ (self.s.weight * q)
        G[self.s.dofs] += load
        return float(load.sum())


class RadiationLoad(Load):
    """eps sigma (Ts^4 - T^4); its frozen part is 4 eps sigma T^3 at the temperature of the last freeze."""

    def __init__(self, surface: Surface, radiation: Radiation, field: str) -> None:
        self.s, self.factor = surface, STEFAN_BOLTZMANN * float(radiation.emissivity)
        self.surroundings = Datum(radiation.surroundings, surface.x, f"{field}.surroundings", low=-273.15)
        self.timed = not self.surroundings.constant

    def slopes(self, t: float, y: State) -> Array:
        """Quadrature values of -dq/dT."""
        return 4 * self.factor * (self.s.trace @ y.u[self.s.dofs] + 273.15) ** 3

    def freeze(self, t: float, y: State, linear: Linear) -> None:
        self.h0 = self.slopes(t, y)
        weighted = self.s.weight * self.h0
        where, value = self.s.exchange(weighted)
        np.add.at(linear.S, where, value)
        self.row = self.s.trace_t @ weighted

    def stale(self, t: float, y: State) -> bool:
        return bool(np.any(np.abs(self.slopes(t, y) - self.h0) > _STALE * self.h0))

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        T = self.s.trace @ y.u[self.s.dofs]
        q = self.factor * ((self.surroundings(t) + 273.15) ** 4 - (T + 273.15) ** 4)
        load = self.s.trace_t @ (self.s.weight * (q + self.h0 * T))
        G[self.s.dofs] += load
        return float(load.sum())

    def linear_power(self, y: State) -> float:
        return float(-self.row @ y.u[self.s.dofs])


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
        return any(
            bool(np.any(np.abs(k - k0) > _STALE * k0)) for k, k0 in zip(self.values(y.u), self.k0, strict=True)
        )

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        for slope, back, k, k0 in zip(self.q.slopes, self.q.slopes_t, self.values(y.u), self.k0, strict=True):
            G -= back @ (self.q.weight * (k - k0) * (slope @ y.u))
        return 0.0


class ExchangeLoad(Load):
    """Conductance (W/K) between a reservoir and another one, or a given temperature. Its slot: W into it."""

    def __init__(self, owner: int, conductance: Any, other: Any, field: str, partner: int | None) -> None:
        nowhere = np.zeros((2, 1))
        self.owner, self.partner = owner, partner
        self.conductance = Datum(conductance, nowhere, field, low=0.0)
        self.other = Datum(0.0 if partner is not None else other, nowhere, field)
        self.timed = not (self.conductance.constant and self.other.constant)
        self.static = not self.timed

    def freeze(self, t: float, y: State, linear: Linear) -> None:
        self.h0, i, j = self.conductance(t), self.owner, self.partner
        linear.D[i, i] += self.h0
        if j is not None:
            linear.D[j, j] += self.h0
            linear.D[i, j] -= self.h0
            linear.D[j, i] -= self.h0

    def stale(self, t: float, y: State) -> bool:
        h = self.conductance(t)
        return abs(h - self.h0) > _STALE * max(h, self.h0)

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        h, j = self.conductance(t), self.partner
        if j is not None:
            power = (h - self.h0) * (y.g[j] - y.g[self.owner])
            Gg[j] -= power
        else:
            power = h * self.other(t) - (h - self.h0) * y.g[self.owner]
        Gg[self.owner] += power
        return float(power)

    def linear_power(self, y: State) -> float:
        back = 0.0 if self.partner is None else y.g[self.partner]
        return float(self.h0 * (back - y.g[self.owner]))


class PowerLoad(Load):
    """Power put straight into a reservoir, W."""

    def __init__(self, owner: int, power: Any, field: str) -> None:
        self.owner, self.power = owner, Datum(power, np.zeros((2, 1)), field)
        self.static = self.power.constant
        self.timed = not self.static

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        power = self.power(t)
        Gg[self.owner] += power
        return float(power)


def time_only(function: Callable[..., Any]) -> Callable[..., Any]:
    """f(t) as f(x, t): a reservoir has no place."""
    return lambda x, t: function(t)


def reservoir_loads(
    index: int, name: str, reservoir: Reservoir, numbers: dict[str, int]
) -> list[tuple[str, Load]]:
    """The exchanges and the power of one reservoir, with their ledger labels."""
    from tyrefem.errors import nearest

    loads: list[tuple[str, Load]] = []
    for i, (conductance, other) in enumerate(reservoir.exchanges):
        field = f"reservoirs.{name}.exchanges[{i}]"
        partner = None
        if isinstance(other, str):
            if other not in numbers or other == name:
                raise InputError(f"unknown reservoir {other!r}{nearest(other, numbers)}", field=field)
            partner = numbers[other]
        of_time = [time_only(v) if callable(v) else v for v in (conductance, other)]
        loads.append((f"{name}[{i}]", ExchangeLoad(index, *of_time, field, partner)))
    power = time_only(reservoir.power) if callable(reservoir.power) else reservoir.power
    if callable(power) or float(power) != 0.0:
        loads.append((name, PowerLoad(index, power, f"reservoirs.{name}.power")))
    return loads
