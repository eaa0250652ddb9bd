"""What a user changes in the arrays and tables of a result changes neither the result nor later runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.api import Result

QUICK = {"mesh.size": "20 mm", "mesh.through": 1, "drive.duration": "20 s", "output.every": "10 s"}

ARRAYS: dict[str, Callable[[Result], Any]] = {
    "times": lambda result: result.times,
    "temperature of the field": lambda result: result.field().temperature,
    "radius of the field": lambda result: result.field().r,
    "temperatures of the history": lambda result: result.history.values,
    "field of the history": lambda result: result.history.field(-1).values,
    "points of a region": lambda result: result.tyre.problem.points("tread"),
    "contained air": lambda result: result.gas_temperature,
    "pressure of the air": lambda result: result.gas_pressure,
    "sensor": lambda result: result.recorded["crown-inner"],
    "column": lambda result: result.reading_columns["contained-air"],
    "gradient of the wall": lambda result: result.wall_gradient[1],
    "gradient at a sensor": lambda result: result.sensor_gradients["crown-inner"],
    "energy": lambda result: result.heat_budget.energies["lost", "rim"],
    "power over time": lambda result: result.heat_budget.columns["lost:rim_W"],
}


@pytest.fixture(scope="module")
def result() -> Result:
    return tf.study("nasa-22x5.5-8pr", QUICK).run()


@pytest.mark.parametrize("name", ARRAYS)
def test_an_array_cannot_be_changed_in_place(result: Result, name: str) -> None:
    """``r *= 1e3`` for a picture in millimetres would have moved the points of every later run on that mesh."""
    values = ARRAYS[name](result)
    before = np.array(values)
    with pytest.raises(ValueError, match="read-only"):
        values *= 1e3
    assert (ARRAYS[name](result) == before).all()


def test_a_changed_table_is_the_users_alone(result: Result) -> None:
    before = result.readings.copy()
    table = result.readings
    table.insert(1, "run", "first")
    table.loc[:, "crown-inner"] = 0.0
    assert result.readings.equals(before)
    assert list(result.gradient_at_sensors) == list(before)
    assert result.readings.attrs["units"]["crown-inner"] == "degC"
    extremes = result.extremes
    extremes.loc[0, "temperature_degC"] = 0.0
    result.extreme_rows[0]["temperature_degC"] = 0.0
    assert result.extremes.loc[0, "temperature_degC"] == result.peaks["tyre"].temperature


def test_a_changed_dataset_is_the_users_alone(result: Result) -> None:
    pytest.importorskip("xarray")
    highest, radius = result.highest.max(), float(result.field().r.max())
    data = result.to_xarray()
    for name in ("temperature", "reading", "gas_temperature", "gas_pressure", "heat_power"):
        data[name] += 273.15
    for name in ("r", "z", "cell_nodes"):
        data[name].values[:] = 0
    assert (result.highest.max(), float(result.field().r.max())) == (highest, radius)


def test_a_changed_grid_is_the_users_alone(result: Result) -> None:
    pytest.importorskip("pyvista")
    highest = result.highest[-1]
    grid = result.to_pyvista()
    grid["temperature_degC"] += 273.15
    assert result.highest[-1] == highest
    assert result.field().temperature.max() == highest
