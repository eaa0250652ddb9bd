"""A tyre's temperatures in real time: a reduced model read from one file, stepped with numpy and nothing else.

This module imports only numpy and the standard library; it may be copied beside the file and used without tyrefem.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
FORMAT = "tyrefem real-time model 1"
INPUTS = ("speed", "load", "pressure", "ambient", "road_temperature")
#: ROS2 (Verwer et al. 1999): second order with any matrix in place of the Jacobian; L-stable with this coefficient.
_GAMMA = 1 - 1 / np.sqrt(2)


@dataclass(frozen=True)
class Inputs:
    """What acts on the tyre during a step: m/s, N, Pa (gauge, cold), degC, degC."""

    speed: float
    load: float
    pressure: float
    ambient: float
    road_temperature: float


class RealTimeTyre:
    """A tyre that is stepped.

    >>> # tyre = RealTimeTyre("tyre.npz"); tyre.step(1.0, Inputs(9.0, 12e3, 572e3, 25.0, 25.0)); tyre.readings

    Parameters
    ----------
    file : written by `tyrefem.reduced.export.export`.

    Raises
    ------
    ValueError : not such a file, or of another format.
    """

    def __init__(self, file: str | Path) -> None:
        with np.load(file, allow_pickle=False) as stored:
            data = {name: stored[name] for name in stored.files}
        if "about" not in data:
            raise ValueError(f"{file}: is not a real-time model")
        self.about: dict[str, Any] = json.loads(str(data.pop("about")))
        if self.about.get("format") != FORMAT:
            raise ValueError(f"{file}: is a '{self.about.get('format')}', not a '{FORMAT}'")
        self._data = data
        self.M, self.K, self.stack = data["mass"], data["conduction"], data["exchange"]
        self.loads = data["exchange_load"]
        self.size = int(data["at_samples"].shape[1])
        self.output, self.names = data["output"], list(self.about["outputs"])
        self._matrix_of: tuple[Any, ...] = ()
        self.reset(float(self.about["initial"]))

    @property
    def box(self) -> dict[str, tuple[float, float]]:
        """Input -> the range that the model was certified in, SI."""
        return {name: (float(low), float(high)) for name, (low, high) in self.about["box"].items()}

    def reset(self, temperature: float) -> None:
        """Everything at one temperature, degC."""
        self.time = 0.0
        self.state = np.zeros(len(self.M))
        self.state[0] = temperature / float(self._data["even"])
        self.state[self.size :] = temperature

    def outside(self, inputs: Inputs) -> list[str]:
        """Inputs that are outside the certified box, in words."""
        found = []
        for name, (low, high) in self.box.items():
            value = getattr(inputs, name)
            if not low - 1e-9 * abs(low) <= value <= high + 1e-9 * abs(high):
                found.append(f"{name} = {value:g} is outside {low:g} to {high:g}")
        return found

    def step(self, dt: float, inputs: Inputs) -> Array:
        """Go on by ``dt`` seconds under steady inputs; the readings after it.

        Raises
        ------
        ValueError : an input outside the certified box, or a step that is not positive.
        """
        if not dt > 0:
            raise ValueError(f"a step must be positive, not {dt:g} s")
        if wrong := self.outside(inputs):
            raise ValueError("; ".join(wrong))
        A, inverse, constant, heat = self._at(dt, inputs)
        m, y, load = self.size, self.state, self._data["source_load"]
        rate = constant - A @ y
        rate[:m] += load @ (heat * self._loss_tangent(y))
        k1 = inverse @ rate
        guess = y + dt * k1
        rate = constant - A @ guess
        rate[:m] += load @ (heat * self._loss_tangent(guess))
        k2 = inverse @ (rate - 2 * (self.M @ k1))
        self.state = y + dt * (1.5 * k1 + 0.5 * k2)
        self.time += dt
        return self.readings

    @property
    def readings(self) -> Array:
        """Temperatures of `names`, degC."""
        return np.asarray(self.output @ self.state)

    def _at(self, dt: float, inputs: Inputs) -> tuple[Array, Array, Array, Array]:
        key = (dt, inputs)
        if self._matrix_of[:1] != (key,):
            films = _interpolated(self._data, "film", (np.sqrt(inputs.speed), inputs.load, inputs.pressure))
            sinks = self._data["sink"] @ np.array([1.0, inputs.ambient, inputs.road_temperature])
            A = self.K + np.tensordot(films, self.stack, axes=1)
            constant = (films * sinks) @ self.loads
            heat = inputs.speed * _interpolated(self._data, "heat", (inputs.load, inputs.pressure))
            self._matrix_of = (key, A, np.linalg.inv(self.M + _GAMMA * dt * A), constant, heat)
        return self._matrix_of[1:]  # type: ignore[return-value]

    def _loss_tangent(self, state: Array) -> Array:
        """tan delta at the samples."""
        grid, table = self._data["loss_grid"], self._data["loss_table"]
        T = self._data["at_samples"] @ state[: self.size]
        place = np.clip((T - grid[0]) / (grid[1] - grid[0]), 0.0, len(grid) - 1.000001)
        left = place.astype(int)
        zone = self._data["zone_of_sample"]
        below, above = table[zone, left], table[zone, left + 1]
        return np.asarray(below + (place - left) * (above - below))


def _interpolated(data: dict[str, Array], name: str, place: tuple[float, ...]) -> Array:
    """A table over a grid of axes ``NAME_axis_0``, ...: linear in every axis."""
    values = data[f"{name}_table"]
    for number, x in enumerate(place):
        axis = data[f"{name}_axis_{number}"]
        if len(axis) == 1:
            values = values[0]
            continue
        left = min(max(int(np.searchsorted(axis, x, side="right")) - 1, 0), len(axis) - 2)
        part = (x - axis[left]) / (axis[left + 1] - axis[left])
        values = (1 - part) * values[left] + part * values[left + 1]
    return np.asarray(values)
