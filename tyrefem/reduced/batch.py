"""Many variants marched side by side: the same steps, stacked matrices, heat sources from tables."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.history import History
from tyrefem.drive import Ramp
from tyrefem.heating import HeatSource
from tyrefem.reduced.ledger import Ledger, history
from tyrefem.reduced.model import ReducedBalance, ReducedModel

Array = NDArray[np.float64]
#: ROS2 (Verwer et al. 1999): second order with any matrix in place of the Jacobian; L-stable with this coefficient.
GAMMA = 1 - 1 / np.sqrt(2)
#: Steps after every start of a phase: so many of each length (s), then the longest.
EARLY = ((0.25, 4), (1.0, 4), (2.5, 2))
LONGEST = 5.0
#: Temperatures, degC, between which tan delta is tabulated, every 0.25 K.
COLD, HOT, FINE = -60.0, 400.0, 0.25


@dataclass(frozen=True, eq=False)
class Batch:
    """Variants whose drives have the same phases in time, on the same modes.

    Parameters
    ----------
    model : the modes. balances : one per variant, at least one.
    """

    model: ReducedModel
    balances: Sequence[ReducedBalance]

    @functools.cached_property
    def ends(self) -> Array:
        """(n_ends,) s: start and ends of all steps."""
        drive = self.balances[0].tyre.drive
        return steps(drive.starts, drive.end)

    @functools.cached_property
    def steady(self) -> bool:
        """Is everything that acts from outside constant within every phase?"""
        return all(_steady(one) for one in self.balances)

    def march(self) -> Marched:
        """States and powers at the ends of all steps."""
        m, model, ends = self.model.size, self.model, self.ends
        M, K = np.stack([one.M for one in self.balances]), np.stack([one.K for one in self.balances])
        stack, loads = self.balances[0].stack, self.balances[0].loads
        y = np.stack([one.start for one in self.balances])
        source, ledger = _Sources(self), Ledger(self.balances[0])
        outside = _Outside(self)
        states = np.zeros((len(ends), *y.shape))
        powers = np.zeros((len(ends), 2, len(y), ledger.width))
        inverses: dict[tuple[float, int], Array] = {}

        def rate(state: Array, moment: Moment, q: Array) -> Array:
            heat = moment.constant - _times(moment.matrix, state)
            heat[:, :m] += q @ model.load.T
            return heat

        def moment_at(t: float) -> Moment:
            return outside.at(t, lambda films: K + np.tensordot(films, stack, axes=1), loads)

        states[0] = y
        for number, (t, end) in enumerate(pairwise(ends)):
            h = end - t
            # Data are seen from inside the step: a jump at its end belongs to the next one.
            now, then = moment_at(t + (1e-9 * max(1.0, t) if number else 0.0)), moment_at(end - 1e-9 * max(1.0, end))
            key = round(h, 9), id(now)
            if key not in inverses:
                if len(inverses) > 8:
                    inverses.clear()
                inverses[key] = np.linalg.inv(M + GAMMA * h * now.matrix)
            q = source(now.time, y[:, :m])
            powers[number, 1] = ledger.powers(now, q, y)
            k1 = _times(inverses[key], rate(y, now, q))
            guess = y + h * k1
            q = source(then.time, guess[:, :m])
            k2 = _times(inverses[key], rate(guess, then, q) - 2 * _times(M, k1))
            y = y + h * (1.5 * k1 + 0.5 * k2)
            states[number + 1] = y
            # The predicted state's sources differ from the final one's by the square of the step.
            powers[number + 1, 0] = ledger.powers(then, source(then.time, y[:, :m]), y)
        powers[0, 0], powers[-1, 1] = powers[0, 1], powers[-1, 0]
        return Marched(self, states, powers)


@dataclass(frozen=True, eq=False)
class Moment:
    """What acts from outside at a time: films, sinks (B, n_exchanges), powers into reservoirs (B, n_reservoirs), all
    constant heat (B, n), K + sum h R (B, n, n)."""

    time: float
    films: Array
    sinks: Array
    powers: Array
    constant: Array
    matrix: Array


class _Outside:
    """Moments, once per phase where they do not change within it."""

    def __init__(self, batch: Batch) -> None:
        self.batch, self._known = batch, {}  # type: tuple[Batch, dict[float, Moment]]

    def at(self, t: float, matrix: Callable[[Array], Array], loads: Array) -> Moment:
        drive = self.batch.balances[0].tyre.drive
        key = float(drive.locate(t)[0]) if self.batch.steady else t
        if key not in self._known:
            if not self.batch.steady and len(self._known) > 4:
                self._known.clear()
            pairs = [one.coefficients(t) for one in self.batch.balances]
            films, sinks = (np.array(each) for each in zip(*pairs, strict=True))
            powers = np.array([one.powers(t) for one in self.batch.balances]).reshape(len(films), -1)
            constant = (films * sinks) @ loads
            constant[:, self.batch.model.size :] += powers
            self._known[key] = Moment(t, films, sinks, powers, constant, matrix(films))
        return self._known[key]


@dataclass(frozen=True, eq=False)
class Marched:
    """What a batch came to.

    Parameters
    ----------
    states : (n_ends, B, n): modes, then reservoirs. powers : (n_ends, 2, B, n_entries) W just before and just after.
    """

    batch: Batch
    states: Array
    powers: Array

    @functools.cached_property
    def energies(self) -> Array:
        """(n_ends, B, n_entries) J since the start: trapezoids."""
        h = np.diff(self.batch.ends)[:, None, None]
        each = h * (self.powers[:-1, 1] + self.powers[1:, 0]) / 2
        return np.concatenate([np.zeros_like(each[:1]), np.cumsum(each, axis=0)])

    def history(self, variant: int, times: Array) -> History:
        """The history of one variant at times (s) of its drive: cubic within the phases."""
        balance = self.batch.balances[variant]
        starts = balance.tyre.drive.starts
        width = self.states.shape[2]
        together = np.concatenate(
            [self.states[:, variant], self.powers[:, 0, variant], self.energies[:, variant]], axis=1
        )
        dense = phase_wise(self.batch.ends, together, starts, times)
        entries = self.powers.shape[3]
        states, powers, energies = np.split(dense, [width, width + entries], axis=1)
        slopes = np.gradient(states, times, axis=0)
        return history(balance, times, states, slopes, powers, energies, len(self.batch.ends) - 1)


def phase_wise(ends: Array, values: Array, starts: Sequence[float], times: Array) -> Array:
    """Values (n_ends, k) at other times: cubic splines, each within its phase; a start belongs to the phase before."""
    from scipy.interpolate import CubicSpline

    found = np.empty((len(times), values.shape[1]))
    for start, stop in pairwise([*starts, ends[-1]]):
        own = (ends >= start - 1e-9) & (ends <= stop + 1e-9)
        inside = (times >= start - 1e-9) & (times <= stop + 1e-9) & ((times > start + 1e-9) | (start <= starts[0]))
        if inside.any():
            found[inside] = CubicSpline(ends[own], values[own], axis=0)(times[inside])
    return found


def _steady(balance: ReducedBalance) -> bool:
    tyre = balance.tyre
    if tyre.study.effects or any(len(knots) > 1 for knots in tyre.schedule.knots):
        return False
    ramps = [value for phase in tyre.drive.phases for _, value in phase if isinstance(value, Ramp)]
    return all(ramp.constant for ramp in ramps)


def steps(starts: Sequence[float], end: float) -> Array:
    """Ends of the steps: few different lengths, so that few matrices are inverted."""
    found = [0.0]
    for start, stop in pairwise([*starts, end]):
        t = start
        for length, count in EARLY:
            for _ in range(count):
                if t + length < stop - 1e-9:
                    t += length
                    found.append(t)
        parts = max(int(np.ceil((stop - t) / LONGEST - 1e-9)), 1)
        found += [t + (stop - t) * (k + 1) / parts for k in range(parts)]
    return np.array(found)


def _times(matrices: Array, vectors: Array) -> Array:
    return np.asarray((matrices @ vectors[:, :, None])[:, :, 0])


class _Sources:
    """(B, n_samples) W/m3 of all variants at the samples: strain energy x rate x a table of tan delta.

    Where effects act on the heat, variant by variant.
    """

    def __init__(self, batch: Batch) -> None:
        self.batch, self.model = batch, batch.model
        self.plain = all(type(one) is HeatSource for each in batch.balances for one in each.tyre.sources.values())
        if not self.plain:
            return
        grid = np.arange(COLD, HOT + FINE / 2, FINE)
        self.last = len(grid) - 2
        self.tables = np.zeros((len(batch.balances), len(self.model.zones), len(grid)))
        kept: dict[int, Array] = {}
        for table, each in zip(self.tables, batch.balances, strict=True):
            for row, zone in zip(table, self.model.zones, strict=True):
                law = each.tyre.sources[zone].loss_tangent  # type: ignore[union-attr]
                if id(law) not in kept:
                    kept[id(law)] = law(grid)
                row[:] = kept[id(law)]
        sizes = [part.stop - part.start for part in self.model.sample_slices.values()]
        self.zone_of = np.repeat(np.arange(len(sizes)), sizes)
        self.rows = np.arange(len(batch.balances))[:, None]
        self._known: dict[float, Array] = {}

    def __call__(self, t: float, a: Array) -> Array:
        if not self.plain:
            return np.stack([one.source(t, row) for one, row in zip(self.batch.balances, a, strict=True)])
        T = a @ self.model.at_samples.T
        place = np.clip((T - COLD) / FINE, 0.0, self.last + 0.999999)
        left = place.astype(int)
        below, above = (self.tables[self.rows, self.zone_of, left + k] for k in (0, 1))
        return np.asarray(self._energy(t) * (below + (place - left) * (above - below)))

    def _energy(self, t: float) -> Array:
        """Strain energy x revolution rate x convention, (B, n_samples): W/m3 per unit of tan delta."""
        steady = self.batch.steady
        key = float(self.batch.balances[0].tyre.drive.locate(t)[0]) if steady else t
        if key not in self._known:
            if not steady and len(self._known) > 4:
                self._known.clear()
            found = np.zeros((len(self.batch.balances), len(self.zone_of)))
            for row, one in zip(found, self.batch.balances, strict=True):
                for zone, part in self.model.sample_slices.items():
                    source = one.tyre.sources[zone]
                    rate = source.loss_factor * source.schedule.revolution_rate(t)  # type: ignore[union-attr]
                    row[part] = rate * source.energy_density(self.model.sample_points[zone], t)  # type: ignore[union-attr]
            self._known[key] = found
        return self._known[key]
