"""What a batch of variants came to: states, energies and powers at any time of the drive.

Integrals of exp(-x (theta - sigma)) sigma^j: how a mode that decays answers to heat that is a polynomial of time.
"""

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

Array = NDArray[np.float64]


#: From this decay on the recurrence is stable upwards, below it downwards; so many terms above the wanted ones.
UPWARDS, MORE = 2.0, 10


#: Terms of a power series for a decay up to `UPWARDS`: 2^22 / 22! is less than rounding.
SERIES = 22


def responses(x: Array, theta: Array, count: int) -> tuple[Array, Array]:
    """E = exp(-x theta) and I_j = integral over sigma from 0 to theta of exp(-x (theta - sigma)) sigma^j, j < count.

    dI_j/dtheta = theta^j - x I_j, so z' = -x z + sum_j s_j theta^j has z = E z_0 + sum_j s_j I_j, and the integral of
    I_j is I_{j+1} / (j + 1). I_j = (theta^j - j I_{j-1}) / x is stable upwards for a large x, downwards for small ones.

    Parameters
    ----------
    x : (...,) decay, at least 0. theta : (k,) in [0, 1].

    Returns
    -------
    E (..., k), and I (count, ..., k).

    >>> E, I = responses(np.array([0.0, 2.0]), np.array([1.0]), 2)
    >>> I[:, :, 0].round(6)
    array([[1.      , 0.432332],
           [0.5     , 0.283834]])
    """
    theta = np.broadcast_to(theta, (*x.shape, len(theta)))
    x = np.broadcast_to(x[..., None], theta.shape)
    decay = x * theta
    stiff = decay > UPWARDS
    E, integrals = np.empty(decay.shape), np.empty((count, *decay.shape))
    if stiff.any():
        E[stiff], integrals[:, stiff] = _upwards(x[stiff], decay[stiff], theta[stiff], count)
    calm = ~stiff
    if calm.any():
        E[calm], integrals[:, calm] = _downwards(x[calm], theta[calm], count)
    return E, integrals


def _upwards(x: Array, decay: Array, theta: Array, count: int) -> tuple[Array, Array]:
    E, integrals, power = np.exp(-decay), np.empty((count, len(x))), np.ones_like(theta)
    integrals[0] = (1 - E) / x
    for j in range(1, count):
        power = power * theta
        integrals[j] = (power - j * integrals[j - 1]) / x
    return E, integrals


def _downwards(x: Array, theta: Array, count: int) -> tuple[Array, Array]:
    """From an end that is nearly right; every step damps what is wrong with it."""
    top, integrals = count + MORE, np.empty((count, len(x)))
    powers = [np.ones_like(theta), theta]
    for j in range(2, top + 2):
        powers.append(powers[j // 2] * powers[j - j // 2])
    below = powers[top + 1] / (top + 1 + x * theta)
    for j in range(top, 0, -1):
        below = (powers[j] - x * below) / j
        if j <= count:
            integrals[j - 1] = below
    return 1 - x * integrals[0], integrals


def relaxed(x: Array, start: Array, heat: Array, theta: Array, *, integral: bool = True) -> tuple[Array, Array]:
    """z of z' = -x z + sum_j s_j theta^j at parts of a window, and the integral of z from its start.

    For x above 2 a polynomial P solves the equation and z = P + (z_0 - P(0)) exp(-x theta); below, a power series does.

    Parameters
    ----------
    x : (r,) decay, at least 0. start : (r,) z_0. heat : (r, j) s. theta : (k,) in [0, 1].

    Returns
    -------
    z and, if asked for, its integral (else nothing in its place), (r, k) each.

    >>> z, whole = relaxed(np.array([0.0, 3.0]), np.array([1.0, 1.0]), np.array([[2.0], [3.0]]), np.array([1.0]))
    >>> z[:, 0].round(12), whole[:, 0].round(12)
    (array([3., 1.]), array([2., 1.]))
    """
    z, whole = np.empty((len(x), len(theta))), np.empty((len(x), len(theta) if integral else 0))
    stiff = x > UPWARDS
    for rows, find in ((stiff, _with_decay), (~stiff, _as_series)):
        if rows.any():
            z[rows], whole[rows] = find(x[rows], start[rows], heat[rows], theta, integral)
    return z, whole


def _with_decay(x: Array, start: Array, heat: Array, theta: Array, integral: bool) -> tuple[Array, Array]:
    P = np.empty_like(heat)
    P[:, -1] = heat[:, -1] / x
    for j in range(heat.shape[1] - 2, -1, -1):
        P[:, j] = (heat[:, j] - (j + 1) * P[:, j + 1]) / x
    rest, E = (start - P[:, 0])[:, None], np.exp(-x[:, None] * theta)
    z, whole = _powers(P, theta, integral)
    z += rest * E
    return z, whole + rest * (1 - E) / x[:, None] if integral else whole


def _as_series(x: Array, start: Array, heat: Array, theta: Array, integral: bool) -> tuple[Array, Array]:
    c = np.zeros((len(x), SERIES))
    c[:, 0] = start
    for j in range(SERIES - 1):
        given = heat[:, j] if j < heat.shape[1] else 0.0
        c[:, j + 1] = (given - x * c[:, j]) / (j + 1)
    return _powers(c, theta, integral)


def _powers(c: Array, theta: Array, integral: bool) -> tuple[Array, Array]:
    """A polynomial (r, j), and its integral from 0, if asked for."""
    orders = np.arange(c.shape[1])
    table = theta ** orders[:, None]
    return c @ table, (c / (orders + 1)) @ (table * theta) if integral else np.empty((len(c), 0))


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
        each = np.array([window.energies(np.ones(1), self.batch)[:, :, 0] for window in self.windows])
        return np.concatenate([np.zeros_like(each[:1]), np.cumsum(each, axis=0)])

    @property
    def energy(self) -> Array:
        """(B, n_entries) J over the whole drive."""
        return np.asarray(self._energies[-1])

    def _each(self, times: Array, of_window: Callable[[int, Array], Array]) -> Array:
        """Something (B, ?, k) of all windows, by times (n_times, B, ?); the end of a window belongs to it."""
        starts, lengths = (
            np.array([getattr(window_of, name) for window_of in self.windows]) for name in ("time", "length")
        )
        number = np.maximum(np.searchsorted(starts, times - 1e-9, side="right") - 1, 0)
        part = np.clip((times - starts[number]) / lengths[number], 0.0, 1.0)
        together = [of_window(int(window), part[number == window]) for window in np.unique(number)]
        return np.concatenate(together, axis=2).transpose(2, 0, 1)

    def looked(self, times: Array) -> Array:
        """Times (s) at which peaks are looked for: readings, and points of the windows where those are far apart."""
        nodes = np.concatenate([window.time + NODES[1:] * window.length for window in self.windows])
        apart = np.abs(nodes[:, None] - times).min(axis=1) > FAR * (times[-1] - times[0])
        return np.unique(np.round(np.concatenate([times, nodes[apart]]), 9))

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
        starts = np.array([each.time for each in self.windows])
        window = self.windows[max(int(np.searchsorted(starts, time - 1e-9, side="right")) - 1, 0)]
        low, high = window.inside
        t = min(max(time, low), high)
        batch = self.batch
        q = batch.heat([t], states[:, : batch.model.size, None])[:, :, 0]
        return batch.ledger.powers(window.frozen if window.steady else batch.outside(t), q, states)

    def energy_until(self, time: float) -> Array:
        """(B, n_entries) J from the start to a time: at hand at the ends of windows."""
        ends = np.append([window.time for window in self.windows], self.windows[-1].time + self.windows[-1].length)
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
            powers = np.array([self.powers(float(t), state) for t, state in zip(times, states, strict=True)])
            seen = self.states(self.looked(times))
            self._known[key] = states, self.slopes(times), powers, self.energies(times), seen
        states, slopes, powers, energies, seen = (state[:, variant] for state in self._known[key])
        heat_budget = budget(self.batch.balances[variant], times, states, slopes, powers, energies)
        return history(
            self.batch.balances[variant], times, states, heat_budget, (self.looked(times), seen), len(self.windows)
        )
