"""The heat balance of one problem: its system of equations, and the ledger of all powers."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.added_states import AddedStates, StateRates
from tyrefem.conduction.capacity import GAUSS, Capacity
from tyrefem.conduction.conditions import Material, Reservoir
from tyrefem.conduction.datum import Datum
from tyrefem.conduction.equation import System
from tyrefem.conduction.fixed_nodes import FixedNodes
from tyrefem.conduction.operators import Operators, Surface
from tyrefem.conduction.reservoirs import ExchangeLoad, PowerLoad
from tyrefem.conduction.sources import SourceLoad, Sources
from tyrefem.conduction.surface_loads import FilmLoad
from tyrefem.conduction.terms import Load, State
from tyrefem.conduction.variable_conduction import VariableConduction
from tyrefem.errors import InputError

Array = NDArray[Any]


class HeatBalance(System):
    """The `System` of a problem, frozen at a state and frozen anew when stale, with its powers.

    `entries` is the ledger: (kind, name, index) of every power. A positive power heats the body; for an exchange or a
    reservoir's power it heats the reservoir.
    """

    def __init__(
        self,
        ops: Operators,
        regions: dict[str, Material],
        loads: list[tuple[tuple[str, str, int], Load]],
        fixed: list[tuple[tuple[str, str, int], Surface, Datum]],
        reservoirs: dict[str, Reservoir],
        added: AddedStates | None = None,
    ) -> None:
        self.ops = ops
        self.capacities = {name: Capacity(ops, name, material) for name, material in regions.items()}
        self.entries = [entry for entry, _ in loads] + [entry for entry, _, _ in fixed]
        for slot, (_, load) in enumerate(loads):
            load.slot = slot
        self.loads = [load for _, load in loads]
        self.fixed = FixedNodes(ops.size, [(len(loads) + i, s, d) for i, (_, s, d) in enumerate(fixed)])
        stiffness = np.zeros(ops.nnz)
        self.conduction: list[VariableConduction] = []
        for name, material in regions.items():
            k = material.conductivity
            if callable(k):
                self.conduction.append(VariableConduction(ops, name, material))
                self.conduction[-1].cause = k
                continue
            pair = k if isinstance(k, (tuple, list)) else (k, k)
            for data, value in zip(ops.conduction(name, material.direction), pair, strict=True):
                stiffness += float(value) * data
        acting: list[Load] = [*self.loads, *self.conduction]
        if added is not None:
            acting.append(StateRates(ops, added, list(reservoirs)))
        super().__init__(ops, list(self.capacities.values()), stiffness, acting, reservoirs, len(self.entries), added)
        if not self.variable_capacity:
            self._capacity_rows = np.array([c.row for c in self.capacities.values()])
        moving = self.moving
        # A subdomain without elements has no heat, and no place in the sums of `Sources`.
        sources = [load for load in moving if isinstance(load, SourceLoad) and load.dofs.size]
        together = [Sources(ops, sources)] if sources else []
        self.moving = [*together, *(load for load in moving if not isinstance(load, SourceLoad))]
        self._timed = [load for load in acting if load.timed]
        self._linear = [load for load in self.loads if type(load).linear_power is not Load.linear_power]
        self._watched = [load for load in self.acting if type(load).stale is not Load.stale]
        heat = [r.heat_capacity for r in reservoirs.values()]
        self.massless = np.array([i for i, c in enumerate(heat) if not callable(c) and float(c) == 0.0], dtype=int)
        self.massive = np.array([i for i in range(len(heat)) if i not in self.massless], dtype=int)
        #: Unknowns of g with a rate, added states included.
        self.rated = np.array([i for i in range(self.m) if i not in self.massless], dtype=int)
        self.variable_reservoirs = any(callable(c) for c in heat)

    def reservoir_stored(self, before: Array, after: Array) -> Array:
        """Heat stored in every reservoir between two temperatures, J."""
        count = len(self.reservoirs)
        before, after = before[:count], after[:count]
        if not self.variable_reservoirs:
            return self.reservoir_capacity(after)[:count] * (after - before)
        mean = sum(w / 2 * self.reservoir_capacity(before + (x + 1) / 2 * (after - before))[:count] for x, w in GAUSS)
        return np.asarray(mean * (after - before))

    def freeze(self, t: float, y: State) -> None:
        """Evaluate the linear part at this state: only numbers change, nothing is assembled again."""
        self.assemble(t, y)
        B = self.fixed.dofs
        if B.size:
            self.S_fixed, self.M_fixed = self.S[B], self.M[B]

    def stale(self, t: float, y: State) -> bool:
        """True if the frozen linear part should be frozen anew."""
        self.show(y.g)
        if any(load.stale(t, y) for load in self._watched):
            return True
        # A massless reservoir has none to divide by.
        if self.variable_reservoirs and np.any(np.abs(self.reservoir_capacity(y.g) - self.C) > 0.2 * self.C):
            return True
        if not self.variable_capacity:
            return False
        now = self.ops.matrix(self.mass(y.u)).diagonal()
        return bool(np.any(np.abs(now / self.M.diagonal() - 1) > 0.2))

    def time_slope(self, t: float, y: State, dt: float) -> tuple[Array, Array, Array] | None:
        """Partial time derivative of the remainder, for boundary data that depend on time."""
        if not self._timed:
            return None
        now, later = self.zeros(), self.zeros()
        self.add(now, t, y, self._timed)
        self.add(later, t + dt, y, self._timed)
        return tuple((b - a) / dt for a, b in zip(now, later, strict=True))  # type: ignore[return-value]

    def add_linear_powers(self, y: State, P: Array) -> None:
        """Add the powers of the frozen linear part at a state to the ledger powers P."""
        for load in self._linear:
            P[load.slot] += load.linear_power(y)

    def balance_massless(self, t: float, u: Array, g: Array) -> None:
        """Set the massless reservoirs in `g` to their equilibrium temperatures."""
        if not self.massless.size:
            return
        self.show(g)
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
        """Heat stored in every region, J."""
        if not self.variable_capacity:
            return np.asarray(self._capacity_rows @ (after - before))
        return np.array([c.stored(before, after) for c in self.capacities.values()])

    def storage_power(self, u: Array, slope: Array) -> Array:
        """Heat stored per second in every region, W."""
        if not self.variable_capacity:
            return np.asarray(self._capacity_rows @ slope)
        return np.array([c.rate(u, slope) for c in self.capacities.values()])
