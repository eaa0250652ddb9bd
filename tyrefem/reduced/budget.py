"""Heat budget of reduced variants, and their history in the format of the full model."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.budget import Budget, Tally
from tyrefem.conduction.field import History, Peak, Steps
from tyrefem.reduced.balance import ReducedBalance
from tyrefem.reduced.boundary_data import BoundaryData
from tyrefem.reduced.shared_product import shared_product

Array = NDArray[np.float64]


class HeatFlows:
    """Heat flows of a batch: by zone, by film, by exchange, and powers of reservoirs."""

    def __init__(self, balances: Sequence[ReducedBalance]) -> None:
        self.b, self.given = balances[0], balances[0].exchanges.given
        #: (1 or B, ...) by shape: W of zones per source at the samples; W per kelvin; m2.
        self.power = by_shape(balances, lambda balance: balance.model.power)
        self.rows = by_shape(balances, lambda balance: balance.exchanges.rows)
        self.areas = by_shape(balances, lambda balance: balance.exchanges.areas)

    @property
    def width(self) -> int:
        """Number of entries."""
        return len(self.b.model.zones) + len(self.given) + len(self.b.reservoirs)

    def powers(self, data: BoundaryData, q: Array, y: Array) -> Array:
        """(B, width) W of sources q (B, n_samples) and states y (B, n)."""
        exchanged = (self.rows @ y[:, :, None])[:, :, 0] + np.where(self.given, data.sinks * self.areas, 0.0)
        return np.concatenate([(self.power @ q[:, :, None])[:, :, 0], data.films * exchanged, data.powers], axis=1)

    def rest(self, q: Array, films: Array, sinks: Array, powers: Array, frozen: Array, y: Array) -> Array:
        """(B, width, k) W of all heat flows except those of frozen films (B, n_exchanges) with states y (B, n, k)."""
        count = y.shape[2]
        exchanged = films * np.where(self.given[:, None], sinks * self.areas[:, :, None], 0.0)
        if films.shape[2] > 1:
            exchanged = exchanged + (films - frozen[:, :, None]) * (self.rows @ y)
        parts = [
            shared_product(self.power, q),
            *(np.broadcast_to(terms, (*terms.shape[:2], count)) for terms in (exchanged, powers)),
        ]
        return np.concatenate(parts, axis=1)

    def frozen(self, films: Array, y: Array) -> Array:
        """(B, width, k) W, or J, of frozen films (B, n_exchanges) with states, or their integrals, y (B, n, k)."""
        flows = np.zeros((len(y), self.width, y.shape[2]))
        first = len(self.b.model.zones)
        flows[:, first : first + films.shape[1]] = films[:, :, None] * (self.rows @ y)
        return flows

    def entries(self) -> list[tuple[str, str, int]]:
        """(kind, name, number) of every entry, as `tyrefem.conduction.budget.Tally` takes them."""
        names = list(self.b.reservoirs)
        entries = [("source", zone, 0) for zone in self.b.model.zones]
        entries += [("boundary", side, number) for side, number, _ in self.b.films]
        entries += [("reservoir", name, i) for name in names for i, _ in enumerate(self.b.reservoirs[name].exchanges)]
        return entries + [("reservoir", name, -1) for name in names]


def by_shape(balances: Sequence[ReducedBalance], of: Callable[[ReducedBalance], Array]) -> Array:
    """(1, ...) if all variants have the same shape, and so the same projected operators, else (B, ...)."""
    first = balances[0]
    if all(balance.model is first.model for balance in balances):
        return of(first)[None]
    return np.stack([of(balance) for balance in balances])


def budget(
    balance: ReducedBalance, times: Array, states: Array, slopes: Array, powers: Array, energies: Array
) -> Budget:
    """The heat budget at times (s) of states (n_times, n); heat counts from the start of the balance."""
    model, m = balance.model, balance.model.size
    rows = np.array([balance.bodies[region][2] * model.stored_row[region] for region in balance.bodies])
    stored = (states[:, :m] - balance.start[:m]) @ rows.T
    storing = slopes[:, :m] @ rows.T
    in_reservoirs = (states[:, m:] - balance.start[m:]) * balance.capacities
    return _tally(balance, times, energies, powers, stored, storing, in_reservoirs)


def end_budgets(
    balances: Sequence[ReducedBalance], states: Array, slopes: Array, powers: Array, energies: Array
) -> Budget:
    """The heat budget of B variants at the end of their drive; the variants take the place of the times."""
    first, m = balances[0], balances[0].model.size
    rows = by_shape(balances, lambda balance: np.array([balance.model.stored_row[region] for region in first.bodies]))
    capacity = np.array([[body[2] for body in balance.bodies.values()] for balance in balances])
    in_reservoirs = np.array([each.capacities for each in balances])
    start = np.array([balance.start for balance in balances])
    stored, storing = (capacity * (rows @ each[:, :m, None])[:, :, 0] for each in (states - start, slopes))
    in_reservoirs = in_reservoirs * (states - start)[:, m:]
    return _tally(first, np.zeros(len(balances)), energies, powers, stored, storing, in_reservoirs)


def _tally(
    balance: ReducedBalance,
    times: Array,
    energies: Array,
    powers: Array,
    stored: Array,
    storing: Array,
    in_reservoirs: Array,
) -> Budget:
    names = list(balance.reservoirs)
    into = {(side, number): film.sink for side, number, film in balance.films if isinstance(film.sink, str)}
    between: dict[tuple[str, int], tuple[str, str | None]] = {(name, -1): (name, None) for name in names}
    for name in names:
        for i, (_, other) in enumerate(balance.reservoirs[name].exchanges):
            between[name, i] = (name, other if isinstance(other, str) else None)
    tally = Tally(HeatFlows([balance]).entries(), list(balance.bodies), names, into, between)
    for i in range(len(times)):
        tally.record(energies[i], powers[i], stored[i], storing[i], in_reservoirs[i])
    return tally.budget(times)


def history(
    balance: ReducedBalance,
    times: Array,
    states: Array,
    heat_budget: Budget,
    peak_data: tuple[Array, Array],
    steps: int,
) -> History:
    """The history of states (n_times, n) at times (s), with its heat budget.

    ``peak_data``: times (s) and states among which the peaks are searched.
    """
    model, m = balance.model, balance.model.size
    ops, (peak_times, peak_states) = model.operators, peak_data
    fields = peak_states[:, :m] @ model.V.T
    return History(
        operators=ops,
        materials=balance.tyre.bodies,
        times=times,
        values=states[:, :m] @ model.V.T,
        reservoirs={name: states[:, m + i] for i, name in enumerate(balance.reservoirs)},
        budget=heat_budget,
        maximum=_peak(ops.points, peak_times, fields, None),
        region_maximum={region: _peak(ops.points, peak_times, fields, ops.dofs(region)) for region in balance.bodies},
        steps=Steps(steps, 0, 0, 2 * steps),
    )


def _peak(points: Array, times: Array, values: Array, dofs: Array | None) -> Peak:
    of_nodes = values if dofs is None else values[:, dofs]
    i, j = np.unravel_index(int(np.argmax(of_nodes)), of_nodes.shape)
    node = int(j) if dofs is None else int(dofs[j])
    return Peak(float(of_nodes[i, j]), (float(points[0, node]), float(points[1, node])), float(times[i]))
