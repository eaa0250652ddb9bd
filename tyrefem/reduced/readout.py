"""Quantities read from the solution of a batch: sensors, peaks, wall gradients, heat."""

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
from tyrefem.geometry.meshing.sagitta import kept_inside
from tyrefem.reduced.budget import end_budgets
from tyrefem.reduced.error_estimate import estimated_errors
from tyrefem.reduced.solution import NODES, BatchSolution
from tyrefem.simulation.heat_budget import HeatBudget, whole_tyre
from tyrefem.simulation.rolling_resistance import just_before
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.sensors import recorded, true_places

Array = NDArray[np.float64]
#: K: well above the error of single precision.
SINGLE_PRECISION_ERROR = 5e-3
#: K: between two post times no node exceeds its temperature at both by as much.
POST_MARGIN = 1.0


@dataclass(frozen=True, eq=False)
class Readout:
    """Readings of a batch's solution at times (n,) s."""

    solution: BatchSolution
    times: Array

    @functools.cached_property
    def peak_times(self) -> Array:
        """Times at which peaks are searched, s: those of the readings and more."""
        return self.solution.peak_times(self.times)

    @functools.cached_property
    def _peak_states(self) -> Array:
        return self.solution.states(self.peak_times)

    @functools.cached_property
    def states(self) -> Array:
        """States at the readings, (n_times, B, n)."""
        return self._peak_states[np.searchsorted(self.peak_times, np.round(self.times, 9))]

    @property
    def modes(self) -> Array:
        """Mode amplitudes at the readings, (n_times, B, m)."""
        return self.states[:, :, : self.solution.batch.model.size]

    def at(self, points: Array, variant: int) -> Array:
        """Temperatures of a variant at points (k, 2) in (r, z), m: (n_times, k) degC."""
        models = self.solution.batch.models
        if models[variant] is not models[0]:
            return np.asarray(self.modes[:, variant] @ models[variant].rows(points).T)
        fields: Array = self._fields.get(Content.of(points), lambda: np.asarray(self.modes @ models[0].rows(points).T))
        return fields[:, variant]

    def recorded(self, variant: int) -> dict[str, Array]:
        """Sensor -> recorded temperature of a variant, (n_times,) degC."""
        balance = self.solution.batch.balances[variant]
        tyre = balance.alike
        study = tyre.study
        places = true_places(study)
        if not places:
            return {}
        section, stated = study.section, tuple(places.values())
        built_in = balance.model.sensor_places.get(
            (section, stated), lambda: kept_inside(balance.model.base.mesh, np.array(stated))
        )
        if balance.known is None:
            return recorded(study, self.times, self.at(built_in, variant))

        def together() -> dict[str, Array]:
            # (n_times, n_sensors, B)
            return recorded(study, self.times, (self.modes @ balance.model.rows(built_in).T).transpose(0, 2, 1))

        # Variants with learnt inputs have the same sensors.
        of_all: dict[str, Array] = self._heats.get("recorded", together)
        return {name: series[:, variant] for name, series in of_all.items()}

    @functools.cached_property
    def _fields(self) -> Cache[Array]:
        """Points -> temperatures there: the sensors of the latest variants."""
        return Cache(size=16)

    @functools.cached_property
    def _heats(self) -> Cache[Any]:
        """(name, number of the time) -> heat or power of all variants."""
        return Cache(size=1024)

    @functools.cached_property
    def errors(self) -> Array | None:
        """Estimated errors of temperatures, (B,) K; None: no estimates."""
        return estimated_errors(self.solution)

    @functools.cached_property
    def wall(self) -> Array:
        """Temperature gradient through the wall at the end, (B, k) K/m."""
        models, end = self.solution.batch.models, self.modes[-1]
        if all(model is models[0] for model in models):
            _, thickness, inner, outer = models[0].wall
            return np.abs(end @ inner.T - end @ outer.T) / thickness
        walls = [model.wall for model in models]
        return np.array([np.abs((wall[2] - wall[3]) @ a) / wall[1] for wall, a in zip(walls, end, strict=True)])

    @functools.cached_property
    def highest(self) -> Array:
        """Highest temperature among the nodes that were nearly the hottest in training, (n_times, B) degC."""
        return np.max(
            [self._candidates(region, self.modes).max(axis=2) for region in self.solution.batch.model.hot], axis=0
        )

    def _candidates(self, region: str, modes: Array) -> Array:
        model = self.solution.batch.model
        return np.asarray(modes @ model.hot_rows[region].T)

    @functools.cached_property
    def peaks(self) -> list[dict[str, Peak]]:
        """Per variant: ``tyre`` and every region -> highest temperature with its place and time."""
        model, count = self.solution.batch.model, self.states.shape[1]
        modes, when, hottest = self._peak_states[:, :, : model.size], {}, {}
        each, posts = np.arange(count), self._posts
        at_posts = modes[posts].astype(np.float32).transpose(1, 0, 2).reshape(-1, model.size)
        needs_search: set[int] = set()
        for region, hot in model.hot.items():
            rows = model.hot_rows[region]
            # Single precision near the highest posts selects the times; double precision finds the peak among them.
            light = rows.T.astype(np.float32)
            first = (at_posts @ light).max(axis=1).reshape(count, -1)
            near = first >= first.max(axis=1, keepdims=True) - POST_MARGIN
            variant, times = np.nonzero(near[:, :-1] | near[:, 1:])
            variant, times = _between(variant, posts[times], posts[times + 1])
            rough = (modes[times, variant].astype(np.float32) @ light).max(axis=1)
            highest_of = np.maximum.reduceat(rough, np.searchsorted(variant, each))
            kept = rough >= highest_of[variant] - SINGLE_PRECISION_ERROR
            variant, times = variant[kept], times[kept]
            values = modes[times, variant] @ rows.T
            node, firsts = values.argmax(axis=1), np.searchsorted(variant, each)
            highest = values[np.arange(len(variant)), node]
            best = np.array([a + highest[a:b].argmax() for a, b in pairwise([*firsts, len(variant)])])
            when[region] = times[best]
            hottest[region] = highest[best], np.asarray(hot)[node[best]]
            # Check at these times whether any other node is hotter.
            most = (model.region_rows[region] @ modes[when[region], each].T).max(axis=0)
            needs_search |= set(np.flatnonzero(most > hottest[region][0] + 1e-9).tolist())
        models, peaks = self.solution.batch.models, []
        for b in range(count):
            if b in needs_search:
                peaks.append(self._full_search(b))
                continue
            peaks.append(
                _with_tyre(
                    {
                        region: _peak(
                            models[b].points, float(T[b]), int(node[b]), float(self.peak_times[when[region][b]])
                        )
                        for region, (T, node) in hottest.items()
                    }
                )
            )
        return peaks

    @functools.cached_property
    def _posts(self) -> NDArray[np.intp]:
        """Numbers of the peak times nearest to the windows' nodes, with the first and the last.

        Temperatures change smoothly between two posts.
        """
        windows = self.solution.windows
        nodes = np.concatenate([window.time + NODES * window.length for window in windows])
        right = np.clip(np.searchsorted(self.peak_times, nodes), 1, len(self.peak_times) - 1)
        left_is_nearer = nodes - self.peak_times[right - 1] < self.peak_times[right] - nodes
        return np.unique(np.concatenate([[0, len(self.peak_times) - 1], right - left_is_nearer]))

    def _full_search(self, variant: int) -> dict[str, Peak]:
        """Peaks of a variant over all nodes and all peak times."""
        model = self.solution.batch.model
        values, peaks = self._peak_states[:, variant, : model.size] @ model.V.T, {}
        for region, dofs in model.regions.items():
            of_region = values[:, dofs]
            i, j = np.unravel_index(int(np.argmax(of_region)), of_region.shape)
            peaks[region] = _peak(
                self.solution.batch.models[variant].points,
                float(of_region[i, j]),
                int(dofs[j]),
                float(self.peak_times[i]),
            )
        return _with_tyre(peaks)

    def generated(self, i: int) -> tuple[Array, Array]:
        """Heat of hysteresis of the section until ``times[i]``, (B,) J, and its power at ``times[i]``, (B,) W."""

        def compute() -> tuple[Array, Array]:
            zones = len(self.solution.batch.model.zones)
            energy = self.solution.energy_until(float(self.times[i]))
            return energy[:, :zones].sum(axis=1), self.powers(i)[:, :zones].sum(axis=1)

        heat: tuple[Array, Array] = self._heats.get(("generated", i), compute)
        return heat

    def powers(self, i: int) -> Array:
        """Heat flows at ``times[i]``, (B, n_entries) W."""
        return np.asarray(
            self._heats.get(("powers", i), lambda: self.solution.powers(float(self.times[i]), self.states[i]))
        )

    def cold_power(self, i: int) -> Array:
        """Power of hysteresis of the section at the initial temperature, just before ``times[i]``, (B,) W."""

        def compute() -> Array:
            batch = self.solution.batch
            start = np.stack([balance.start for balance in batch.balances])[:, : batch.model.size, None]
            q = batch.heat([just_before(self.times, i)], start)
            return np.asarray((batch.heat_flows.power @ q)[:, :, 0].sum(axis=1))

        return np.asarray(self._heats.get(("cold power", i), compute))

    @functools.cached_property
    def end_budgets(self) -> Budget:
        """The section's heat budget at the end; the variants take the place of the times."""
        last = len(self.times) - 1
        return end_budgets(
            self.solution.batch.balances, self.states[-1], self.end_slopes[0], self.powers(last), self.solution.energy
        )

    def end_budget(self, variant: int) -> HeatBudget:
        """The whole tyre's heat budget of a variant at the end."""
        first = self._first_alike[variant]
        written = self._heats.get(
            ("budget names", first), lambda: _budget_names(self.solution.batch.balances[first].alike)
        )
        names, energies, powers, residual, imbalance = self._heats.get(
            ("end budget", written), lambda: self._end_budget(*written)
        )
        return HeatBudget(
            self.times[-1:],
            dict(zip(names[0], energies[variant], strict=True)),
            dict(zip(names[1], powers[variant], strict=True)),
            residual[variant],
            float(imbalance[variant]),
        )

    @functools.cached_property
    def _first_alike(self) -> list[int]:
        """By variant the number of the first one that is like the same tyre."""
        tyres = [balance.alike for balance in self.solution.batch.balances]
        firsts: list[int] = []
        numbers = []
        for number, tyre in enumerate(tyres):
            known = next((first for first in firsts if tyres[first] is tyre), number)
            if known == number:
                firsts.append(number)
            numbers.append(known)
        return numbers

    def _end_budget(
        self, titles: tuple[Any, ...], half: bool, added: tuple[Any, ...]
    ) -> tuple[tuple[list[Any], list[Any]], Array, Array, Array, Array]:
        """Names of energies and powers, their values (B, n, 1), residuals (B, 1) and imbalances (B,)."""
        section = self.end_budgets
        budget = whole_tyre(section, dict(titles), half, dict(added))
        energies, powers = (
            np.stack(list(each.values()), axis=1)[:, :, None] for each in (budget.energies, budget.powers)
        )
        worst = np.abs([section.residual, *section.reservoir_residual.values()]).max(axis=0)
        imbalance = worst / np.where(section.throughput > 0, section.throughput, 1.0)
        names = list(budget.energies), list(budget.powers)
        return names, energies, powers, np.asarray(budget.residual)[:, None], imbalance

    @functools.cached_property
    def end_slopes(self) -> Array:
        """Rates of the states at the end, (1, B, n) 1/s."""
        return self.solution.slopes(self.times[-1:])

    def reservoirs(self, variant: int) -> Mapping[str, Array]:
        """Reservoir (contained air, rim) -> temperature, (n_times,) degC."""
        m = self.solution.batch.model.size
        names = self.solution.batch.balances[variant].reservoirs
        return {name: self.states[:, variant, m + i] for i, name in enumerate(names)}


def _between(
    variant: NDArray[np.intp], first: NDArray[np.intp], last: NDArray[np.intp]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """All pairs (variant, time) with times from ``first`` to ``last``, sorted, without repeats.

    >>> _between(np.array([0, 0, 1]), np.array([0, 2, 1]), np.array([2, 3, 2]))
    (array([0, 0, 0, 0, 1, 1]), array([0, 1, 2, 3, 1, 2]))
    """
    counts = last - first + 1
    variants = np.repeat(variant, counts)
    times = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts) + np.repeat(first, counts)
    pairs = np.unique(variants * (int(last.max()) + 1) + times)
    return pairs // (int(last.max()) + 1), pairs % (int(last.max()) + 1)


def _budget_names(tyre: RollingTyre) -> tuple[tuple[Any, ...], bool, tuple[Any, ...]]:
    """Zone titles, half section or not, added conditions."""
    titles = {zone.name: zone.title for zone in tyre.schedule.zones}
    return tuple(titles.items()), tyre.study.section.half, tuple(tyre.condition_names.items())


def _with_tyre(peaks: dict[str, Peak]) -> dict[str, Peak]:
    return {"tyre": max(peaks.values(), key=lambda peak: peak.temperature)} | peaks


def _peak(points: Array, temperature: float, node: int, time: float) -> Peak:
    return Peak(temperature, (float(points[0, node]), float(points[1, node])), time)
