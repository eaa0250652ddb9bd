"""Heat sources of many variants at the sample nodes: strain energy x revolutions x a table of tan delta, effects."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tyrefem.reduced.balance import ReducedBalance
from tyrefem.reduced.heat_change import HeatChange
from tyrefem.reduced.learnt_cycles import NodeEnergies
from tyrefem.reduced.shared_product import shared_product

Array = NDArray[np.float64]
#: Range of the table of tan delta, degC, and its spacing, K.
COLD, HOT, FINE = -60.0, 400.0, 0.25
LOSS_GRID = np.arange(COLD, HOT + FINE / 2, FINE)


def has_tabulated_loss(balance: ReducedBalance) -> bool:
    """Is tan delta independent of frequency in all zones?"""
    return balance.known is not None or all(
        source.over_frequency is None for source in balance.tyre.hysteresis.values()
    )


class SampledHeat:
    """Heat sources at the sample nodes of variants whose drives have the same phases and load-case times.

    The strain cycle's heat comes from tables, for all variants together; effects then change it: (base + addends) x
    factors. A variant is evaluated alone if its tan delta depends on frequency.
    """

    def __init__(self, balances: Sequence[ReducedBalance]) -> None:
        self.balances = balances
        self.rows = [row for row, balance in enumerate(balances) if has_tabulated_loss(balance)]
        self.others = [row for row in range(len(balances)) if row not in self.rows]
        tabulated = [balances[row] for row in self.rows]
        self.tabulated = TabulatedHeat(tabulated) if tabulated else None
        # Learnt inputs are those of variants whose heat no effect changes.
        studied = ((place, balance) for place, balance in enumerate(tabulated) if balance.known is None)
        changes = ((place, HeatChange(balance)) for place, balance in studied)
        self.changes = [(place, change) for place, change in changes if change.acts]

    def __call__(self, times: Sequence[float], a: Array) -> Array:
        """(B, n_samples, k) sources of modes a (B, m, k) at times of one phase, seen from inside it."""
        if self.tabulated is not None and not self.others:
            return self._of_tables(self.tabulated, times, a)
        heat = np.empty((len(a), len(self.balances[0].model.at_samples), a.shape[2]))
        if self.tabulated is not None:
            heat[self.rows] = self._of_tables(self.tabulated, times, a[self.rows])
        for row in self.others:
            for column, t in enumerate(times):
                heat[row, :, column] = self.balances[row].source(t, a[row, :, column])
        return heat

    def _of_tables(self, tabulated: TabulatedHeat, times: Sequence[float], a: Array) -> Array:
        heat = tabulated(times, a)
        for place, change in self.changes:
            change.apply(heat[place], times, a[place])
        return heat


class TabulatedHeat:
    """Heat sources of plain variants: strain energies are computed once, tan delta comes from a table."""

    def __init__(self, balances: Sequence[ReducedBalance]) -> None:
        self.balances, self.model = balances, balances[0].model
        self.width = len(LOSS_GRID)
        zones = self.model.zones
        tables = np.zeros((len(balances), len(zones), self.width))
        kept: dict[int, Array] = {}
        for table, each in zip(tables, balances, strict=True):
            for row, zone in zip(table, zones, strict=True):
                if each.known is not None:
                    row[:] = each.known[f"loss {zone}"]
                    continue
                law = each.tyre.hysteresis[zone].loss_tangent
                if id(law) not in kept:
                    kept[id(law)] = law(LOSS_GRID)
                row[:] = kept[id(law)]
        self.table = tables.reshape(-1)
        sizes = [part.stop - part.start for part in self.model.sample_slices.values()]
        zone_of = np.repeat(np.arange(len(sizes)), sizes)
        #: Where the table of a variant and a sample's zone begins, (n_samples, B, 1).
        first = (np.arange(len(balances)) * len(sizes) + zone_of[:, None]) * self.width
        self.first = first.astype(np.int32)[:, :, None]
        self._phase_number = -1

    def __call__(self, times: Sequence[float], a: Array) -> Array:
        """(B, n_samples, k) sources of modes a (B, m, k) at times of one phase, seen from inside it."""
        losses = self._losses(times)
        if losses is None:
            return np.zeros((len(a), len(self.model.at_samples), a.shape[2]))
        # By sample, then variant: products with the matrices of all variants are large ones.
        place = shared_product(self.model.at_samples[None], a).transpose(1, 0, 2)
        place -= COLD
        place /= FINE
        np.clip(place, 0.0, self.width - 1.000001, out=place)
        left = place.astype(np.int32)
        place -= left
        left += self.first
        below = self.table.take(left)
        left += 1
        place *= self.table.take(left) - below
        place += below
        place *= losses
        return place.transpose(1, 0, 2)

    def _losses(self, times: Sequence[float]) -> Array | None:
        """Energy lost per revolution x revolutions per second, (n_samples, B, 1 or k) W/m3 per unit of tan delta.

        None: all tyres stand still.
        """
        drive, schedule = self.balances[0].alike.drive, self.balances[0].alike.schedule
        phase, _ = drive.locate(times[0])
        if self._phase_number != phase:
            self._phase_number = phase
            self._energies = np.array([sampled_energies(balance, phase) for balance in self.balances])
            same = all(_same_speed(balance, phase) for balance in self.balances)
            self._steady = same and self._energies.shape[1] == 1
            self._losses_by_times: dict[tuple[float, ...], Array] = {}
        if self._steady:
            times = times[:1]
        key = () if self._steady else tuple(times)
        if key not in self._losses_by_times:
            if len(self._losses_by_times) > 4:
                self._losses_by_times.clear()
            rates = np.array([_rates(balance, phase, times) for balance in self.balances])
            shares = np.zeros((self._energies.shape[1], len(times)))
            for column, t in enumerate(times):
                for _, knot, weight in schedule.weights(t):
                    shares[knot, column] = weight
            losses = rates[:, None, :] * np.tensordot(self._energies, shares, axes=(1, 0))
            self._losses_by_times[key] = np.ascontiguousarray(losses.transpose(1, 0, 2))
        losses = self._losses_by_times[key]
        return losses if losses.any() else None


def _same_speed(balance: ReducedBalance, phase: int) -> bool:
    return balance.alike.drive.phases[phase].steady_motion


def _rates(balance: ReducedBalance, phase: int, times: Sequence[float]) -> list[float]:
    """Revolutions per second at times of a phase."""
    if balance.known is not None:
        return [float(balance.known[f"rate {phase}"])] * len(times)
    return [balance.tyre.motion(t).revolutions_per_second for t in times]


def sampled_energies(balance: ReducedBalance, phase: int) -> Array:
    """Energy lost per revolution and unit of tan delta, (n_knots, n_samples) J/m3."""
    if balance.known is not None:
        return balance.known[f"energies {phase}"]
    tyre, model = balance.tyre, balance.model
    energies = np.zeros((len(tyre.schedule.knots[phase]), model.at_samples.shape[0]))
    if tyre.drive.phases[phase].stands:
        return energies
    for row, cycle in zip(energies, tyre.schedule.cycles[phase], strict=True):
        for zone, part in model.sample_slices.items():
            if part.start == part.stop:
                continue
            lost = tyre.hysteresis[zone].lost_per_revolution
            if isinstance(cycle, NodeEnergies):
                row[part] = lost * cycle.at_nodes(zone, model.samples[zone])
            else:
                row[part] = lost * cycle.energy_density(zone, model.sample_points[zone])
    return energies
