"""Adaptive time integration of the heat balance, phase by phase."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.balance import HeatBalance
from tyrefem.conduction.budget import Tally
from tyrefem.conduction.errors import SolverError
from tyrefem.conduction.field import Peak
from tyrefem.conduction.highest_possible import HighestPossible
from tyrefem.conduction.rosenbrock import Step
from tyrefem.conduction.stage_matrix import StageMatrices
from tyrefem.conduction.terms import State

Array = NDArray[Any]

# Local error allowed per kelvin of tolerance; with it the global error stays within the tolerance.
_SHARE = 0.25
_RUNG = 2.0 ** (2 / 3)
#: Breakpoints that differ by this share of the latest time are one: they differ by rounding.
SAME_TIME = 1e-12
#: degC, far above all solids: a run that gets there has no solution.
HOTTEST = 1e6
#: K/s times the length of a phase: a faster rise is a runaway.
RUNAWAY = 1e6


class Integration:
    """One run from times[0] to times[-1]; an interrupted `run` keeps the finished part.

    Data are continuous between breakpoints: at its limits a phase uses data from inside. ``tally``: collects the heat
    budget; None: temperatures alone, by the same steps, without heat budget and hottest points.
    """

    def __init__(
        self,
        balance: HeatBalance,
        times: Array,
        y: State,
        tolerance: float,
        breakpoints: Array,
        max_step: float,
        tally: Tally | None,
    ) -> None:
        self.balance, self.times, self.y, self.tally = balance, times, y, tally
        self.goal, self.max_step = _SHARE * tolerance, max_step
        #: Breakpoints in order, each as (time, first, last): of those that are one, the first and the last.
        self.breaks = _breaks(float(times[0]), float(times[-1]), breakpoints)
        self.matrices = StageMatrices()
        self.accepted = self.rejected = 0
        self.values: list[Array] = []
        self.gas: list[Array] = []
        self.energy = np.zeros(len(balance.entries))
        self.stored = np.zeros(len(balance.capacities))
        self.kept = np.zeros(len(balance.reservoirs))
        regions = [None, *(c.dofs for c in balance.capacities.values())]
        self._regions = regions
        self._low = float(times[0])
        self._peaks = [(-math.inf, 0, 0.0)] * len(regions)
        self._bound = HighestPossible(balance, tolerance)

    def run(self, progress: Callable[[float], None] | None) -> None:
        """Integrate phase after phase."""
        for begin, end in pairwise(self.breaks):
            first, last = begin[0], end[0]
            rounding = 4 * float(np.spacing(max(abs(first), abs(last))))
            inside = max(1e-10 * (last - first), rounding)
            low, high = max(first + inside, begin[2] + rounding), min(last - inside, end[1] - rounding)
            self._phase(first, last, low, high, progress)

    def _phase(
        self, first: float, last: float, low: float, high: float, progress: Callable[[float], None] | None
    ) -> None:
        """Integrate from ``first`` to ``last``, with data from ``low`` to ``high``, s."""
        b = self.balance
        self._low = low
        self._jump(low)
        b.balance_massless(low, self.y.u, self.y.g)
        b.freeze(low, self.y)
        if self.tally is not None:
            self._bound.begin(low, self.y)
            self._update_peaks(first, self.y)
        t, h = first, self._first_step(low, last - first)
        while t < last:
            h = self._ladder_step(min(h, self.max_step))
            remaining = last - t
            h_now = remaining if h >= remaining * (1 - 1e-9) else min(h, 0.5 * remaining) if 2 * h > remaining else h
            step = Step(b, t, h_now, self.y)
            error = step.run(self.matrices.get(b, h_now), low, high)
            factor = 0.9 * (self.goal / max(error, 1e-30)) ** (1 / 3)
            if error > self.goal:
                self.rejected += 1
                h = h_now * max(0.1, min(factor, 0.8)) if math.isfinite(error) else 0.1 * h_now
                if h < 1e-13 * max(abs(t), last - first):
                    message = f"the time step vanished at t = {t:.6g} s (error estimate {error:.3g} K)"
                    raise SolverError(self._runaway(step, last - first) or message)
                continue
            # A growth by one ladder step does not repay its factorisation: wait until two are possible.
            grown = h_now * (min(4.0, factor) if not 1 <= factor < _RUNG**2 else 1.0)
            h = max(h, h_now) if h_now < h and factor >= 1 else grown
            t_new = last if h_now == remaining else t + h_now
            self._accept(step, t, t_new, min(t_new, high))
            t = t_new
            if self.y.u.max() > HOTTEST:
                raise SolverError(_runaway_at(t, float(self.y.u.max())))
            if progress is not None:
                progress(t)
            if t < last and b.stale(min(max(t, low), high), self.y):
                b.freeze(min(max(t, low), high), self.y)

    def _runaway(self, step: Step, span: float) -> str:
        """Why the step vanished, if temperatures rise without bound in a phase of so many s; else empty."""
        rise = float(np.max(step.ku[0], initial=0.0))
        return _runaway_at(step.t, float(step.y.u.max())) if rise * span > RUNAWAY else ""

    @staticmethod
    def _ladder_step(h: float) -> float:
        """The step on the geometric ladder just below h, so that factors can be used again."""
        return _RUNG ** math.floor(math.log(h) / math.log(_RUNG) + 1e-9)

    def _jump(self, t: float) -> None:
        """Set the prescribed nodes to their values at the start of a phase and record the heat of the jump."""
        b = self.balance
        target = b.fixed(t)
        for slot, part in b.fixed.parts:
            before, nodes = self.y.u.copy(), b.fixed.dofs[part]
            self.y.u[nodes] = target[part]
            heat = b.stored(before, self.y.u)
            self.stored += heat
            self.energy[slot] += heat.sum()

    def _first_step(self, t: float, span: float) -> float:
        b = self.balance
        G, _, _ = b.remainder(t, self.y)
        heat, capacity = G - b.S @ self.y.u + b.B @ self.y.g, b.M @ np.ones(G.size)
        # Nodes of quadratic triangles on the axis have none by themselves, but for rounding.
        lumped = np.abs(capacity) > 1e-9 * np.abs(capacity).max()
        rate = np.divide(heat, capacity, out=np.zeros_like(heat), where=lumped)
        fastest = float(np.max(np.abs(rate[b.fixed.free]), initial=0.0))
        return min(span, 30 * self.goal / fastest if fastest > 0 else span)

    def _accept(self, step: Step, t: float, t_new: float, seen: float) -> None:
        b, n = self.balance, len(self.values)
        due = np.searchsorted(self.times, t_new, side="right")
        end = step.at(1.0)
        b.balance_massless(seen, end.u, end.g)
        if self.tally is not None:
            self._bound.advance(seen, end)
        for i in range(n, due):
            theta = (self.times[i] - t) / step.h if self.times[i] < t_new else 1.0
            self._output(step, theta, end if theta >= 1.0 else None, seen)
        self.y = end
        self.accepted += 1
        if self.tally is not None:
            self.energy += step.energies(1.0)
            self.stored += b.stored(step.y.u, end.u)
            self.kept += b.reservoir_stored(step.y.g, end.g)
            self._update_peaks(t_new, end)

    def _output(self, step: Step, theta: float, end: State | None, seen: float) -> None:
        b = self.balance
        y = end if end is not None else step.at(theta)
        t = min(max(step.t + theta * step.h, self._low), seen)
        if end is None and theta > 0:
            b.balance_massless(t, y.u, y.g)
        if self.tally is not None:
            self._record(self.tally, step, theta, t, y)
        self.values.append(y.u.copy())
        self.gas.append(y.g.copy())

    def _record(self, tally: Tally, step: Step, theta: float, t: float, y: State) -> None:
        """Add heat and hottest points at a requested time."""
        b, slope = self.balance, step.slope(theta)
        self._update_peaks(self.times[len(self.values)], y)
        tally.record(
            self.energy + step.energies(theta),
            b.powers(t, y, slope),
            self.stored + b.stored(step.y.u, y.u),
            b.storage_power(y.u, slope),
            self.kept + b.reservoir_stored(step.y.g, y.g),
        )

    def _update_peaks(self, t: float, y: State) -> None:
        """Update the hottest points, without temperatures above the bound: those are of elements that overshoot."""
        for j, dofs in enumerate(self._regions):
            u = y.u if dofs is None else y.u[dofs]
            i = int(np.argmax(u))
            if u[i] > self._bound.value:
                u = np.where(u > self._bound.value, -np.inf, u)
                i = int(np.argmax(u))
            if u[i] > self._peaks[j][0]:
                self._peaks[j] = (float(u[i]), i if dofs is None else int(dofs[i]), t)

    def peaks(self) -> list[Peak]:
        """Hottest point of the body, then of every region."""
        x = self.balance.ops.points
        return [Peak(T, (float(x[0, i]), float(x[1, i])), t) for T, i, t in self._peaks]


def _breaks(start: float, end: float, breakpoints: Array) -> list[tuple[float, float, float]]:
    """Start, breakpoints between, and end of a run, each as (time, first, last) of those that are one, s."""
    close = SAME_TIME * max(abs(start), abs(end))
    breaks = [(start, start, start)]
    for time in np.unique(breakpoints[(breakpoints > start) & (breakpoints < end)]).tolist():
        kept, first, last = breaks[-1]
        if time - last <= close:
            breaks[-1] = kept, first, time
        else:
            breaks.append((time, time, time))
    kept, first, last = breaks[-1]
    if len(breaks) > 1 and end - last <= close:
        breaks[-1] = end, first, end
    else:
        breaks.append((end, end, end))
    return breaks


def _runaway_at(time: float, hottest: float) -> str:
    """The error of temperatures that rise without bound."""
    return (
        f"temperatures rise without bound at t = {time:.6g} s (hottest point {hottest:.4g} degC): a thermal runaway, "
        "or far too much heat; check heat sources, and tan delta that rises with temperature"
    )
