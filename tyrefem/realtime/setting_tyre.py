"""A tyre at any setting of the numbers that vary: its drive marched with numpy, as the page of `tyrefem explore` does.

The step is that of `tyrefem.realtime.tyre`. Its JavaScript twin is `tyrefem/reports/explore_model.js`.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.realtime.tyre import ATMOSPHERE, GAMMA, KELVIN, PHI, PHI_2, STANDSTILL, CubicTable, inverse

Array = NDArray[np.float64]
#: Shortest step after a jump, s; steps of one length before it doubles; steps of a phase at least, with ramps.
FIRST, REPEATED, LEAST, LEAST_RAMP = 1.0, 3, 10, 24


def step_lengths(duration: float, *, ramp: bool, fineness: int = 1) -> list[float]:
    """Lengths of the steps of a phase, s: short after its start, doubling until there are enough.

    >>> [round(length, 1) for length in step_lengths(60.0, ramp=False)]
    [1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 3.9, 3.9, 3.9, 3.9, 3.9, 3.9, 3.9, 3.9, 3.9, 3.9, 3.9, 3.9, 3.9]
    """
    least = fineness * (LEAST_RAMP if ramp else LEAST)
    lengths: list[float] = []
    length, left = min(FIRST / fineness, duration / least), duration
    while 2 * length * REPEATED < left and 2 * length * least <= duration:
        lengths += [length] * REPEATED
        left -= length * REPEATED
        length *= 2
    count = math.ceil(left / length - 1e-9)
    return lengths + [left / count] * count


@dataclass(frozen=True, eq=False)
class Solution:
    """A marched drive.

    Parameters
    ----------
    tyre, coefficients : the model, and its matrices at the setting. times : (n,) s, of the steps' ends, first 0.
    first : number of the first time of every phase. states : (n, n_states). late : (n, n_late) readings of the sensors
        that lag.
    """

    tyre: SettingTyre
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
        for number, name in enumerate(tyre.read_names):
            values |= {f"{name}_degC": end[name], f"{name}_max_degC": float(read[:, number].max())}
        air = self.states[:, tyre.size].max() if tyre.has_gas else self.coefficients.air_start
        values |= {"contained-air_degC": end["contained-air"], "contained-air_max_degC": float(air)}
        values["gas_pressure_Pa"] = end["gas_pressure"]
        rolls = self.at(self.rolling_time)
        values["rolling_resistance_N"] = rolls["rolling_resistance"]
        values["rolling_resistance_coefficient"] = rolls["rolling_resistance_coefficient"]
        return values

    @functools.cached_property
    def rolling_time(self) -> float:
        """End of the rolling phase with most heat, s: there the rolling resistance is stated."""
        best, time = 0.0, 0.0
        ends = [*self.first[1:], len(self.times) - 1]
        for number, (low, high) in enumerate(zip(self.first, ends, strict=True)):
            start, end = self.coefficients.inputs[number]
            if end[0] < STANDSTILL or end[1] <= 0:
                continue
            powers = []
            for i in range(low, high + 1):
                share = (self.times[i] - self.times[low]) / self.tyre.durations[number]
                powers.append(float(self.coefficients.generated(self.states[i], start + (end - start) * share).sum()))
            heat = float(np.trapezoid(powers, self.times[low : high + 1]))
            if heat > best:
                best, time = heat, float(self.times[high])
        return time


class SettingTyre:
    """The model of all settings of a box.

    Parameters
    ----------
    arrays : those of `tyrefem.realtime.export.arrays_of`, and those of `tyrefem.realtime.setting_arrays`.
    about : names and numbers beside them.
    """

    def __init__(self, arrays: Mapping[str, Array], about: Mapping[str, Any]) -> None:
        self.arrays, self.about = arrays, about
        self.size, self.count = len(arrays["rates"]), len(arrays["rates"]) + len(arrays["capacity"])
        self.has_gas = len(arrays["gas"]) > 0
        self.durations: Array = arrays["durations"]
        self.lagging = np.flatnonzero(arrays["lag"] > 0)
        self.read_names: list[str] = about["read"]
        self.heat_names: list[str] = about["heat"]
        self.loss_names: list[str] = about["lost"]
        ends = np.cumsum([0, *(count for _, count in about["hot"])])
        self.hot_parts = {
            f"{name} max": slice(int(a), int(b)) for (name, _), a, b in zip(about["hot"], ends, ends[1:], strict=False)
        }
        self.films, self.heat, self.bend = (
            CubicTable(arrays[f"{name}_table"], arrays[f"{name}_axes"]) for name in ("film", "heat", "bend")
        )

    def place(self, numbers: Array) -> Array:
        """Places of numbers in the box: 0 and 1 are its ends."""
        low, high, log = self.arrays["low"], self.arrays["high"], self.arrays["log"]
        linear = (numbers - low) / (high - low)
        safe = np.where(log > 0, numbers, 1.0)
        ratio = np.log(safe / np.where(log > 0, low, 1.0)) / np.where(
            log > 0, np.log(np.where(log > 0, high / np.where(log > 0, low, 1.0), 2.0)), 1.0
        )
        return np.where(log > 0, ratio, linear)

    def solve(self, numbers: Array) -> Solution:
        """March the drive at a setting; ``numbers``: (n_numbers,) in their units."""
        c = Coefficients(self, np.asarray(numbers, dtype=float))
        lengths, phases = self.arrays["step_lengths"], self.arrays["step_phases"].astype(int)
        y = np.concatenate([c.initial * self.arrays["even"], c.lumped_start])
        lags = self.arrays["lag"][self.lagging]
        states, late, first = [y], [np.full(len(lags), c.initial)], [0]
        elapsed = 0.0
        for number, (h, phase) in enumerate(zip(lengths.tolist(), phases.tolist(), strict=True)):
            if number and phase != phases[number - 1]:
                first.append(number)
                elapsed = 0.0
            start, end = c.inputs[phase]
            now, later = (start + (end - start) * (t / self.durations[phase]) for t in (elapsed, elapsed + h))
            after = c.step(h, now, later, y)
            read, ahead = (self.arrays["read"][self.lagging] @ each for each in (y, after))
            behind = lags * (ahead - read) / h
            late.append(ahead - behind + (late[-1] - read + behind) * np.exp(-h / lags))
            y = after
            states.append(y)
            elapsed += h
        times = np.concatenate([[0.0], np.cumsum(lengths)])
        return Solution(self, c, times, tuple(first), np.array(states), np.array(late))


class Coefficients:
    """Matrices, films and heat of a tyre at one setting."""

    def __init__(self, tyre: SettingTyre, numbers: Array) -> None:
        self.tyre, arrays = tyre, tyre.arrays
        values = arrays["input_constant"] + numbers @ arrays["input_slopes"]
        self.inputs, self.initial = values[:-1].reshape(-1, 2, 5), float(values[-1])
        place = tyre.place(numbers)
        self.bodies, self.loss = arrays["middle_bodies"].copy(), arrays["loss_table"].copy()
        self.heat_factor, self.sink_addend = np.ones(len(arrays["at_samples"])), np.zeros(len(arrays["sink"]))
        self.film_factor = np.ones((len(arrays["speeds"]), len(arrays["sink"])))
        self.standing_factor, capacity = np.ones(len(arrays["sink"])), np.ones(len(arrays["capacity"]))
        for number, part in tyre.about["factors"]:
            table = arrays[f"factor_{number}_{part}"]
            factor = CubicTable(table.reshape(len(table), -1), np.array([[0.0, 1.0]]))(float(place[number]))
            factor = factor.reshape(table.shape[1:])
            match part:
                case "bodies":
                    self.bodies = self.bodies * factor
                case "films":
                    self.film_factor = self.film_factor * factor
                case "standing":
                    self.standing_factor = self.standing_factor * factor
                case "heat":
                    self.heat_factor = self.heat_factor * factor
                case "loss":
                    self.loss = self.loss * factor
                case "sinks":
                    self.sink_addend = self.sink_addend + factor
                case "capacities":
                    capacity = capacity * factor
        m, n = tyre.size, tyre.count
        share = self.bodies / arrays["middle_bodies"] - 1.0
        self.K = np.zeros((n, n))
        self.K[:m, :m] = np.diag(arrays["rates"]) + np.tensordot(share[:, :2], arrays["stiffness_parts"], axes=2)
        self.M = np.eye(n)
        self.M[:m, :m] += np.tensordot(share[:, 2], arrays["mass_parts"], axes=1)
        self.M[range(m, n), range(m, n)] = arrays["capacity"] * capacity
        self.lumped_start = np.where(np.isnan(arrays["lumped_start"]), self.initial, arrays["lumped_start"])
        self.air_start = float(self.lumped_start[0]) if tyre.has_gas else float(arrays["held"])
        if tyre.has_gas:
            gas, filled = arrays["gas"], float(self.inputs[0, 0, 2])
            density = (filled + ATMOSPHERE) / (self.air_start + KELVIN)
            self.M[m, m] = (gas[0] + gas[1] * density) * capacity[0]
        self._key: tuple[float, ...] = ()

    def step(self, h: float, first: Array, last: Array, y: Array) -> Array:
        """The state after h seconds; inputs go from ``first`` to ``last``."""
        tyre, arrays, m = self.tyre, self.tyre.arrays, self.tyre.size
        speed, load, pressure = ((first[:3] + last[:3]) / 2).tolist()
        key = h, speed, load, pressure
        if self._key != key:
            films = self.films(speed, load, pressure)
            A = self.K + (films @ arrays["exchange"].reshape(len(films), -1)).reshape(tyre.count, tyre.count)
            table = arrays["sink"].copy()
            table[:, 0] += self.sink_addend
            sinks = arrays["exchange_load"].T @ (films[:, None] * table)
            self._key, self._matrices = (
                key,
                (A, inverse(self.M + GAMMA * h * A), sinks, self.heat(speed, load, pressure)),
            )
        A, W, sinks, heat = self._matrices
        constant = sinks @ (1.0, first[3], first[4], self.initial)
        rate = constant - A @ y
        source = heat * self.loss_tangent(y)
        rate[:m] += arrays["heating"] @ source
        u = W @ rate
        change = PHI[0] * u
        for b in PHI[1:]:
            u = W @ (self.M @ u)
            change += b * u
        guess = y + h * change
        change_of_rate = sinks @ (1.0, last[3], last[4], self.initial) - constant
        change_of_rate[:m] += arrays["heating"] @ (heat * self.loss_tangent(guess) - source)
        u = W @ change_of_rate
        change = PHI_2[0] * u
        for b in PHI_2[1:]:
            u = W @ (self.M @ u)
            change += b * u
        return np.asarray(guess + h * change)

    def films(self, speed: float, load: float, pressure: float) -> Array:
        """(n_exchanges,) films, W/m2/K, and conductances, W/K."""
        tyre = self.tyre
        if speed < STANDSTILL:
            return np.asarray(tyre.arrays["film_standing"] * self.standing_factor)
        root = math.sqrt(speed)
        films = tyre.films(root, self._bend(load, pressure), pressure)
        axes = tyre.arrays["film_axes"][:1]
        return np.asarray(films * CubicTable(self.film_factor, axes)(root))

    def heat(self, speed: float, load: float, pressure: float) -> Array:
        """(n_samples,) heat per unit of tan delta, W/m3."""
        return np.asarray(speed * self.tyre.heat(self._bend(load, pressure), pressure) * self.heat_factor)

    def _bend(self, load: float, pressure: float) -> float:
        return float(self.tyre.bend(math.sqrt(load), pressure)[0])

    def loss_tangent(self, y: Array) -> Array:
        """tan delta at the sample nodes."""
        arrays = self.tyre.arrays
        width = self.loss.shape[1]
        place = (arrays["at_samples"] @ y[: self.tyre.size] - arrays["loss_axis"][0]) / arrays["loss_axis"][1]
        place = np.clip(place, 0.0, width - 1.001)
        left = place.astype(int)
        row, place = arrays["loss_row"].astype(int), place - left
        below = self.loss[row, left]
        return np.asarray(below + place * (self.loss[row, left + 1] - below))

    def generated(self, y: Array, inputs: Array) -> Array:
        """(n_zones,) heat of hysteresis in the whole tyre, W."""
        heat = self.heat(*inputs[:3].tolist()) * self.loss_tangent(y)
        return np.asarray(self.tyre.arrays["zone_power"] @ heat)

    def heat_flows(self, y: Array, inputs: Array) -> tuple[Array, Array]:
        """(n_zones,) heat of hysteresis and (n_films,) heat lost through films, whole tyre, W."""
        arrays = self.tyre.arrays
        films = self.films(*inputs[:3].tolist())
        sinks = arrays["sink"] @ (1.0, inputs[3], inputs[4], self.initial) + self.sink_addend
        into = films * (arrays["exchange_rows"] @ y + arrays["exchange_areas"] * sinks)
        return self.generated(y, inputs), -into[: len(self.tyre.loss_names)]
