"""What a batch of variants came to: states, energies and powers at any time of the drive."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.history import History
from tyrefem.reduced.batch import Batch
from tyrefem.reduced.boundary_data import BoundaryData
from tyrefem.reduced.ledger import budget, history
from tyrefem.reduced.relaxing import relaxed

Array = NDArray[np.float64]
#: Lobatto-Chebyshev points of a window; TO_POWERS @ values at them = coefficients of powers of time.
NODES = (1 - np.cos(np.pi * np.arange(6) / 5)) / 2
#: A peak is looked for within this share of the drive.
FAR = 0.01
TO_POWERS = np.linalg.inv(np.vander(NODES, increasing=True))


@dataclass(frozen=True, eq=False)
class Window:
    """A stretch of time with one polynomial; modes z of the frozen linear part, y = `back` z.

    Parameters
    ----------
    time, length : s. inside : first and last time at which the data of its phase are seen.
    decay : (B, n) 1/s. back : (B, n, n). frozen : what acted when the films were frozen. steady : and acts always.
    start : (B, n) z at its start. heat : (B, n, k) coefficients of powers of time over length. rest : (B, n_entries, k)
        the same of all powers but those of the frozen films. end : (B, n) y.
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
        """(B, n, k) y at parts (k,) of the window."""
        return self.back @ self._modes(part, integral=False)[0]

    def _modes(self, part: Array, *, integral: bool = True) -> tuple[Array, Array]:
        """(B, n, k) z, and, if asked for, its integral from the window's start over the window's length."""
        B, n, count = self.heat.shape
        heat = self.length * self.heat.reshape(B * n, count)
        decay, start = self.length * self.decay.reshape(-1), self.start.reshape(-1)
        z, whole = relaxed(decay, start, heat, part, integral=integral)
        return z.reshape(B, n, len(part)), whole.reshape(B, n, -1 if integral else 0)

    def slopes(self, part: Array) -> Array:
        """(B, n, k) dy/dt."""
        heat = self.heat @ np.vander(part, self.heat.shape[2], increasing=True).T
        return self.back @ (heat - self.decay[:, :, None] * self._modes(part, integral=False)[0])

    def energies(self, part: Array, batch: Batch) -> Array:
        """(B, n_entries, k) J since the window's start."""
        h, orders = self.length, np.arange(1, self.rest.shape[2] + 1)
        given = h * (self.rest @ (part ** orders[:, None] / orders[:, None]))
        return given + batch.ledger.frozen(self.frozen.films, self.back @ (h * self._modes(part)[1]))


@dataclass(frozen=True, eq=False)
class Marched:
    """A batch that was marched.

    Parameters
    ----------
    windows : all of them. last : (B, n) at the end.
    """

    batch: Batch
    windows: Sequence[Window]
    last: Array

    @functools.cached_property
    def _energies(self) -> Array:
        """(n_windows + 1, B, n_entries) J from the start to the start of every window, and to the end."""
        each = np.array([one.energies(np.ones(1), self.batch)[:, :, 0] for one in self.windows])
        return np.concatenate([np.zeros_like(each[:1]), np.cumsum(each, axis=0)])

    @property
    def energy(self) -> Array:
        """(B, n_entries) J over the whole drive."""
        return np.asarray(self._energies[-1])

    def _each(self, times: Array, found: Callable[[int, Array], Array]) -> Array:
        """Something (B, ?, k) of all windows, by times (n_times, B, ?); the end of a window belongs to it."""
        starts, lengths = (np.array([getattr(one, name) for one in self.windows]) for name in ("time", "length"))
        number = np.maximum(np.searchsorted(starts, times - 1e-9, side="right") - 1, 0)
        part = np.clip((times - starts[number]) / lengths[number], 0.0, 1.0)
        together = [found(int(window), part[number == window]) for window in np.unique(number)]
        return np.concatenate(together, axis=2).transpose(2, 0, 1)

    def looked(self, times: Array) -> Array:
        """Times (s) at which peaks are looked for: readings, and points of the windows where those are far apart."""
        own = np.concatenate([one.time + NODES[1:] * one.length for one in self.windows])
        apart = np.abs(own[:, None] - times).min(axis=1) > FAR * (times[-1] - times[0])
        return np.unique(np.round(np.concatenate([times, own[apart]]), 9))

    def states(self, times: Array) -> Array:
        """(n_times, B, n) at increasing times: modes, then reservoirs."""
        return self._each(times, lambda number, part: self.windows[number].states(part))

    def slopes(self, times: Array) -> Array:
        """(n_times, B, n) 1/s."""
        return self._each(times, lambda number, part: self.windows[number].slopes(part))

    def energies(self, times: Array) -> Array:
        """(n_times, B, n_entries) J from the start."""
        before = self._energies

        def since(number: int, part: Array) -> Array:
            return before[number][:, :, None] + self.windows[number].energies(part, self.batch)

        return self._each(times, since)

    def powers(self, time: float, states: Array) -> Array:
        """(B, n_entries) W at a time and its states (B, n); a phase's end belongs to it."""
        starts = np.array([one.time for one in self.windows])
        window = self.windows[max(int(np.searchsorted(starts, time - 1e-9, side="right")) - 1, 0)]
        low, high = window.inside
        t = min(max(time, low), high)
        batch = self.batch
        q = batch.heat([t], states[:, : batch.model.size, None])[:, :, 0]
        return batch.ledger.powers(window.frozen if window.steady else batch.outside(t), q, states)

    def energy_until(self, time: float) -> Array:
        """(B, n_entries) J from the start to a time: at hand at the ends of windows."""
        ends = np.append([one.time for one in self.windows], self.windows[-1].time + self.windows[-1].length)
        nearest = int(np.argmin(np.abs(ends - time)))
        if abs(ends[nearest] - time) < 1e-9:
            return np.asarray(self._energies[nearest])
        return self.energies(np.array([time]))[0]

    @functools.cached_property
    def _known(self) -> dict[bytes, tuple[Array, ...]]:
        return {}

    def history(self, variant: int, times: Array) -> History:
        """The history of one variant at times (s) of its drive, as the full model gives it."""
        key = times.tobytes()
        if key not in self._known:
            self._known.clear()
            states = self.states(times)
            powers = np.array([self.powers(float(t), one) for t, one in zip(times, states, strict=True)])
            seen = self.states(self.looked(times))
            self._known[key] = states, self.slopes(times), powers, self.energies(times), seen
        states, slopes, powers, energies, seen = (one[:, variant] for one in self._known[key])
        found = budget(self.batch.balances[variant], times, states, slopes, powers, energies)
        return history(
            self.batch.balances[variant], times, states, found, (self.looked(times), seen), len(self.windows)
        )
