"""The semi-discrete heat balance of one problem: M du/dt = -S u + G(t, u), reservoirs included.

Heat capacity of a region and the heat it stores.

Unknowns whose temperature is prescribed.
"""

from __future__ import annotations

from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.conditions import Datum, Material, Reservoir, is_number
from tyrefem.conduction.loads import Linear, Load, SourceLoad, Sources, State, VariableConduction
from tyrefem.conduction.operators import Operators, Surface
from tyrefem.conduction.reservoirs import ExchangeLoad, PowerLoad
from tyrefem.conduction.surface_loads import FilmLoad
from tyrefem.errors import InputError

Array = NDArray[Any]


GAUSS = tuple(zip(*np.polynomial.legendre.leggauss(5), strict=True))


class Capacity:
    """Volumetric heat capacity of one region, constant or a function of temperature."""

    def __init__(self, ops: Operators, name: str, material: Material) -> None:
        self.name, self.dofs = name, ops.dofs(name)
        self.constant = is_number(material.heat_capacity)
        self.c = cast(Any, material.heat_capacity)
        if self.constant:
            self.data = ops.mass(name) * float(self.c)
            self.row = ops.mass_row(name) * float(self.c)
        else:
            self.q = ops.quadrature(name, material.direction)

    def values(self, T: Array) -> Array:
        """c at quadrature temperatures."""
        c = np.broadcast_to(np.asarray(self.c(T), dtype=float), T.shape)
        if not np.min(c) > 0:
            where = f"between {T.min():.6g} and {T.max():.6g} degC"
            raise InputError(f"is not positive {where}", field=f"regions.{self.name}.heat_capacity")
        return c

    def mass(self, u: Array) -> Array:
        """Operator values of the integral of c v u."""
        return self.data if self.constant else self.q.mass @ self.values(self.q.value @ u)

    def slope(self, u: Array, rate: Array, bump: float) -> Array:
        """Operator values of d(M du/dt)/d(temperature) at a rate (n,), K/s, by differences of so many K either way."""
        T = self.q.value @ u
        rise = (self.values(T + bump) - self.values(T - bump)) / (2 * bump)
        return np.asarray(self.q.mass @ (rise * (self.q.value @ rate)))

    def stored(self, before: Array, after: Array) -> float:
        """Heat taken up from one temperature field to another, J."""
        if self.constant:
            return float(self.row @ (after - before))
        T0, T1 = self.q.value @ before, self.q.value @ after
        mean = sum(w / 2 * self.values(T0 + (x + 1) / 2 * (T1 - T0)) for x, w in GAUSS)
        return float(self.q.weight @ (mean * (T1 - T0)))

    def rate(self, u: Array, slope: Array) -> float:
        """Heat stored per second at temperature rate `slope`, W."""
        if self.constant:
            return float(self.row @ slope)
        return float(self.q.weight @ (self.values(self.q.value @ u) * (self.q.value @ slope)))


class FixedNodes:
    """Prescribed unknowns: the first boundary that names a node owns it."""

    def __init__(self, size: int, fixed: list[tuple[int, Surface, Datum]]) -> None:
        owner = np.full(size, -1)
        self._data: list[tuple[int, Datum, Array]] = []
        for slot, surface, value in fixed:
            mine = owner[surface.dofs] < 0
            owner[surface.dofs[mine]] = slot
            self._data.append((slot, value, mine))
        parts = [surface.dofs[mine] for (_, surface, _), (_, _, mine) in zip(fixed, self._data, strict=True)]
        self.dofs = np.concatenate(parts) if parts else np.zeros(0, np.int64)
        self.free = np.flatnonzero(owner < 0)
        ends = np.cumsum([0, *(part.size for part in parts)])
        self.parts = [(slot, slice(a, b)) for (slot, _, _), a, b in zip(self._data, ends[:-1], ends[1:], strict=True)]
        self.constant = all(value.constant for _, value, _ in self._data)

    def __call__(self, t: float) -> Array:
        """Prescribed temperatures at time t, in the order of `dofs`."""
        if not self._data:
            return np.zeros(0)
        return np.concatenate([np.broadcast_to(value(t), mine.shape)[mine] for _, value, mine in self._data])


class HeatBalance:
    """M du/dt = -S u + B g + G(t, u, g);  C dg/dt = B^T u - D g + Gg, with S, B, D frozen and G the rest.

    `entries` is the ledger: (kind, name, index) of every power; a positive power heats the body (or, for an
    exchange or a reservoir's power, the reservoir).
    """

    def __init__(
        self,
        ops: Operators,
        regions: dict[str, Material],
        loads: list[tuple[tuple[str, str, int], Load]],
        fixed: list[tuple[tuple[str, str, int], Surface, Datum]],
        reservoirs: dict[str, Reservoir],
    ) -> None:
        self.ops, self.reservoirs = ops, reservoirs
        self.capacities = {name: Capacity(ops, name, material) for name, material in regions.items()}
        self.variable_capacity = any(not c.constant for c in self.capacities.values())
        if not self.variable_capacity:
            self._capacity_rows = np.array([c.row for c in self.capacities.values()])
        self.entries = [entry for entry, _ in loads] + [entry for entry, _, _ in fixed]
        for slot, (_, load) in enumerate(loads):
            load.slot = slot
        self.loads = [load for _, load in loads]
        self.fixed = FixedNodes(ops.size, [(len(loads) + i, s, d) for i, (_, s, d) in enumerate(fixed)])
        self.K0 = np.zeros(ops.nnz)
        self.conduction: list[VariableConduction] = []
        for name, material in regions.items():
            k = material.conductivity
            if callable(k):
                self.conduction.append(VariableConduction(ops, name, material))
                self.conduction[-1].cause = k
                continue
            pair = k if isinstance(k, (tuple, list)) else (k, k)
            for data, value in zip(ops.conduction(name, material.direction), pair, strict=True):
                self.K0 += float(value) * data
        self.acting: list[Load] = [*self.loads, *self.conduction]
        moving = [load for load in self.acting if not load.static]
        sources = [load for load in moving if isinstance(load, SourceLoad)]
        self._sources = Sources(ops, sources) if sources else None
        self._moving = [load for load in moving if not isinstance(load, SourceLoad)]
        self._timed = [load for load in self.loads if load.timed]
        self._linear = [load for load in self.loads if type(load).linear_power is not Load.linear_power]
        self._watched = [load for load in self.acting if type(load).stale is not Load.stale]
        heat = [r.heat_capacity for r in reservoirs.values()]
        self.massless = np.array([i for i, c in enumerate(heat) if not callable(c) and float(c) == 0.0], dtype=int)
        self.massive = np.array([i for i in range(len(heat)) if i not in self.massless], dtype=int)
        self.variable_reservoirs = any(callable(c) for c in heat)
        self.version = 0

    def reservoir_capacity(self, g: Array) -> Array:
        """C of every reservoir at its temperature, J/K."""
        heat = [r.heat_capacity for r in self.reservoirs.values()]
        return np.array([float(c(T)) if callable(c) else float(c) for c, T in zip(heat, g, strict=True)])

    def reservoir_stored(self, before: Array, after: Array) -> Array:
        """Heat taken up by every reservoir between two temperatures, J."""
        if not self.variable_reservoirs:
            return self.reservoir_capacity(after) * (after - before)
        mean = sum(w / 2 * self.reservoir_capacity(before + (x + 1) / 2 * (after - before)) for x, w in GAUSS)
        return np.asarray(mean * (after - before))

    def mass(self, u: Array) -> Array:
        """Operator values of M at the temperatures u."""
        return np.sum([c.mass(u) for c in self.capacities.values()], axis=0)

    def freeze(self, t: float, y: State) -> None:
        """Take the linear part at this state; numbers change, nothing is reassembled."""
        linear = Linear(self.ops, len(self.reservoirs))
        linear.S += self.K0
        for load in self.acting:
            load.freeze(t, y, linear)
        self.S_data, self.B, self.D = linear.S, linear.B, linear.D
        self.S = self.ops.matrix(linear.S)
        if self.variable_capacity or not self.version:
            self.M_data = self.mass(y.u)
            self.M = self.ops.matrix(self.M_data)
        self.C = self.reservoir_capacity(y.g)
        self._G, self._Gg, self._P = self._blank()
        for load in self.acting:
            if load.static:
                self._P[load.slot] += load.remainder(t, y, self._G, self._Gg)
        B = self.fixed.dofs
        if B.size:
            self.S_fixed, self.M_fixed = self.S[B], self.M[B]
        self.version += 1

    def _blank(self) -> tuple[Array, Array, Array]:
        return np.zeros(self.ops.size), np.zeros(len(self.reservoirs)), np.zeros(len(self.entries))

    def stale(self, t: float, y: State) -> bool:
        """Whether the frozen linear part should be renewed."""
        if any(load.stale(t, y) for load in self._watched):
            return True
        if self.variable_reservoirs and np.any(np.abs(self.reservoir_capacity(y.g) / self.C - 1) > 0.2):
            return True
        if not self.variable_capacity:
            return False
        now = self.ops.matrix(self.mass(y.u)).diagonal()
        return bool(np.any(np.abs(now / self.M.diagonal() - 1) > 0.2))

    def remainder(self, t: float, y: State) -> tuple[Array, Array, Array]:
        """(G, Gg, powers by ledger entry) that the frozen linear part leaves out."""
        G, Gg, P = self._G.copy(), self._Gg.copy(), self._P.copy()
        if self._sources is not None:
            P[self._sources.slots] += self._sources.remainder(t, y, G)
        for load in self._moving:
            power = load.remainder(t, y, G, Gg)
            if load.slot >= 0:
                P[load.slot] += power
        return G, Gg, P

    def time_slope(self, t: float, y: State, dt: float) -> tuple[Array, Array, Array] | None:
        """Partial time derivative of the remainder of boundary data that depend on time."""
        if not self._timed:
            return None
        now, later = self._blank(), self._blank()
        for when, (G, Gg, P) in ((t, now), (t + dt, later)):
            for load in self._timed:
                P[load.slot] += load.remainder(when, y, G, Gg)
        return tuple((b - a) / dt for a, b in zip(now, later, strict=True))  # type: ignore[return-value]

    def add_linear_powers(self, y: State, P: Array) -> None:
        """Add the powers of the frozen linear part at a state to the ledger line P."""
        for load in self._linear:
            P[load.slot] += load.linear_power(y)

    def settle(self, t: float, u: Array, g: Array) -> None:
        """Set the massless reservoirs in `g` to the temperatures that balance them."""
        if not self.massless.size:
            return
        m = len(self.reservoirs)
        D, p = np.zeros((m, m)), np.zeros(m)
        for load in self.loads:
            if isinstance(load, FilmLoad) and load.reservoir is not None:
                heat, h = load.coupling(t, u)
                D[load.reservoir, load.reservoir] += h
                p[load.reservoir] += heat
            elif isinstance(load, ExchangeLoad):
                h, i, j = load.conductance(t), load.owner, load.partner
                D[i, i] += h
                if j is None:
                    p[i] += h * load.other(t)
                else:
                    D[j, j] += h
                    D[i, j] -= h
                    D[j, i] -= h
            elif isinstance(load, PowerLoad):
                p[load.owner] += load.power(t)
        z, rest = self.massless, self.massive
        block = D[np.ix_(z, z)]
        if np.linalg.matrix_rank(block) < z.size:
            name = list(self.reservoirs)[int(z[np.argmin(np.diagonal(block))])]
            raise InputError("has no heat capacity and exchanges heat with nothing", field=f"reservoirs.{name}")
        g[z] = np.linalg.solve(block, p[z] - D[np.ix_(z, rest)] @ g[rest])

    def reaction(self, t: float, y: State, slope: Array, mass: Any = None) -> Array:
        """Power entering through each ledger entry of a fixed boundary, W, at temperature rate `slope`."""
        P = np.zeros(len(self.entries))
        B = self.fixed.dofs
        if B.size:
            G, _, _ = self.remainder(t, y)
            M = self.M_fixed if not self.variable_capacity else self.ops.matrix(self.mass(y.u))[B]
            r = M @ slope + self.S_fixed @ y.u - self.B[B] @ y.g - G[B]
            for slot, part in self.fixed.parts:
                P[slot] = r[part].sum()
        return P

    def powers(self, t: float, y: State, slope: Array) -> Array:
        """Instantaneous power of every ledger entry, W."""
        _, _, P = self.remainder(t, y)
        self.add_linear_powers(y, P)
        return P + self.reaction(t, y, slope)

    def stored(self, before: Array, after: Array) -> Array:
        """Heat taken up by every region, J."""
        if not self.variable_capacity:
            return np.asarray(self._capacity_rows @ (after - before))
        return np.array([c.stored(before, after) for c in self.capacities.values()])

    def storing(self, u: Array, slope: Array) -> Array:
        """Heat stored per second in every region, W."""
        if not self.variable_capacity:
            return np.asarray(self._capacity_rows @ slope)
        return np.array([c.rate(u, slope) for c in self.capacities.values()])
