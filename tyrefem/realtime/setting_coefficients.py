"""Matrices, films and heat of a tyre at one setting of the numbers that vary, and its step in time."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from tyrefem.realtime.setting_data import SettingData
from tyrefem.realtime.tyre import ATMOSPHERE, GAMMA, KELVIN, PHI, PHI_2, STANDSTILL, CubicTable, inverse

Array = NDArray[np.float64]


class Coefficients:
    """Matrices, films and heat of a tyre at one setting."""

    def __init__(self, tyre: SettingData, numbers: Array) -> None:
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
