"""The heat budget of reduced variants, and their history as the full model gives it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.budget import Tally
from tyrefem.conduction.history import History, Peak, Steps
from tyrefem.reduced.model import ReducedBalance

if TYPE_CHECKING:
    from tyrefem.reduced.batch import Moment

Array = NDArray[np.float64]


class Ledger:
    """Powers by zone, by film, by exchange and power of reservoirs."""

    def __init__(self, balance: ReducedBalance) -> None:
        self.b = balance
        model = balance.model
        self.rows = np.zeros((len(balance.exchanges), len(balance.start)))
        self.areas = np.zeros(len(balance.exchanges))
        self.given = np.array([one[1] is not None for one in balance.exchanges])
        names, m = list(balance.reservoirs), model.size
        for j, (side, _, film) in enumerate(balance.films):
            _, r, area = model.surfaces[side]
            self.rows[j, :m], self.areas[j] = -r, area
            if isinstance(film.sink, str):
                self.rows[j, m + names.index(film.sink)] = area
        j = len(balance.films)
        for i, name in enumerate(names):
            for _, other in balance.reservoirs[name].exchanges:
                self.rows[j, m + i], self.areas[j] = -1.0, 1.0
                if isinstance(other, str):
                    self.rows[j, m + names.index(other)] = 1.0
                j += 1

    @property
    def width(self) -> int:
        """Number of entries."""
        return len(self.b.model.zones) + len(self.b.exchanges) + len(self.b.reservoirs)

    def powers(self, moment: Moment, q: Array, y: Array) -> Array:
        """(B, width) W of sources q (B, n_samples) and states y (B, n)."""
        exchanged = moment.films * (y @ self.rows.T + np.where(self.given, moment.sinks * self.areas, 0.0))
        return np.concatenate([q @ self.b.model.power.T, exchanged, moment.powers], axis=1)

    def entries(self) -> list[tuple[str, str, int]]:
        names = list(self.b.reservoirs)
        found = [("source", zone, 0) for zone in self.b.model.zones]
        found += [("boundary", side, number) for side, number, _ in self.b.films]
        found += [("reservoir", name, i) for name in names for i, _ in enumerate(self.b.reservoirs[name].exchanges)]
        return found + [("reservoir", name, -1) for name in names]


def history(
    balance: ReducedBalance,
    times: Array,
    states: Array,
    slopes: Array,
    records: Array,
    energies: Array,
    steps: int,
) -> History:
    """The history of states (n_times, n) at times (s)."""
    model, m, names = balance.model, balance.model.size, list(balance.reservoirs)
    ops = model.operators
    values = states[:, :m] @ model.V.T
    capacity = {region: balance.bodies[region][2] * model.stored_row[region] for region in balance.bodies}
    rows = np.array(list(capacity.values()))
    stored = (states[:, :m] - states[0, :m]) @ rows.T
    storing = slopes[:, :m] @ rows.T
    heat = np.array([float(one.heat_capacity) for one in balance.reservoirs.values()])  # type: ignore[arg-type]
    held = (states[:, m:] - states[0, m:]) * heat
    into = {(side, number): film.sink for side, number, film in balance.films if isinstance(film.sink, str)}
    between: dict[tuple[str, int], tuple[str, str | None]] = {(name, -1): (name, None) for name in names}
    for name in names:
        for i, (_, other) in enumerate(balance.reservoirs[name].exchanges):
            between[name, i] = (name, other if isinstance(other, str) else None)
    tally = Tally(Ledger(balance).entries(), list(balance.bodies), names, into, between)
    for i in range(len(times)):
        tally.record(energies[i], records[i], stored[i], storing[i], held[i])
    return History(
        operators=ops,
        materials=balance.tyre.bodies,
        times=times,
        values=values,
        reservoirs={name: states[:, m + i] for i, name in enumerate(names)},
        budget=tally.budget(times),
        maximum=_peak(ops.points, times, values, None),
        region_maximum={region: _peak(ops.points, times, values, ops.dofs(region)) for region in balance.bodies},
        steps=Steps(steps, 0, 0, 2 * steps),
    )


def _peak(points: Array, times: Array, values: Array, dofs: Array | None) -> Peak:
    own = values if dofs is None else values[:, dofs]
    i, j = np.unravel_index(int(np.argmax(own)), own.shape)
    node = int(j) if dofs is None else int(dofs[j])
    return Peak(float(own[i, j]), (float(points[0, node]), float(points[1, node])), float(times[i]))
