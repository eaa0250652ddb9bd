"""Solution of a batch of variants: states, energies and powers at any time of the drive."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.field import History
from tyrefem.reduced.batch import Batch
from tyrefem.reduced.boundary_data import BoundaryData
from tyrefem.reduced.budget import budget, history
from tyrefem.reduced.exponential import relaxed

Array = NDArray[np.float64]
#: Lobatto-Chebyshev points of a window; TO_POWERS @ values at them = coefficients of powers of time.
NODES = (1 - np.cos(np.pi * np.arange(6) / 5)) / 2


#: Peaks are searched at times no further apart than this share of the drive.
PEAK_SPACING = 0.01
TO_POWERS = np.linalg.inv(np.vander(NODES, increasing=True))


@dataclass(frozen=True, eq=False)
class Window:
    """A time window in which the heat is one polynomial of time; z: eigenmodes of the frozen part, y = `back` z.

    Parameters
    ----------
    time, length : start and length, s. inside : first and last time within its phase, s.
    decay : (B, n) 1/s. back : (B, n, n) eigenvectors. frozen : boundary data whose films are frozen. steady : whether
        these data hold for the whole phase.
    start : (B, n) z at the window's start. heat : (B, n, k) coefficients of powers of time / length.
    rest : (B, n_entries, k) coefficients of all heat flows except those of the frozen films. end : (B, n) final y.
    """

    time: float
    length: float
    inside: tuple[float, float]
    decay: Array
    back: Array
    frozen: BoundaryData
    steady: bool
    start: Array
    heat: Array
    rest: Array
    end: Array

    def states(self, part: Array) -> Array:
        """States y, (B, n, k), at parts (k,) of the window."""
        return self.back @ self._modes(part, integral=False)[0]

    def _modes(self, part: Array, *, integral: bool = True) -> tuple[Array, Array]:
        """z, (B, n, k), and with ``integral`` its integral from the window's start over the window's length."""
        B, n, count = self.heat.shape
        heat = self.length * self.heat.reshape(B * n, count)
        decay, start = self.length * self.decay.reshape(-1), self.start.reshape(-1)
        z, whole = relaxed(decay, start, heat, part, integral=integral)
        return z.reshape(B, n, len(part)), whole.reshape(B, n, -1 if integral else 0)

    def slopes(self, part: Array) -> Array:
        """Rates dy/dt, (B, n, k) K/s."""
        return self.states_and_slopes(part)[:, self.back.shape[1] :]

    def states_and_slopes(self, part: Array) -> Array:
        """States, then their rates, (B, 2 n, k)."""
        z = self._modes(part, integral=False)[0]
        rates = self.heat @ np.vander(part, self.heat.shape[2], increasing=True).T
        rates -= self.decay[:, :, None] * z
        y = self.back @ np.concatenate([z, rates], axis=2)
        return np.concatenate([y[:, :, : len(part)], y[:, :, len(part) :]], axis=1)

    def energies(self, part: Array, batch: Batch) -> Array:
        """Energies since the window's start, (B, n_entries, k) J."""
        h, orders = self.length, np.arange(1, self.rest.shape[2] + 1)
        given = h * (self.rest @ (part ** orders[:, None] / orders[:, None]))
        return given + batch.heat_flows.frozen(self.frozen.films, self.back @ (h * self._modes(part)[1]))


@dataclass(frozen=True, eq=False)
class BatchSolution:
    """Solution of a batch over the whole drive.

    Parameters
    ----------
    windows : time windows, in order. last : (B, n) states at the end.
    """

    batch: Batch
    windows: Sequence[Window]
    last: Array

    @functools.cached_property
    def _energies(self) -> Array:
        """Energies from the start to the start of every window and to the end, (n_windows + 1, B, n_entries) J."""
        each = np.array([window.energies(np.ones(1), self.batch)[:, :, 0] for window in self.windows])
        return np.concatenate([np.zeros_like(each[:1]), np.cumsum(each, axis=0)])

    @property
    def energy(self) -> Array:
        """Energies over the whole drive, (B, n_entries) J."""
        return np.asarray(self._energies[-1])

    def _by_window(self, times: Array, of_window: Callable[[int, Array], Array]) -> Array:
        """Values (B, ?, k) of the windows at times, (n_times, B, ?); the end of a window belongs to that window."""
        starts, lengths = (
            np.array([getattr(window_of, name) for window_of in self.windows]) for name in ("time", "length")
        )
        number = np.maximum(np.searchsorted(starts, times - 1e-9, side="right") - 1, 0)
        part = np.clip((times - starts[number]) / lengths[number], 0.0, 1.0)
        together = [of_window(int(window), part[number == window]) for window in np.unique(number)]
        return np.concatenate(together, axis=2).transpose(2, 0, 1)

    def peak_times(self, times: Array) -> Array:
        """Times (s) at which peaks are searched: those of the readings, and window points between distant readings."""
        nodes = np.concatenate([window.time + NODES[1:] * window.length for window in self.windows])
        apart = np.abs(nodes[:, None] - times).min(axis=1) > PEAK_SPACING * (times[-1] - times[0])
        return np.unique(np.round(np.concatenate([times, nodes[apart]]), 9))

    def states(self, times: Array) -> Array:
        """States at increasing times, (n_times, B, n): modes, then reservoirs."""
        return self._by_window(times, lambda number, part: self.windows[number].states(part))

    def slopes(self, times: Array) -> Array:
        """Rates of the states, (n_times, B, n) 1/s."""
        return self._by_window(times, lambda number, part: self.windows[number].slopes(part))

    def states_and_slopes(self, times: Array) -> tuple[Array, Array]:
        """States and their rates at increasing times, (n_times, B, n) each."""
        both = self._by_window(times, lambda number, part: self.windows[number].states_and_slopes(part))
        n = self.last.shape[1]
        return both[:, :, :n], both[:, :, n:]

    def window_at(self, time: float) -> Window:
        """The window of a time; the end of a window belongs to that window."""
        starts = np.array([each.time for each in self.windows])
        return self.windows[max(int(np.searchsorted(starts, time - 1e-9, side="right")) - 1, 0)]

    def energies(self, times: Array) -> Array:
        """Energies from the start, (n_times, B, n_entries) J."""
        before = self._energies

        def since(number: int, part: Array) -> Array:
            return before[number][:, :, None] + self.windows[number].energies(part, self.batch)

        return self._by_window(times, since)

    def powers(self, time: float, states: Array) -> Array:
        """Heat flows at a time with states (B, n), (B, n_entries) W; the end of a phase belongs to that phase."""
        window = self.window_at(time)
        low, high = window.inside
        t = min(max(time, low), high)
        batch = self.batch
        q = batch.heat([t], states[:, : batch.model.size, None])[:, :, 0]
        return batch.heat_flows.powers(window.frozen if window.steady else batch.boundary_data(t), q, states)

    def energy_until(self, time: float) -> Array:
        """Energies from the start to a time, (B, n_entries) J; at the ends of windows they are already known."""
        ends = np.append([window.time for window in self.windows], self.windows[-1].time + self.windows[-1].length)
        nearest = int(np.argmin(np.abs(ends - time)))
        if abs(ends[nearest] - time) < 1e-9:
            return np.asarray(self._energies[nearest])
        return self.energies(np.array([time]))[0]

    @functools.cached_property
    def _by_times(self) -> dict[bytes, tuple[Array, ...]]:
        return {}

    def history(self, variant: int, times: Array) -> History:
        """The history of a variant at times (s) of its drive, in the format of the full model."""
        key = times.tobytes()
        if key not in self._by_times:
            self._by_times.clear()
            states = self.states(times)
            powers = np.array([self.powers(float(t), state) for t, state in zip(times, states, strict=True)])
            peak_states = self.states(self.peak_times(times))
            self._by_times[key] = states, self.slopes(times), powers, self.energies(times), peak_states
        states, slopes, powers, energies, peak_states = (array[:, variant] for array in self._by_times[key])
        heat_budget = budget(self.batch.balances[variant], times, states, slopes, powers, energies)
        return history(
            self.batch.balances[variant],
            times,
            states,
            heat_budget,
            (self.peak_times(times), peak_states),
            len(self.windows),
        )
