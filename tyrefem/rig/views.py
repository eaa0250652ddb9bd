"""What cameras and thermocouples see of the patch."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from tyrefem.rig.card import SensorCard
from tyrefem.rig.grid import Grid

Array = NDArray[Any]

_RINGS, _ANGLES = 4, 12


def _disc(radius: float) -> tuple[Array, Array]:
    """Points of equal weight on a disc."""
    rho = radius * np.sqrt((np.arange(_RINGS) + 0.5) / _RINGS)
    angle = (np.arange(_ANGLES) + 0.5) * 2 * np.pi / _ANGLES
    return np.outer(rho, np.cos(angle)).ravel(), np.outer(rho, np.sin(angle)).ravel()


def view(name: str, sensor: SensorCard, grid: Grid, values: Mapping[str, float]) -> csr_matrix:
    """Row (1, unknowns) that takes nodal temperatures to what a sensor sees, before lag and offset.

    The spot's centre lies (spot_along, spot_across) from the mark, the sensor (aside, 0).
    """
    x, y = sensor.aside - values["spot_along"], values["spot_across"]
    if sensor.instrument == "thermocouple":
        return grid.at([np.hypot(x, y)], [values[f"{name}.depth"]])
    depth = 0.0 if sensor.face == "outer" else float(grid.depths[-1])
    if sensor.window == 0:
        return grid.at([np.hypot(x, y)], [depth])
    dx, dy = _disc(sensor.window / 2)
    rows = grid.at(np.hypot(x + dx, y + dy), depth)
    return csr_matrix(rows.mean(axis=0))
