"""What is read off a batch of reduced variants at once: sensors, hottest places, walls, heat."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.history import Peak
from tyrefem.reduced.marched import Marched
from tyrefem.rolling_resistance import just_before

Array = NDArray[np.float64]


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
        return self._at(np.asarray(points, dtype=float).tobytes(), len(points))

    @functools.cache  # noqa: B019 - lives as long as the batch
    def _at(self, key: bytes, count: int) -> Array:
        points = np.frombuffer(key).reshape(count, 2)
        return self.modes @ self.marched.batch.model.rows(points).T

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
        return modes @ model.V[model.hot[region]].T

    @functools.cached_property
    def peaks(self) -> list[dict[str, Peak]]:
        """Of every variant: ``tyre`` and every region -> its highest temperature, with place and time."""
        model, count = self.marched.batch.model, self.states.shape[1]
        modes, when, found = self._seen[:, :, : model.size], {}, {}
        for region, hot in model.hot.items():
            values = self._candidates(region, modes).transpose(1, 0, 2).reshape(count, -1)
            best = values.argmax(axis=1)
            when[region] = best // len(hot)
            found[region] = values[np.arange(count), best], np.asarray(hot)[best % len(hot)]
        # All nodes at these times: is any hotter than those that were looked at?
        moments = {(int(i), b) for times in when.values() for b, i in enumerate(times)}
        column = {moment: k for k, moment in enumerate(sorted(moments))}
        everywhere = model.V @ np.array([modes[moment] for moment in column]).T
        missed: set[int] = set()
        for region, dofs in model.regions.items():
            most = everywhere[dofs].max(axis=0)
            for b, i in enumerate(when[region]):
                if most[column[int(i), b]] > found[region][0][b] + 1e-9:
                    missed.add(b)
        points, peaks = model.operators.points, []
        for b in range(count):
            if b in missed:
                peaks.append(self._searched(b))
                continue
            peaks.append(
                _with_tyre(
                    {
                        region: _peak(points, float(T[b]), int(node[b]), float(self.looked[when[region][b]]))
                        for region, (T, node) in found.items()
                    }
                )
            )
        return peaks

    def _searched(self, variant: int) -> dict[str, Peak]:
        """Over all nodes and times."""
        model = self.marched.batch.model
        values, found = self._seen[:, variant, : model.size] @ model.V.T, {}
        for region, dofs in model.regions.items():
            own = values[:, dofs]
            i, j = np.unravel_index(int(np.argmax(own)), own.shape)
            found[region] = _peak(model.operators.points, float(own[i, j]), int(dofs[j]), float(self.looked[i]))
        return _with_tyre(found)

    @functools.cache  # noqa: B019 - lives as long as the batch
    def generated(self, i: int) -> tuple[Array, Array]:
        """Heat of hysteresis (B,) of the section until ``times[i]``, J, and then, W."""
        zones = len(self.marched.batch.model.zones)
        energy = self.marched.energy_until(float(self.times[i]))
        return energy[:, :zones].sum(axis=1), self.powers(i)[:, :zones].sum(axis=1)

    @functools.cache  # noqa: B019 - lives as long as the batch
    def powers(self, i: int) -> Array:
        """(B, n_entries) W at ``times[i]``."""
        return self.marched.powers(float(self.times[i]), self.states[i])

    @functools.cache  # noqa: B019 - lives as long as the batch
    def cold_power(self, i: int) -> Array:
        """(B,) W of hysteresis of the section just before ``times[i]``, all of it at the initial temperature."""
        batch = self.marched.batch
        start = np.stack([one.start for one in batch.balances])[:, : batch.model.size, None]
        q = batch.heat([just_before(self.times, i)], start)
        return (batch.model.power @ q)[:, :, 0].sum(axis=1)

    @functools.cached_property
    def end_slopes(self) -> Array:
        """(1, B, n) 1/s at the end."""
        return self.marched.slopes(self.times[-1:])

    def reservoirs(self, variant: int) -> Mapping[str, Array]:
        """Gas, rim -> (n_times,) degC."""
        m = self.marched.batch.model.size
        names = self.marched.batch.balances[variant].reservoirs
        return {name: self.states[:, variant, m + i] for i, name in enumerate(names)}


def _with_tyre(peaks: dict[str, Peak]) -> dict[str, Peak]:
    return {"tyre": max(peaks.values(), key=lambda one: one.temperature)} | peaks


def _peak(points: Array, temperature: float, node: int, time: float) -> Peak:
    return Peak(temperature, (float(points[0, node]), float(points[1, node])), time)
