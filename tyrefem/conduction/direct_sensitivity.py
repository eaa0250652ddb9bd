"""Direct effect of parameters on the heat balance at given temperatures, for all parameters together."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.balance import HeatBalance
from tyrefem.conduction.capacity import Capacity
from tyrefem.conduction.sources import SourceLoad
from tyrefem.conduction.surface_loads import FilmLoad
from tyrefem.conduction.terms import Load, State

Array = NDArray[Any]


class DirectHeat:
    """dF/dp - (dM/dp) du/dt for every parameter p at constant t and u; F: heat into every unknown, M du/dt = F.

    Only loads that differ from those of the base problem are evaluated. Loads of the same place are summed first and
    then distributed to the unknowns in one product. All problems are frozen at one state, so that common parts cancel.

    Parameters
    ----------
    base, others : balances on the same operators, others[i] with parameter i larger by steps[i]; frozen here at t, y.
    """

    def __init__(
        self, base: HeatBalance, others: Sequence[HeatBalance], steps: Sequence[float], t: float, y: State
    ) -> None:
        for balance in (base, *others):
            balance.freeze(t, y)
        self.base, self.others, self.steps = base, others, np.asarray(steps)
        shares, places = self._shares(), dict[Any, list[Load]]()
        for load in shares:
            places.setdefault(_place(load), []).append(load)
        together = [(loads, np.array([shares[load] for load in loads])) for loads in places.values()]
        # For each place: the loads, and (n_loads, n_parameters) their change per unit of each parameter.
        self._sources: list[tuple[Any, Array]] = [
            balance for balance in together if isinstance(balance[0][0], SourceLoad)
        ]
        self._films: list[tuple[Any, Array]] = [balance for balance in together if isinstance(balance[0][0], FilmLoad)]
        self._single = [balance for balance in together if not isinstance(balance[0][0], SourceLoad | FilmLoad)]
        self._operators = [_Change.between(base, other, step) for other, step in zip(others, steps, strict=True)]
        variable = any(balance.variable_reservoirs for balance in (base, *others))
        self._constant_gas = None if variable else self._gas_capacity(y.g)

    def _shares(self) -> dict[Load, Array]:
        """Load -> (n_parameters,): 1/step if a parameter adds it, -1/step if a parameter replaces it."""
        shares_of: dict[Load, Array] = {}
        for column, (other, step) in enumerate(zip(self.others, self.steps, strict=True)):
            for sign, balance, reference in ((1, other, self.base), (-1, self.base, other)):
                known = {_identity(reference, load) for load in reference.acting}
                for load in balance.acting:
                    if _identity(balance, load) not in known:
                        shares_of.setdefault(load, np.zeros(len(self.others)))[column] = sign / step
        return shares_of

    def __call__(self, t: float, y: State) -> Array:
        """(n + m, n_parameters) W per unit of each parameter; m: reservoirs."""
        n = y.u.size
        rates = np.zeros((len(self.others), n + y.g.size))
        body, gas = rates[:, :n], rates[:, n:]
        if self._sources:
            body += self._heat_of_sources(t, y).T
        for films, shares in self._films:
            heat = _heat_of_films(films, shares, t, y)
            body[:, films[0].s.dofs] += heat
            if films[0].reservoir is not None:
                gas[:, films[0].reservoir] -= heat.sum(axis=1)
        for loads, shares in self._single:
            each = np.zeros((len(loads), n + y.g.size))
            for load, heat in zip(loads, each, strict=True):
                load.remainder(t, y, heat[:n], heat[n:])
            rates += shares.T @ each
        base_heat = heat_of(self.base, t, y)
        rate = self._rate(y, base_heat[:n])
        for change, to_body, to_gas in zip(self._operators, body, gas, strict=True):
            change.add(y, rate, to_body, to_gas)
        capacity = self.base.reservoir_capacity(y.g)
        more = self._gas_capacity(y.g) if self._constant_gas is None else self._constant_gas
        gas -= more * (base_heat[n:] / np.where(capacity > 0, capacity, 1.0))
        return np.ascontiguousarray(rates.T)

    def _heat_of_sources(self, t: float, y: State) -> Array:
        """(n, n_parameters)."""
        heat = [np.column_stack([load.at_nodes(t, y.u) for load in loads]) @ shares for loads, shares in self._sources]
        return np.asarray(self.base.ops.source(*(loads[0].name for loads, _ in self._sources)) @ np.concatenate(heat))

    def _gas_capacity(self, g: Array) -> Array:
        """(n_parameters, m): change of the reservoirs' heat capacities, J/K per unit of each parameter."""
        capacity = self.base.reservoir_capacity(g)
        change = [other.reservoir_capacity(g) - capacity for other in self.others]
        return np.reshape(change, (len(change), g.size)) / self.steps[:, None]

    def rate(self, t: float, y: State) -> Array:
        """(n,) du/dt of the base problem, K/s."""
        return self._rate(y, heat_of(self.base, t, y)[: y.u.size])

    def _rate(self, y: State, heat: Array) -> Array:
        factor = self._factor(self.base.mass(y.u)) if self.base.variable_capacity else self._constant_mass
        return np.asarray(factor.solve(heat.copy()))

    @functools.cached_property
    def _constant_mass(self) -> Any:
        return self._factor(self.base.M_data)

    def _factor(self, data: Array) -> Any:
        return self.base.ops.ordering(np.arange(self.base.ops.size)).factor(data)


@dataclass(frozen=True)
class _Change:
    """Change of the operators per unit of one parameter; None: no change.

    ``capacities``: pairs of base and changed heat capacity if they differ and one varies with temperature.
    """

    base: HeatBalance
    step: float
    S: Any
    M: Any
    B: Any
    D: Any
    capacities: list[tuple[Capacity, Capacity]]

    @classmethod
    def between(cls, base: HeatBalance, other: HeatBalance, step: float) -> _Change:
        """The change from one balance to another."""

        def change(base_value: Array, changed_value: Array) -> Array | None:
            return None if np.array_equal(base_value, changed_value) else (changed_value - base_value) / step

        differ = [(base_value, other.capacities[name]) for name, base_value in base.capacities.items()]
        differ = [
            (base_value, changed_value) for base_value, changed_value in differ if base_value.c != changed_value.c
        ]
        variable = [pair for pair in differ if not (pair[0].constant and pair[1].constant)]
        M = sum(
            (changed_value.data - base_value.data) / step
            for base_value, changed_value in differ
            if base_value.constant and changed_value.constant
        )
        S = change(base.S_data, other.S_data)
        return cls(
            base,
            step,
            None if S is None else base.ops.matrix(S),
            base.ops.matrix(M) if isinstance(M, np.ndarray) else None,
            change(base.B, other.B),
            change(base.D, other.D),
            variable,
        )

    def add(self, y: State, rate: Array, body: Array, gas: Array) -> None:
        """Add the heat of the changed operators; rate: du/dt."""
        if self.S is not None:
            body -= self.S @ y.u
        if self.M is not None:
            body -= self.M @ rate
        if self.capacities:
            more = np.sum(
                [changed_value.mass(y.u) - base_value.mass(y.u) for base_value, changed_value in self.capacities],
                axis=0,
            )
            body -= self.base.ops.matrix(more / self.step) @ rate
        if self.B is not None:
            body += self.B @ y.g
            gas += self.B.T @ y.u
        if self.D is not None:
            gas -= self.D @ y.g


def _place(load: Load) -> Any:
    """Key of a load's place. Loads of one place differ by nodal sources, or by films and fluxes at its points."""
    if isinstance(load, SourceLoad):
        return load.name
    return (load.s, load.reservoir) if isinstance(load, FilmLoad) else None


def _identity(balance: HeatBalance, load: Load) -> tuple[Any, ...]:
    """Key that is equal for equal loads of two balances: same cause, same place. A load without cause equals none."""
    place = balance.entries[load.slot][:2] if load.slot >= 0 else getattr(load, "name", None)
    return place, id(load if load.cause is None else load.cause)


def _heat_of_films(films: list[FilmLoad], shares: Array, t: float, y: State) -> Array:
    """(n_parameters, n_dofs): remainder of films of one surface and sink, weighted with their ``shares``."""
    s, T = films[0].s, films[0].s.trace @ y.u[films[0].s.dofs]
    parts = [film.excess(t, y) for film in films]
    if all(isinstance(value, float) for part in parts for value in part):
        even, slope = shares.T @ np.array(parts)[:, 0], shares.T @ np.array(parts)[:, 1]
        return np.asarray(np.outer(even, s.load(1.0)) - np.outer(slope, s.trace_t @ (s.weight * T)))
    flux, more = np.empty((2, len(films), s.weight.size))
    for number, part in enumerate(parts):
        flux[number], more[number] = part
    q = shares.T @ flux - (shares.T @ more) * T
    return np.asarray((s.trace_t @ (q * s.weight).T).T)


def heat_of(balance: HeatBalance, t: float, y: State) -> Array:
    """(n + m,) heat into every unknown, W; exact for any state of the freeze."""
    return np.concatenate(balance.heat(t, y))
