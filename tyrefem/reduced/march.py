"""Time integration of a batch: exact decay of every mode, heat collocated in time, one window for all variants."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dsygvd

from tyrefem.errors import InputError
from tyrefem.reduced.batch import Batch, steady
from tyrefem.reduced.boundary_data import BoundaryData
from tyrefem.reduced.exponential import NODES, TO_POWERS, Marched, Window, responses

Array = NDArray[np.float64]
#: First windows of a phase as a share of it; how much a window may grow or shrink from one to the next.
FIRST, GROWTH, SHRINK = 0.05, 5.0, 0.3
#: Sweeps of a window before it is cut; a sweep that changes less than this share of the tolerance is the last.
SWEEPS, SETTLED = 14, 0.05
#: A window's films may differ by this much from its frozen ones where they change.
STALE = 0.2
#: Shortest window over the phase.
SHORTEST = 1e-9


def march(batch: Batch) -> Marched:
    """Integrate all phases of the drive that the variants of a batch share.

    Raises
    ------
    InputError : the windows vanish.
    """
    drive, y = batch.balances[0].tyre.drive, np.stack([each.start for each in batch.balances])
    windows: list[Window] = []
    knots = batch.balances[0].tyre.schedule.knots
    for number, (start, end) in enumerate(pairwise([*drive.starts, drive.end])):
        # Between load cases the heat is linear in time: no window may reach over one.
        kinks = [start + (end - start) * share for share in knots[number] if 0 < share < 1]
        for first, last in pairwise([start, *kinks, end]):
            phase = _MarchedPhase(batch, number, first, last, y)
            windows += phase.run()
            y = phase.y
    return Marched(batch, windows, y)


class _MarchedPhase:
    """One phase: data are seen from inside, steady ones only once."""

    def __init__(self, batch: Batch, number: int, start: float, end: float, y: Array) -> None:
        inside = max(1e-10 * (end - start), 4 * np.spacing(max(abs(start), abs(end))))
        self.batch, self.start, self.end, self.y = batch, start, end, y
        self.low, self.high = start + inside, end - inside
        self.steady = all(steady(balance, number) for balance in batch.balances)
        self._freeze(batch.outside(self.low))

    def _freeze(self, moment: BoundaryData) -> None:
        """Take the exchanges of a moment as the linear part, and find its modes."""
        # How long the window before was, and how fast its heat into the modes changed at its end.
        self.going: tuple[float, Array] | None = None
        self.M, K = self.batch.matrices
        self.frozen = moment
        A = K + np.tensordot(moment.films, self.batch.balances[0].stack, axes=1)
        self.decay, self.into = np.empty(A.shape[:2]), np.empty_like(A)
        for b in range(len(A)):
            decay, back, failed = dsygvd(A[b], self.M[b])
            if failed:
                raise np.linalg.LinAlgError("heat capacity that is not positive definite")
            self.decay[b], self.into[b] = np.maximum(decay, 0.0), back.T
        self.back = np.ascontiguousarray(self.into.transpose(0, 2, 1))

    def run(self) -> list[Window]:
        """Windows with error control; the largest error over all variants counts."""
        span, t, windows = self.end - self.start, self.start, []
        h = FIRST * span
        while t < self.end:
            left = self.end - t
            h = left if h >= left * (1 - 1e-9) else min(h, 0.5 * left) if 2 * h > left else h
            if not self.steady:
                self._refreeze(t, h)
            window, error = self._window(t, h)
            if error > self.batch.tolerance:
                if h < SHORTEST * span:
                    raise InputError(f"the time steps of the reduced model vanished at t = {t:.6g} s")
                h *= max(SHRINK, 0.8 * (self.batch.tolerance / error) ** (1 / len(NODES)))
                continue
            windows.append(window)
            self.y = window.end
            self.going = h, window.heat @ (np.arange(len(NODES)) / h)
            t = self.end if h == left else t + h
            h *= min(GROWTH, 0.8 * (self.batch.tolerance / max(error, 1e-12)) ** (1 / len(NODES)))
        return windows

    def _seen(self, t: float) -> float:
        return min(max(t, self.low), self.high)

    def _refreeze(self, t: float, h: float) -> None:
        now, before = self.batch.outside(self._seen(t + h / 2)), self.frozen.films
        if (np.abs(now.films - before) > STALE * np.maximum(now.films, before)).any():
            self._freeze(now)

    def _window(self, t: float, h: float) -> tuple[Window, float]:
        """A window by sweeps, and its error: what the highest power of time adds, and what the last sweep changed."""
        batch, count = self.batch, len(NODES)
        seen = [self._seen(t + c * h) for c in NODES]
        moments = [self.frozen] if self.steady else [batch.outside(moment) for moment in seen]
        films, sinks, powers, constant = (
            np.stack([getattr(moment, name) for moment in moments], axis=-1)
            for name in ("films", "sinks", "powers", "constant")
        )
        apart = None if self.steady else films - self.frozen.films[:, :, None]
        E, each = responses(h * self.decay, NODES, count)
        # Answer of every mode at the nodes to heat at the nodes: (B, n, node, node of the heat).
        answer = np.tensordot(each, h * TO_POWERS, axes=(0, 0))
        z0 = (self.into @ (self.M @ self.y[:, :, None]))[:, :, 0]
        free = E * z0[:, :, None]
        # To begin with, the heat of the window's start goes on as it changed before, ever less.
        began = self._heat(
            seen[:1], self.y[:, :, None], constant[:, :, :1], None if apart is None else apart[:, :, :1]
        )[0]
        guess = self.into @ began
        if self.going is not None:
            past, slope = self.going
            guess = guess + slope[:, :, None] * past * (1 - np.exp(-NODES * h / past))
        y = self.back @ (free + np.einsum("bnkl,bnl->bnk", answer, np.broadcast_to(guess, free.shape)))
        change, swept = np.inf, 0
        while change > SETTLED * batch.tolerance and swept < SWEEPS:
            heat, q = self._heat(seen, y, constant, apart)
            into = self.into @ heat
            then = self.back @ (free + np.einsum("bnkl,bnl->bnk", answer, into))
            before, change = change, self._largest(then - y)
            used, y, swept = y, then, swept + 1
            if not np.isfinite(change) or change > 2 * before:
                return _nothing(), np.inf
        rest = batch.ledger.rest(q, films, sinks, powers, self.frozen.films, used)
        coefficients = into @ TO_POWERS.T
        top = self.back @ (coefficients[:, :, -1] * h / (1 + h * self.decay))[:, :, None]
        # A polynomial through one point fewer is off by the product of the others' distances, 2 / 4^(count - 1).
        error = self._largest(top) * 2.0 / 4.0 ** (count - 1)
        if change > SETTLED * batch.tolerance:
            error = max(error, change)
        window = Window(
            t,
            h,
            (self.low, self.high),
            self.decay,
            self.back,
            self.frozen,
            self.steady,
            z0,
            coefficients,
            rest @ TO_POWERS.T,
            y[:, :, -1],
        )
        return window, error

    def _heat(self, seen: Sequence[float], y: Array, constant: Array, apart: Array | None) -> tuple[Array, Array]:
        """Heat (B, n, k) into every unknown but for what frozen films take, and sources (B, n_samples, k)."""
        m = self.batch.model.size
        q = self.batch.heat(seen, y[:, :m])
        heat = np.repeat(constant, y.shape[2], axis=2) if constant.shape[2] == 1 else constant.copy()
        heat[:, :m] += self.batch.model.load @ q
        if apart is not None:
            heat -= self._deviating(apart, y)
        return heat, q

    def _deviating(self, apart: Array, y: Array) -> Array:
        """Heat that leaves through what films (B, n_exchanges, k) are more than the frozen ones."""
        stack = self.batch.balances[0].stack
        exchanged = np.einsum("jmn,bnk->bjmk", stack, y, optimize=True)
        return np.asarray((apart[:, :, None, :] * exchanged).sum(axis=1))

    def _largest(self, y: Array) -> float:
        """Largest temperature of modes and reservoirs (B, n, k), K."""
        m = self.batch.model.size
        body = np.abs(self.batch.model.watched @ y[:, :m]).max(initial=0.0)
        return float(max(body, np.abs(y[:, m:]).max(initial=0.0)))


def _nothing() -> Window:
    return Window(0.0, 0.0, (0.0, 0.0), *(np.zeros(0),) * 2, None, True, *(np.zeros(0),) * 4)  # type: ignore[arg-type]
