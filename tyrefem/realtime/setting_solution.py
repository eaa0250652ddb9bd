"""A drive marched at one setting: temperatures, heat and limits at any time."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.realtime.setting_coefficients import Coefficients
from tyrefem.realtime.setting_data import SettingData
from tyrefem.realtime.tyre import ATMOSPHERE, KELVIN, STANDSTILL
from tyrefem.variants.answers import highest_name

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Solution:
    """A marched drive.

    Parameters
    ----------
    tyre, coefficients : the model, and its matrices at the setting. times : (n,) s, of the steps' ends, first 0.
    first : number of the first time of every phase. states : (n, n_states). late : (n, n_late) readings of the sensors
        that lag.
    """

    tyre: SettingData
    coefficients: Coefficients
    times: Array
    first: tuple[int, ...]
    states: Array
    late: Array

    def phase(self, t: float) -> int:
        """The phase at a time; its end belongs to it."""
        ends = self.times[[*self.first[1:], len(self.times) - 1]]
        return min(int(np.searchsorted(ends, t - 1e-9)), len(ends) - 1)

    def inputs(self, t: float) -> Array:
        """(5,) inputs at a time."""
        number = self.phase(t)
        begin, duration = self.times[self.first[number]], self.tyre.durations[number]
        start, end = self.coefficients.inputs[number]
        return np.asarray(start + (end - start) * min(max((t - begin) / duration, 0.0), 1.0))

    def weights(self, t: float) -> tuple[int, Array]:
        """First step and weights of the cubic through four steps of the phase, for values at a time."""
        number = self.phase(t)
        low = self.first[number]
        high = self.first[number + 1] if number + 1 < len(self.first) else len(self.times) - 1
        count = min(4, high - low + 1)
        place = int(np.searchsorted(self.times, t, side="right")) - 1
        begin = min(max(place - 1, low), high - count + 1)
        x = self.times[begin : begin + count]
        weights = np.ones(count)
        for i in range(count):
            for j in range(count):
                if i != j:
                    weights[i] *= (t - x[j]) / (x[i] - x[j])
        return begin, weights

    def state(self, t: float) -> Array:
        """State at a time."""
        begin, weights = self.weights(t)
        return weights @ self.states[begin : begin + len(weights)]

    def readings(self, t: float) -> Array:
        """Readings of sensors, then a lumped rim, degC."""
        begin, weights = self.weights(t)
        part = slice(begin, begin + len(weights))
        read = self.tyre.arrays["read"] @ (weights @ self.states[part])
        read[self.tyre.lagging] = weights @ self.late[part]
        return np.asarray(read)

    def at(self, t: float) -> dict[str, float]:
        """Everything that the page shows at a time: name -> value (degC, Pa, N, W)."""
        tyre, c, y, inputs = self.tyre, self.coefficients, self.state(t), self.inputs(t)
        values = dict(zip(tyre.read_names, self.readings(t).tolist(), strict=True))
        air = float(y[tyre.size]) if tyre.has_gas else c.air_start
        hot = tyre.arrays["hot"] @ y[: tyre.size]
        values |= {"contained-air": air, "hottest": float(hot.max())}
        values |= {f"{name}": float(hot[part].max()) for name, part in tyre.hot_parts.items()}
        values["gas_pressure"] = (inputs[2] + ATMOSPHERE) * (air + KELVIN) / (c.air_start + KELVIN) - ATMOSPHERE
        zones, lost = c.heat_flows(y, inputs)
        values |= dict(zip(tyre.heat_names, zones.tolist(), strict=True))
        values |= dict(zip(tyre.loss_names, lost.tolist(), strict=True))
        values["stored"] = float(zones.sum() - lost.sum())
        values |= {"generated": float(zones.sum()), "lost and stored": float(lost.sum()) + values["stored"]}
        speed, load = float(inputs[0]), float(inputs[1])
        force = float(zones.sum()) / speed if speed >= STANDSTILL else 0.0
        values |= {"rolling_resistance": force, "rolling_resistance_coefficient": force / load if load > 0 else 0.0}
        return values

    @functools.cached_property
    def answers(self) -> dict[str, float]:
        """The numbers that limits may name, as in a sweep: name -> value."""
        tyre = self.tyre
        hot = self.states[:, : tyre.size] @ tyre.arrays["hot"].T
        end = self.at(float(self.times[-1]))
        read = self.states @ tyre.arrays["read"].T
        read[:, tyre.lagging] = self.late
        values = {"hottest_degC": float(hot.max())}
        values |= {f"{name[:-4]}_max_degC": float(hot[:, part].max()) for name, part in tyre.hot_parts.items()}
        regions = [name[:-4] for name in tyre.hot_parts]
        for number, name in enumerate(tyre.read_names):
            values |= {f"{name}_degC": end[name], highest_name(name, regions): float(read[:, number].max())}
        air = self.states[:, tyre.size].max() if tyre.has_gas else self.coefficients.air_start
        values |= {"contained-air_degC": end["contained-air"], "contained-air_max_degC": float(air)}
        values["gas_pressure_Pa"] = end["gas_pressure"]
        rolls = self.at(self.rolling_time)
        values["rolling_resistance_N"] = rolls["rolling_resistance"]
        values["rolling_resistance_coefficient"] = rolls["rolling_resistance_coefficient"]
        return values

    @functools.cached_property
    def rolling_time(self) -> float:
        """End of the rolling phase with most heat, s: there the rolling resistance is stated.

        Of a phase that ends at rest or off the road it is the last reading before its end, as in a run.
        """
        best, time = -1.0, 0.0
        ends = [*self.first[1:], len(self.times) - 1]
        rolling = []
        for number, (low, high) in enumerate(zip(self.first, ends, strict=True)):
            inputs = self.coefficients.inputs[number]
            if not (inputs[:, 0].max() >= STANDSTILL and inputs[:, 1].max() > 0):
                continue
            stops = inputs[1, 0] < STANDSTILL or inputs[1, 1] <= 0
            stated = float(self.tyre.arrays["last_readings"][number] if stops else self.times[high])
            if stated > self.times[low] + 1e-6:
                rolling.append((low, high, inputs, self.tyre.durations[number], stated))
        for low, high, (start, end), duration, stated in rolling:
            if len(rolling) == 1:
                return stated
            powers = []
            for i in range(low, high + 1):
                now = start + (end - start) * ((self.times[i] - self.times[low]) / duration)
                powers.append(float(self.coefficients.generated(self.states[i], now).sum()))
            heat = float(np.trapezoid(powers, self.times[low : high + 1]))
            if heat > best:
                best, time = heat, stated
        return time
