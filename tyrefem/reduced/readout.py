"""What is read off a batch of reduced variants at once: sensors, hottest places, walls, heat."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import Cache, Content
from tyrefem.conduction.budget import Budget
from tyrefem.conduction.field import Peak
from tyrefem.reduced.budget import end_budgets
from tyrefem.reduced.exponential import NODES, Marched
from tyrefem.simulation.heat_budget import HeatBudget, whole_tyre
from tyrefem.simulation.rolling_resistance import just_before

Array = NDArray[np.float64]
#: K: far more than single precision is off by.
ROUGH = 5e-3
#: K: between two posts, no node gets hotter than at both by as much.
BETWEEN = 1.0


@dataclass(frozen=True, eq=False)
class Readout:
    """A marched batch read at the times (n,) s of its readings."""

    marched: Marched
    times: Array

    @functools.cached_property
    def looked(self) -> Array:
        """Times at which peaks are looked for, s: more than those of the readings."""
        return self.marched.looked(self.times)

    @functools.cached_property
    def _seen(self) -> Array:
        return self.marched.states(self.looked)

    @functools.cached_property
    def states(self) -> Array:
        """(n_times, B, n)."""
        return self._seen[np.searchsorted(self.looked, np.round(self.times, 9))]

    @property
    def modes(self) -> Array:
        """(n_times, B, m)."""
        return self.states[:, :, : self.marched.batch.model.size]

    def at(self, points: Array) -> Array:
        """(n_times, B, k) degC at points (k, 2) in (r, z), m."""
        return self._fields.get(
            Content.of(points), lambda: np.asarray(self.modes @ self.marched.batch.model.rows(points).T)
        )

    @functools.cached_property
    def _fields(self) -> Cache[Array]:
        """Temperatures at sets of points: the sensors of the latest variants."""
        return Cache(size=16)

    @functools.cached_property
    def _heats(self) -> Cache[Any]:
        """Heat and power of all variants, by name and number of the time; about as many as readings."""
        return Cache(size=1024)

    @functools.cached_property
    def wall(self) -> Array:
        """(B, k) K/m through the wall at the end."""
        _, thickness, inner, outer = self.marched.batch.model.wall
        end = self.modes[-1]
        return np.abs(end @ inner.T - end @ outer.T) / thickness

    @functools.cached_property
    def highest(self) -> Array:
        """(n_times, B) hottest of the nodes that were about the hottest in training, degC."""
        return np.max(
            [self._candidates(region, self.modes).max(axis=2) for region in self.marched.batch.model.hot], axis=0
        )

    def _candidates(self, region: str, modes: Array) -> Array:
        model = self.marched.batch.model
        return np.asarray(modes @ model.hot_rows[region].T)

    @functools.cached_property
    def peaks(self) -> list[dict[str, Peak]]:
        """Of every variant: ``tyre`` and every region -> its highest temperature, with place and time."""
        model, count = self.marched.batch.model, self.states.shape[1]
        modes, when, hottest = self._seen[:, :, : model.size], {}, {}
        each, posts = np.arange(count), self._posts
        at_posts = modes[posts].astype(np.float32).transpose(1, 0, 2).reshape(-1, model.size)
        missed: set[int] = set()
        for region, hot in model.hot.items():
            rows = model.hot_rows[region]
            # In single precision first, and only near the highest posts; then in double what may be the highest.
            light = rows.T.astype(np.float32)
            first = (at_posts @ light).max(axis=1).reshape(count, -1)
            near = first >= first.max(axis=1, keepdims=True) - BETWEEN
            variant, times = np.nonzero(near[:, :-1] | near[:, 1:])
            variant, times = _between(variant, posts[times], posts[times + 1])
            rough = (modes[times, variant].astype(np.float32) @ light).max(axis=1)
            highest_of = np.maximum.reduceat(rough, np.searchsorted(variant, each))
            kept = rough >= highest_of[variant] - ROUGH
            variant, times = variant[kept], times[kept]
            values = modes[times, variant] @ rows.T
            node, firsts = values.argmax(axis=1), np.searchsorted(variant, each)
            highest = values[np.arange(len(variant)), node]
            best = np.array([a + highest[a:b].argmax() for a, b in pairwise([*firsts, len(variant)])])
            when[region] = times[best]
            hottest[region] = highest[best], np.asarray(hot)[node[best]]
            # All nodes at these times: is any hotter than those that were looked at?
            most = (model.region_rows[region] @ modes[when[region], each].T).max(axis=0)
            missed |= set(np.flatnonzero(most > hottest[region][0] + 1e-9).tolist())
        points, peaks = model.operators.points, []
        for b in range(count):
            if b in missed:
                peaks.append(self._searched(b))
                continue
            peaks.append(
                _with_tyre(
                    {
                        region: _peak(points, float(T[b]), int(node[b]), float(self.looked[when[region][b]]))
                        for region, (T, node) in hottest.items()
                    }
                )
            )
        return peaks

    @functools.cached_property
    def _posts(self) -> NDArray[np.intp]:
        """Numbers of the times looked at that are nearest to the windows' nodes, and of the first and the last.

        Between two of them temperatures change smoothly.
        """
        windows = self.marched.windows
        nodes = np.concatenate([window.time + NODES * window.length for window in windows])
        right = np.clip(np.searchsorted(self.looked, nodes), 1, len(self.looked) - 1)
        left_is_nearer = nodes - self.looked[right - 1] < self.looked[right] - nodes
        return np.unique(np.concatenate([[0, len(self.looked) - 1], right - left_is_nearer]))

    def _searched(self, variant: int) -> dict[str, Peak]:
        """Over all nodes and times."""
        model = self.marched.batch.model
        values, peaks = self._seen[:, variant, : model.size] @ model.V.T, {}
        for region, dofs in model.regions.items():
            of_region = values[:, dofs]
            i, j = np.unravel_index(int(np.argmax(of_region)), of_region.shape)
            peaks[region] = _peak(model.operators.points, float(of_region[i, j]), int(dofs[j]), float(self.looked[i]))
        return _with_tyre(peaks)

    def generated(self, i: int) -> tuple[Array, Array]:
        """Heat of hysteresis (B,) of the section until ``times[i]``, J, and then, W."""

        def compute() -> tuple[Array, Array]:
            zones = len(self.marched.batch.model.zones)
            energy = self.marched.energy_until(float(self.times[i]))
            return energy[:, :zones].sum(axis=1), self.powers(i)[:, :zones].sum(axis=1)

        heat: tuple[Array, Array] = self._heats.get(("generated", i), compute)
        return heat

    def powers(self, i: int) -> Array:
        """(B, n_entries) W at ``times[i]``."""
        return np.asarray(
            self._heats.get(("powers", i), lambda: self.marched.powers(float(self.times[i]), self.states[i]))
        )

    def cold_power(self, i: int) -> Array:
        """(B,) W of hysteresis of the section just before ``times[i]``, all of it at the initial temperature."""

        def compute() -> Array:
            batch = self.marched.batch
            start = np.stack([balance.start for balance in batch.balances])[:, : batch.model.size, None]
            q = batch.heat([just_before(self.times, i)], start)
            return np.asarray((batch.model.power @ q)[:, :, 0].sum(axis=1))

        return np.asarray(self._heats.get(("cold power", i), compute))

    @functools.cached_property
    def end_budgets(self) -> Budget:
        """The budget at the end, every variant in the place of a time."""
        last = len(self.times) - 1
        return end_budgets(
            self.marched.batch.balances, self.states[-1], self.end_slopes[0], self.powers(last), self.marched.energy
        )

    def end_budget(self, names: tuple[Any, bool, Any]) -> HeatBudget:
        """The same of the whole tyre: (titles of the zones, half section?, names of added conditions)."""
        titles, half, added = names
        budget: HeatBudget = self._heats.get(
            ("end budget", names), lambda: whole_tyre(self.end_budgets, dict(titles), half, dict(added))
        )
        return budget

    @functools.cached_property
    def end_slopes(self) -> Array:
        """(1, B, n) 1/s at the end."""
        return self.marched.slopes(self.times[-1:])

    def reservoirs(self, variant: int) -> Mapping[str, Array]:
        """Gas, rim -> (n_times,) degC."""
        m = self.marched.batch.model.size
        names = self.marched.batch.balances[variant].reservoirs
        return {name: self.states[:, variant, m + i] for i, name in enumerate(names)}


def _between(
    variant: NDArray[np.intp], first: NDArray[np.intp], last: NDArray[np.intp]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Every (variant, time) from ``first`` to ``last``, each once, in order.

    >>> _between(np.array([0, 0, 1]), np.array([0, 2, 1]), np.array([2, 3, 2]))
    (array([0, 0, 0, 0, 1, 1]), array([0, 1, 2, 3, 1, 2]))
    """
    counts = last - first + 1
    variants = np.repeat(variant, counts)
    times = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts) + np.repeat(first, counts)
    pairs = np.unique(variants * (int(last.max()) + 1) + times)
    return pairs // (int(last.max()) + 1), pairs % (int(last.max()) + 1)


def _with_tyre(peaks: dict[str, Peak]) -> dict[str, Peak]:
    return {"tyre": max(peaks.values(), key=lambda peak: peak.temperature)} | peaks


def _peak(points: Array, temperature: float, node: int, time: float) -> Peak:
    return Peak(temperature, (float(points[0, node]), float(points[1, node])), time)
