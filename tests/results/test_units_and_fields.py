"""Readings with units, fields at a time, and results as xarray, pyvista, Parquet and matplotlib axes."""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib
import numpy as np
import pandas as pd
import pytest
from pyarrow import parquet

import tyrefem as tf
from tyrefem.api import Result
from tyrefem.errors import InputError, MissingLibraryError

QUICK = {"mesh.size": "12 mm", "drive.duration": "60 s"}


@pytest.fixture(scope="module")
def run() -> Result:
    return tf.study("nasa-22x5.5-8pr", QUICK).run()


@pytest.fixture(autouse=True)
def no_window() -> None:
    matplotlib.use("Agg")


def test_readings_have_units(run: Result) -> None:
    units = run.readings.attrs["units"]
    assert list(units) == list(run.readings.columns)
    assert units["time_s"] == "s"
    assert {units[name] for name in run.study.sensors} == {"degC"}


def test_a_field_is_the_reading_nearest_to_its_time(run: Result) -> None:
    field = run.field(31.0)
    i = run.reading_at(31.0)
    assert field.time == run.times[i] == run.times[np.argmin(np.abs(run.times - 31.0))]
    assert (field.temperature == run.history.values[i]).all()
    points = np.column_stack([field.r, field.z])[::40]
    assert field.at(points) == pytest.approx(field.temperature[::40], abs=1e-9)
    assert run.field().time == run.times[-1]
    assert "degC at" in repr(field)
    with pytest.raises(InputError, match="time: the run has times from 0 to 60 s, not 61 s"):
        run.field(61.0)


def test_xarray_has_dimensions_units_and_the_mesh(run: Result) -> None:
    data = run.to_xarray()
    assert data["reading"].dims == ("time", "sensor")
    assert data["temperature"].dims == ("time", "node")
    assert {name: data[name].attrs["units"] for name in ("reading", "temperature", "heat_power", "gas_pressure")} == {
        "reading": "degC", "temperature": "degC", "heat_power": "W", "gas_pressure": "Pa",
    }  # fmt: skip
    assert [data[name].attrs["units"] for name in ("time", "r", "z")] == ["s", "m", "m"]
    crown = data["reading"].sel(sensor="crown-inner")
    assert crown.to_numpy() == pytest.approx(run.readings["crown-inner"].to_numpy())
    # Generated = sliding + stored + lost, in W at every time.
    power = {kind: sum(run.heat_budget.power(kind)) for kind in ("generated", "stored", "lost")}
    by_entry = data["heat_power"].sum("time")
    for kind, total in power.items():
        chosen = [str(name) for name in data["heat"].to_numpy() if str(name).startswith(f"{kind}: ")]
        assert float(by_entry.sel(heat=chosen).sum()) == pytest.approx(total)
    # Cells and regions are the mesh: the area of the tread from its corners.
    corners = np.stack([data["r"].to_numpy(), data["z"].to_numpy()], axis=-1)[data["cell_nodes"].to_numpy()]
    after = np.roll(corners, -1, axis=1)
    areas = np.abs((corners[..., 0] * after[..., 1] - corners[..., 1] * after[..., 0]).sum(axis=1)) / 2
    tread = data["region"].to_numpy() == "tread"
    assert areas[tread].sum() == pytest.approx(run.tyre.mesh.area("tread"), rel=1e-9)
    field = run.field(30.0).to_xarray()
    assert field["temperature"].dims == ("node",)
    assert float(field["time"]) == 30.0


def test_a_missing_xarray_names_the_extra(run: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(MissingLibraryError, match=r"pip install 'tyrefem\[xarray\]'"):
        run.to_xarray()


def test_pyvista_has_the_temperatures_and_the_ring(run: Result) -> None:
    grid = run.to_pyvista(30.0)
    assert grid["temperature_degC"] == pytest.approx(run.field(30.0).temperature)
    assert grid.field_data["TimeValue"][0] == 30.0
    ring = run.field().to_pyvista(revolved=True)
    assert ring.n_points == 72 * grid.n_points
    assert ring["temperature_degC"].max() == pytest.approx(run.field().temperature.max(), rel=1e-6)
    volume = ring.compute_cell_sizes()["Volume"].sum()
    whole = sum(run.tyre.mesh.volume(region) for region in run.study.section.regions)
    assert volume == pytest.approx(72 / (2 * np.pi) * np.sin(2 * np.pi / 72) * whole, rel=1e-4)


def test_parquet_has_full_digits_and_units(run: Result, tmp_path: Path) -> None:
    run.save(tmp_path, parquet=True)
    table = pd.read_parquet(tmp_path / "readings.parquet")
    assert (table.pop("contained-air_pressure_Pa") == run.gas_pressure).all()
    assert table.equals(run.readings)
    schema = parquet.read_schema(tmp_path / "readings.parquet")
    assert {schema.field(name).metadata[b"unit"] for name in run.study.sensors} == {b"degC"}
    assert schema.field("time_s").metadata[b"unit"] == b"s"
    assert schema.field("contained-air_pressure_Pa").metadata[b"unit"] == b"Pa"
    budget = parquet.read_schema(tmp_path / "heat_budget.parquet")
    assert budget.field("energy_J").metadata[b"unit"] == b"J"
    assert budget.field("kind").metadata is None
    assert {file.stem for file in tmp_path.glob("*.parquet")} == {file.stem for file in tmp_path.glob("*.csv")}


@pytest.mark.parametrize("picture", ["temperature", "histories", "heat"])
def test_one_call_draws_on_axes(run: Result, picture: str) -> None:
    from matplotlib import pyplot

    axes = run.plot(picture=picture, time=30.0)
    assert axes.get_xlabel()
    assert axes.get_ylabel()
    if picture == "temperature":
        assert "30 s" in axes.get_title()
    else:
        last = max(float(line.get_xdata()[-1]) for line in axes.lines)
        assert last == pytest.approx(30.0)
    _, (left, right) = pyplot.subplots(1, 2)
    assert run.plot(picture=picture, axes=right) is right
    assert not left.has_data()
    assert right.has_data()
    pyplot.close("all")


def test_an_unknown_picture_names_the_nearest(run: Result) -> None:
    with pytest.raises(InputError, match="no picture 'temprature'; did you mean 'temperature'"):
        run.plot(picture="temprature")


def test_a_field_draws_itself(run: Result) -> None:
    from matplotlib import pyplot

    assert "30 s" in run.field(30.0).plot().get_title()
    pyplot.close("all")
