"""The heat budget of reduced variants, and their history as the full model gives it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.budget import Budget, Tally
from tyrefem.conduction.field import History, Peak, Steps
from tyrefem.reduced.balance import ReducedBalance
from tyrefem.reduced.boundary_data import BoundaryData

Array = NDArray[np.float64]


class Ledger:
    """Powers by zone, by film, by exchange and power of reservoirs."""

    def __init__(self, balance: ReducedBalance) -> None:
        self.b, self.at = balance, balance.exchanges

    @property
    def width(self) -> int:
        """Number of entries."""
        return len(self.b.model.zones) + len(self.at.areas) + len(self.b.reservoirs)

    def powers(self, data: BoundaryData, q: Array, y: Array) -> Array:
        """(B, width) W of sources q (B, n_samples) and states y (B, n)."""
        at = self.at
        exchanged = data.films * (y @ at.rows.T + np.where(at.given, data.sinks * at.areas, 0.0))
        return np.concatenate([q @ self.b.model.power.T, exchanged, data.powers], axis=1)

    def rest(self, q: Array, films: Array, sinks: Array, powers: Array, frozen: Array, y: Array) -> Array:
        """(B, width, k) W but for what frozen films (B, n_exchanges) exchange with states y (B, n, k)."""
        at, count = self.at, y.shape[2]
        exchanged = films * np.where(at.given[:, None], sinks * at.areas[:, None], 0.0)
        if films.shape[2] > 1:
            exchanged = exchanged + (films - frozen[:, :, None]) * (at.rows @ y)
        parts = [
            self.b.model.power @ q,
            *(np.broadcast_to(terms, (*terms.shape[:2], count)) for terms in (exchanged, powers)),
        ]
        return np.concatenate(parts, axis=1)

    def frozen(self, films: Array, y: Array) -> Array:
        """(B, width, k) W, or J, of frozen films (B, n_exchanges) with states, or their integrals, y (B, n, k)."""
        flows = np.zeros((len(y), self.width, y.shape[2]))
        first = len(self.b.model.zones)
        flows[:, first : first + films.shape[1]] = films[:, :, None] * (self.at.rows @ y)
        return flows

    def entries(self) -> list[tuple[str, str, int]]:
        names = list(self.b.reservoirs)
        entries = [("source", zone, 0) for zone in self.b.model.zones]
        entries += [("boundary", side, number) for side, number, _ in self.b.films]
        entries += [("reservoir", name, i) for name in names for i, _ in enumerate(self.b.reservoirs[name].exchanges)]
        return entries + [("reservoir", name, -1) for name in names]


def budget(
    balance: ReducedBalance, times: Array, states: Array, slopes: Array, powers: Array, energies: Array
) -> Budget:
    """The budget at times (s) of states (n_times, n), the drive's start being that of the balance."""
    model, m = balance.model, balance.model.size
    rows = np.array([balance.bodies[region][2] * model.stored_row[region] for region in balance.bodies])
    stored = (states[:, :m] - balance.start[:m]) @ rows.T
    storing = slopes[:, :m] @ rows.T
    held = (states[:, m:] - balance.start[m:]) * balance.capacities
    return _tallied(balance, times, energies, powers, stored, storing, held)


def end_budgets(
    balances: Sequence[ReducedBalance], states: Array, slopes: Array, powers: Array, energies: Array
) -> Budget:
    """The budget of variants (B, ...) at the end of their drive: each stands where a `Budget` has a time."""
    first, m = balances[0], balances[0].model.size
    rows = np.array([first.model.stored_row[region] for region in first.bodies])
    capacity = np.array([[body[2] for body in balance.bodies.values()] for balance in balances])
    held = np.array([each.capacities for each in balances])
    start = np.array([balance.start for balance in balances])
    stored, storing = (capacity * (each[:, :m] @ rows.T) for each in (states - start, slopes))
    kept = held * (states - start)[:, m:]
    return _tallied(first, np.zeros(len(balances)), energies, powers, stored, storing, kept)


def _tallied(
    balance: ReducedBalance, times: Array, energies: Array, powers: Array, stored: Array, storing: Array, held: Array
) -> Budget:
    names = list(balance.reservoirs)
    into = {(side, number): film.sink for side, number, film in balance.films if isinstance(film.sink, str)}
    between: dict[tuple[str, int], tuple[str, str | None]] = {(name, -1): (name, None) for name in names}
    for name in names:
        for i, (_, other) in enumerate(balance.reservoirs[name].exchanges):
            between[name, i] = (name, other if isinstance(other, str) else None)
    tally = Tally(Ledger(balance).entries(), list(balance.bodies), names, into, between)
    for i in range(len(times)):
        tally.record(energies[i], powers[i], stored[i], storing[i], held[i])
    return tally.budget(times)


def history(
    balance: ReducedBalance, times: Array, states: Array, budget_of_run: Budget, looked: tuple[Array, Array], steps: int
) -> History:
    """The history of states (n_times, n) at times (s), with its budget; ``looked``: times and states of the peaks."""
    model, m = balance.model, balance.model.size
    ops, (when, seen) = model.operators, looked
    fields = seen[:, :m] @ model.V.T
    return History(
        operators=ops,
        materials=balance.tyre.bodies,
        times=times,
        values=states[:, :m] @ model.V.T,
        reservoirs={name: states[:, m + i] for i, name in enumerate(balance.reservoirs)},
        budget=budget_of_run,
        maximum=_peak(ops.points, when, fields, None),
        region_maximum={region: _peak(ops.points, when, fields, ops.dofs(region)) for region in balance.bodies},
        steps=Steps(steps, 0, 0, 2 * steps),
    )


def _peak(points: Array, times: Array, values: Array, dofs: Array | None) -> Peak:
    seen = values if dofs is None else values[:, dofs]
    i, j = np.unravel_index(int(np.argmax(seen)), seen.shape)
    node = int(j) if dofs is None else int(dofs[j])
    return Peak(float(seen[i, j]), (float(points[0, node]), float(points[1, node])), float(times[i]))
