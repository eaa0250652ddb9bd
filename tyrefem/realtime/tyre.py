"""A tyre's temperatures in real time: a reduced model, read from a file and stepped with numpy alone.

This module imports only numpy and the standard library: copy it beside the file to use both without tyrefem.

    from realtime import Inputs, RealTimeTyre
    tyre = RealTimeTyre("tyre.npz")
    inputs = Inputs(speed=9.0, load=12e3, pressure=572e3, ambient=25.0, road_temperature=30.0)
    for second in range(600):
        tyre.step(1.0, inputs)
    print(dict(zip(tyre.names, tyre.outputs)))
"""

from __future__ import annotations

import json
import math
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
FORMAT = "tyrefem real-time model 2"
#: Unit of every input.
INPUTS = {"speed": "m/s", "load": "N", "pressure": "Pa", "ambient": "degC", "road_temperature": "degC"}
ATMOSPHERE, KELVIN = 101325.0, 273.15
#: (1 - e^-z)/z ~ sum_j b_j / (1 + GAMMA z)^j, from one inverse: e^-z to 2.1e-4 for all z >= 0, exact to z^3, and
#: 0 for stiff modes (minimax fit of these constraints; Norsett 1978 calls them restricted approximations).
GAMMA = 0.1608
PHI = (
    0.1608,
    0.1639717308400497,
    0.06893187963217337,
    1.0202519078323518,
    -3.387098780818439,
    7.08426579225682,
    -5.651785392907301,
    1.5406628631643458,
)
#: (z - 1 + e^-z)/z^2 the same way: heat that changes linearly during a step.
PHI_2 = (0.1608, 0.14191575456053127, 0.19728424543946896)
#: s: longer steps are split into equal parts.
LONGEST = 5.0
#: m/s: a slower wheel stands; the road cools a rolling tread only.
STANDSTILL = 1e-6


@dataclass(frozen=True)
class Inputs:
    """Inputs of a step: m/s, N, Pa (gauge, cold), degC, degC (None: the ambient temperature)."""

    speed: float
    load: float
    pressure: float
    ambient: float
    road_temperature: float | None = None


class RealTimeTyre:
    """A real-time model of a tyre: y' = f(y, inputs), y = (modes of the temperature field, contained air, rim).

    Parameters
    ----------
    file : written by `tyrefem export`. clamp : move inputs outside the certified box to its edge and list them in
        `clamped`, instead of raising.

    Raises
    ------
    ValueError : the file is not a real-time model, or has another format.
    """

    def __init__(self, file: str | Path, *, clamp: bool = False) -> None:
        try:
            # Opened here, as numpy does not close a damaged archive.
            with open(file, "rb") as stream, zipfile.ZipFile(stream), np.load(stream, allow_pickle=False) as stored:
                data = {name: stored[name] for name in stored.files}
            about = json.loads(str(data.pop("about")))
        except FileNotFoundError:
            raise
        except (OSError, ValueError, KeyError, TypeError, AttributeError, EOFError, zipfile.BadZipFile, zlib.error):
            raise ValueError(f"{file}: is not a real-time model") from None
        if about.get("format") != FORMAT:
            raise ValueError(f"{file}: is a '{about.get('format')}', not a '{FORMAT}'")
        self.about: dict[str, Any] = about
        self.clamp, self.clamped = clamp, []  # type: bool, list[str]
        self._data = self.arrays = data
        self.names: list[str] = [output["name"] for output in about["outputs"]]
        self.units: list[str] = [output["unit"] for output in about["outputs"]]
        #: Input -> certified range, SI.
        self.box = {name: (float(low), float(high)) for name, (low, high) in about["box"].items()}
        # Arrays become attributes: a step takes a few dozen microseconds.
        self._rates, self._exchange = data["rates"], data["exchange"].reshape(len(data["exchange"]), -1)
        self._size, self._n = len(data["rates"]), len(data["rates"]) + len(data["capacity"])
        self._samples, self._heating = data["at_samples"], data["heating"]
        width = data["loss_table"].shape[1]
        self._loss, self._row = data["loss_table"].ravel(), data["loss_row"].astype(np.intp) * width
        self._cold, self._per_kelvin, self._last = float(data["loss_axis"][0]), 1 / data["loss_axis"][1], width - 1.001
        tables = (CubicTable(data[f"{name}_table"], data[f"{name}_axes"]) for name in ("film", "heat", "bend"))
        self._films, self._heat, self._bend = tables
        self._read, self._lag, self._power = data["read"], data["lag"], data["power"]
        hot = np.zeros((len(data["hot"]), self._n))
        hot[:, : self._size] = data["hot"]
        self._rows = np.vstack([self._read, hot])
        self._lagging = np.flatnonzero(self._lag > 0)
        self.reset()

    def __repr__(self) -> str:
        box = ", ".join(f"{name} {low:.4g} to {high:.4g} {INPUTS[name]}" for name, (low, high) in self.box.items())
        known = len(self.names)
        return f"RealTimeTyre at {self.time:g} s, {self._size} modes, {known} outputs\n  certified for {box}"

    def reset(self, temperature: float | None = None) -> None:
        """Set all temperatures to one value, degC (default: that of the study); the first step inflates the tyre."""
        start = float(self.about["initial"] if temperature is None else temperature)
        if not math.isfinite(start):
            raise ValueError(f"a temperature must be a number of degC, not {start:g}")
        self.time, self._start, self._filled = 0.0, start, math.nan
        lumped = self._data["lumped_start"]
        self._y = np.concatenate([start * self._data["even"], np.where(np.isnan(lumped), start, lumped)])
        self._air_start = float(self._y[self._size]) if len(self._data["gas"]) else float(self._data["held"])
        self._lagged = np.full(len(self._lagging), start)
        self._matrices_key: tuple[float, ...] = ()
        self._inputs: Inputs | None = None
        self._mass = np.concatenate([np.ones(self._size), self._data["capacity"]])

    @property
    def state(self) -> Array:
        """The complete state of the model; assign it to return to this state."""
        now = [math.nan] * len(INPUTS) if self._inputs is None else _values(self._inputs)
        return np.concatenate([[self.time, self._start, self._filled, *now], self._y, self._lagged])

    @state.setter
    def state(self, state: Array) -> None:
        numbers, first = np.array(state, dtype=float), 3 + len(INPUTS)
        if numbers.shape != (first + self._n + len(self._lagging),):
            raise ValueError(f"a state of this model has {first + self._n + len(self._lagging)} numbers")
        self.reset(float(numbers[1]))
        self.time, filled = float(numbers[0]), float(numbers[2])
        self._y, self._lagged = numbers[first : first + self._n], numbers[first + self._n :]
        if not math.isnan(filled):
            self._fill(filled)
        if not math.isnan(numbers[3]):
            self._inputs = Inputs(*numbers[3:first].tolist())
            load, pressure = self._inputs.load, self._inputs.pressure
            self._per_metre = self._heat(self._deflection_root(load, pressure), pressure)

    def _fill(self, pressure: float) -> None:
        """Set the air's heat capacity from the pressure at the start, as in a full run."""
        self._filled = pressure
        gas = self._data["gas"]
        if len(gas):
            self._mass[self._size] = gas[0] + gas[1] * (pressure + ATMOSPHERE) / (self._air_start + KELVIN)

    def checked(self, inputs: Inputs) -> Inputs:
        """The inputs, moved into the box if ``clamp`` is set.

        Raises
        ------
        ValueError : an input is not a number, or is outside the box and ``clamp`` is not set.
        """
        within, self.clamped = [], []
        for (name, (low, high)), value in zip(self.box.items(), _values(inputs), strict=True):
            near = 1e-9 * max(abs(low), abs(high))
            if not low - near <= value <= high + near:
                message = f"{name} = {value:g} is outside {low:g} to {high:g} {INPUTS[name]}"
                if not self.clamp or math.isnan(value):
                    raise ValueError(message)
                self.clamped.append(message)
            within.append(min(max(float(value), low), high))
        return Inputs(*within)

    def step(self, dt: float, inputs: Inputs, later: Inputs | None = None) -> Array:
        """Advance by ``dt`` seconds and return the `outputs`.

        The inputs are constant, or linear in time up to ``later`` at the end of the step. Speed, load and pressure
        then act by their mean over each part of the step.

        Raises
        ------
        ValueError : an input is outside the certified box, or the step is not positive.
        """
        if not 0 < dt < math.inf:
            raise ValueError(f"a step must be positive, not {dt:g} s")
        first = self.checked(inputs)
        clamped, last = self.clamped, first if later is None else self.checked(later)
        self.clamped = list(dict.fromkeys(clamped + self.clamped)) if later is not None else clamped
        if math.isnan(self._filled):
            self._fill(first.pressure)
        parts = max(1, math.ceil(dt / LONGEST - 1e-9))
        a, b = np.array(_values(first)), np.array(_values(last))
        for k in range(parts):
            self._advance(dt / parts, a + (b - a) * (k / parts), a + (b - a) * ((k + 1) / parts))
        if last != self._inputs:
            self._inputs, self._per_metre = (
                last,
                self._heat(self._deflection_root(last.load, last.pressure), last.pressure),
            )
        return self.outputs

    def _advance(self, h: float, first: Array, last: Array) -> None:
        speed, load, pressure = ((first[:3] + last[:3]) / 2).tolist()
        A, inverse, sinks, heat = self._matrices(h, speed, load, pressure)
        m, y, mass = self._size, self._y, self._mass
        before = self._read[self._lagging] @ y if len(self._lagging) else y
        constant = sinks @ (1.0, first[3], first[4], self._start)
        rate = constant - A @ y
        source = heat * self._loss_tangent(y)
        rate[:m] += self._heating @ source
        u = inverse @ rate
        change = PHI[0] * u
        for b in PHI[1:]:
            u = inverse @ (mass * u)
            change += b * u
        guess = y + h * change
        change_of_rate = sinks @ (1.0, last[3], last[4], self._start) - constant
        change_of_rate[:m] += self._heating @ (heat * self._loss_tangent(guess) - source)
        u = inverse @ change_of_rate
        change = PHI_2[0] * u
        for b in PHI_2[1:]:
            u = inverse @ (mass * u)
            change += b * u
        self._y = guess + h * change
        self.time += h
        if len(self._lagging):
            # Exact if the temperature is linear in time during the step.
            after, lag = self._read[self._lagging] @ self._y, self._lag[self._lagging]
            behind = lag * (after - before) / h
            self._lagged = after - behind + (self._lagged - before + behind) * np.exp(-h / lag)

    def _matrices(self, h: float, speed: float, load: float, pressure: float) -> tuple[Array, Array, Array, Array]:
        """K + sum h R, the step's inverse matrix, sink heat per (1, ambient, road, start), heat per tan delta."""
        key = h, speed, load, pressure, self._filled
        if self._matrices_key != key:
            root = self._deflection_root(load, pressure)
            films = self._films(math.sqrt(speed), root, pressure)
            if speed < STANDSTILL:
                films = self._data["film_standing"]
            A = (films @ self._exchange).reshape(self._n, self._n)
            A.flat[: self._size * (self._n + 1) : self._n + 1] += self._rates
            W = GAMMA * h * A
            W.flat[:: self._n + 1] += self._mass
            sinks = self._data["exchange_load"].T @ (films[:, None] * self._data["sink"])
            self._matrices_key = key
            self._kept_matrices = A, inverse(W), sinks, speed * self._heat(root, pressure)
        return self._kept_matrices

    def _deflection_root(self, load: float, pressure: float) -> float:
        """Root of the deflection, sqrt(m)."""
        return float(self._bend(math.sqrt(load), pressure)[0])

    def _loss_tangent(self, y: Array) -> Array:
        """tan delta at the sample nodes."""
        place = (self._samples @ y[: self._size] - self._cold) * self._per_kelvin
        place = np.minimum(np.maximum(place, 0.0), self._last)
        left = place.astype(np.intp)
        place -= left
        left += self._row
        below = self._loss[left]
        return np.asarray(below + place * (self._loss[left + 1] - below))

    @property
    def outputs(self) -> Array:
        """Values of `names` in `units`: sensors, rim, contained air, hottest point, pressure, rolling resistance.

        Pressure and rolling resistance use the inputs of the last step; they are NaN before the first step.
        """
        outputs = np.empty(len(self.names))
        read_out, inputs = self._rows @ self._y, self._inputs
        read = len(self._read)
        outputs[:read] = read_out[:read]
        outputs[self._lagging] = self._lagged
        air = float(self._y[self._size]) if len(self._data["gas"]) else self._air_start
        pressure = resistance = math.nan
        if inputs is not None:
            pressure = (inputs.pressure + ATMOSPHERE) * (air + KELVIN) / (self._air_start + KELVIN) - ATMOSPHERE
            resistance = 0.0
            if inputs.speed >= STANDSTILL:
                resistance = float(self._power @ (self._per_metre * self._loss_tangent(self._y)))
        outputs[read:] = air, read_out[read:].max(), pressure, resistance
        return outputs


def _values(inputs: Inputs) -> list[float]:
    road = inputs.ambient if inputs.road_temperature is None else inputs.road_temperature
    return [inputs.speed, inputs.load, inputs.pressure, inputs.ambient, road]


class CubicTable:
    """Table on equally spaced axes: cubic through the four nearest points of every axis, or all if there are fewer."""

    def __init__(self, values: Array, axes: Array) -> None:
        self.shape, self.axes = values.shape, [tuple(axis) for axis in np.asarray(axes)[:, :2].tolist()]
        self.values = np.ascontiguousarray(values.reshape(len(values), -1))

    def __call__(self, *place: float) -> Array:
        values = self.values
        for number, (x, (low, high)) in enumerate(zip(place, self.axes, strict=True)):
            n = self.shape[number]
            if n > 1:
                u, width = (x - low) / (high - low) * (n - 1), min(4, n)
                first = min(max(int(u) - 1, 0), n - width)
                values = lagrange(u - first, width) @ values[first : first + width]
            values = values.reshape(self.shape[number + 1], -1)
        return values[:, 0]


def lagrange(u: float, width: int) -> Array:
    """Lagrange weights at u for values at 0, 1, ..., width - 1.

    >>> lagrange(0.5, 2).tolist(), lagrange(1.5, 4).tolist()
    ([0.5, 0.5], [-0.0625, 0.5625, 0.5625, -0.0625])
    """
    if width == 4:
        a, b, c = u - 1, u - 2, u - 3
        return np.array([a * b * c / -6, u * b * c / 2, u * a * c / -2, u * a * b / 6])
    if width == 3:
        return np.array([(u - 1) * (u - 2) / 2, u * (2 - u), u * (u - 1) / 2])
    return np.array([1 - u, u])


def inverse(W: Array) -> Array:
    """Inverse of a symmetric positive definite matrix by blocks: here twice as fast as LAPACK's general inverse.

    >>> inverse(np.array([[2.0, 1.0], [1.0, 2.0]])).round(6).tolist()
    [[0.666667, -0.333333], [-0.333333, 0.666667]]
    """
    k = len(W) // 2
    first = np.linalg.inv(W[:k, :k])
    across = first @ W[:k, k:]
    second = np.linalg.inv(W[k:, k:] - W[k:, :k] @ across)
    corner = across @ second
    result = np.empty_like(W)
    result[:k, :k], result[:k, k:], result[k:, :k], result[k:, k:] = (
        first + corner @ across.T,
        -corner,
        -corner.T,
        second,
    )
    return result
