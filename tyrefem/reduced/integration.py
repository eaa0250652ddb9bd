"""Time integration of a batch: modes decay exactly, heat is collocated in time, all variants share the windows."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dsygvd

from tyrefem.errors import InputError
from tyrefem.reduced.batch import Batch, steady
from tyrefem.reduced.boundary_data import BoundaryData
from tyrefem.reduced.exponential import responses
from tyrefem.reduced.shared_product import shared_product
from tyrefem.reduced.solution import NODES, TO_POWERS, BatchSolution, Window

Array = NDArray[np.float64]
#: First window over the phase; largest growth and shrinkage from a window to the next.
FIRST, GROWTH, SHRINK = 0.05, 5.0, 0.3
#: Sweeps of a window at most, else it is shortened; sweeps end when the change is below this share of the tolerance.
SWEEPS, SETTLED = 14, 0.05
#: Films are frozen again when they have changed by more than this share.
STALE = 0.2
#: Shortest window over the phase.
SHORTEST = 1e-9


def integrate(batch: Batch) -> BatchSolution:
    """Integrate a batch over all phases of its drive.

    Raises
    ------
    InputError : the time windows become too short.
    """
    drive, y = batch.balances[0].alike.drive, np.stack([each.start for each in batch.balances])
    windows: list[Window] = []
    knots = batch.balances[0].alike.schedule.knots
    jumps = {time for each in batch.balances for effect in each.alike.study.effects for time in effect.jumps}
    for number, (start, end) in enumerate(pairwise([*drive.starts, drive.end])):
        # Between load cases the heat is linear in time, and effects may jump: a window must end at each of them.
        cases = {start + (end - start) * share for share in knots[number] if 0 < share < 1}
        kinks = sorted({*cases, *(time for time in jumps if start < time < end)})
        for first, last in pairwise([start, *kinks, end]):
            phase = _PhaseIntegration(batch, number, first, last, y)
            windows += phase.run()
            y = phase.y
    return BatchSolution(batch, windows, y)


class _PhaseIntegration:
    """Integration of one phase; boundary data are taken within the phase, steady data only once."""

    def __init__(self, batch: Batch, number: int, start: float, end: float, y: Array) -> None:
        inside = max(1e-10 * (end - start), 4 * np.spacing(max(abs(start), abs(end))))
        self.batch, self.start, self.end, self.y = batch, start, end, y
        self.low, self.high = start + inside, end - inside
        self.steady = all(steady(balance, number) for balance in batch.balances)
        self._freeze(batch.boundary_data(self.low))

    def _freeze(self, moment: BoundaryData) -> None:
        """Freeze the films of these boundary data in A, and solve the eigenproblem of (A, M)."""
        # Length of the previous window, and the rate of the heat into its modes at its end.
        self.previous: tuple[float, Array] | None = None
        self.M, K = self.batch.matrices
        self.frozen = moment
        balances = self.batch.balances
        if all(balance.model is balances[0].model for balance in balances):
            A = K + np.tensordot(moment.films, balances[0].stack, axes=1)
        else:
            A = K + [np.tensordot(h, each.stack, axes=1) for h, each in zip(moment.films, balances, strict=True)]
        self.decay, self.into = np.empty(A.shape[:2]), np.empty_like(A)
        # Variants that differ in their heat sources only share the eigenvectors.
        solved: dict[tuple[bytes, bytes], int] = {}
        for b in range(len(A)):
            first = solved.setdefault((A[b].tobytes(), self.M[b].tobytes()), b)
            if first < b:
                self.decay[b], self.into[b] = self.decay[first], self.into[first]
                continue
            decay, back, failed = dsygvd(A[b], self.M[b])
            if failed:
                raise np.linalg.LinAlgError("heat capacity that is not positive definite")
            self.decay[b], self.into[b] = np.maximum(decay, 0.0), back.T
        self.back = np.ascontiguousarray(self.into.transpose(0, 2, 1))

    def run(self) -> list[Window]:
        """Integrate with error control; the largest error of all variants counts."""
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
            self.previous = h, window.heat @ (np.arange(len(NODES)) / h)
            t = self.end if h == left else t + h
            h *= min(GROWTH, 0.8 * (self.batch.tolerance / max(error, 1e-12)) ** (1 / len(NODES)))
        return windows

    def _inside(self, t: float) -> float:
        return min(max(t, self.low), self.high)

    def _refreeze(self, t: float, h: float) -> None:
        moment, before = self.batch.boundary_data(self._inside(t + h / 2)), self.frozen.films
        if (np.abs(moment.films - before) > STALE * np.maximum(moment.films, before)).any():
            self._freeze(moment)

    def _window(self, t: float, h: float) -> tuple[Window, float]:
        """A window and its error: from the highest power of time and from the change of the last sweep."""
        batch, count = self.batch, len(NODES)
        data_times = [self._inside(t + c * h) for c in NODES]
        moments = [self.frozen] if self.steady else [batch.boundary_data(moment) for moment in data_times]
        films, sinks, powers, constant = (
            np.stack([getattr(moment, name) for moment in moments], axis=-1)
            for name in ("films", "sinks", "powers", "constant")
        )
        film_change = None if self.steady else films - self.frozen.films[:, :, None]
        E, each = responses(h * self.decay, NODES, count)
        # Response of every mode at the time nodes to heat at the time nodes: (B, n, node, node of the heat).
        answer = np.tensordot(each, h * TO_POWERS, axes=(0, 0))
        z0 = (self.into @ (self.M @ self.y[:, :, None]))[:, :, 0]
        free = E * z0[:, :, None]
        # First guess: the heat at the window's start, with the previous window's trend, damped.
        start_heat = self._heat(
            data_times[:1],
            self.y[:, :, None],
            constant[:, :, :1],
            None if film_change is None else film_change[:, :, :1],
        )[0]
        guess = self.into @ start_heat
        if self.previous is not None:
            past, slope = self.previous
            guess = guess + slope[:, :, None] * past * (1 - np.exp(-NODES * h / past))
        y = self.back @ (free + np.einsum("bnkl,bnl->bnk", answer, np.broadcast_to(guess, free.shape)))
        change, sweeps = np.inf, 0
        while change > SETTLED * batch.tolerance and sweeps < SWEEPS:
            heat, q = self._heat(data_times, y, constant, film_change)
            into = self.into @ heat
            updated = self.back @ (free + np.einsum("bnkl,bnl->bnk", answer, into))
            before, change = change, self._largest(updated - y)
            used, y, sweeps = y, updated, sweeps + 1
            if not np.isfinite(change) or change > 2 * before:
                return _no_window(), np.inf
        rest = batch.heat_flows.rest(q, films, sinks, powers, self.frozen.films, used)
        coefficients = into @ TO_POWERS.T
        top = self.back @ (coefficients[:, :, -1] * h / (1 + h * self.decay))[:, :, None]
        # With one point fewer the polynomial's error is the product of the distances, 2 / 4^(count - 1).
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

    def _heat(
        self, data_times: Sequence[float], y: Array, constant: Array, film_change: Array | None
    ) -> tuple[Array, Array]:
        """Heat into every unknown except by frozen films, (B, n, k) W, and heat sources, (B, n_samples, k) W/m3."""
        m = self.batch.model.size
        q = self.batch.heat(data_times, y[:, :m])
        heat = np.repeat(constant, y.shape[2], axis=2) if constant.shape[2] == 1 else constant.copy()
        heat[:, :m] += shared_product(self.batch.source_load, q)
        if film_change is not None:
            heat -= self._film_change_heat(film_change, y)
        return heat, q

    def _film_change_heat(self, film_change: Array, y: Array) -> Array:
        """Heat that leaves through the change (B, n_exchanges, k) of the films since they were frozen."""
        exchanged = self.batch.films @ y[:, None]
        return np.asarray((film_change[:, :, None, :] * exchanged).sum(axis=1))

    def _largest(self, y: Array) -> float:
        """Largest absolute temperature of states (B, n, k), K."""
        m = self.batch.model.size
        body = np.abs(self.batch.model.error_rows @ y[:, :m]).max(initial=0.0)
        return float(max(body, np.abs(y[:, m:]).max(initial=0.0)))


def _no_window() -> Window:
    return Window(0.0, 0.0, (0.0, 0.0), *(np.zeros(0),) * 2, None, True, *(np.zeros(0),) * 4)  # type: ignore[arg-type]
