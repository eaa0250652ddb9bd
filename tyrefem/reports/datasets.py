"""A run as xarray data with units and names, in the manner of the CF conventions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import tyrefem
from tyrefem.errors import MissingLibraryError

if TYPE_CHECKING:
    import xarray

    from tyrefem.simulation.result import ResultData


def _xarray() -> Any:
    try:
        import xarray
    except ImportError:
        message = "xarray is not installed: pip install 'tyrefem[xarray]'; readings and files need no xarray"
        raise MissingLibraryError(message) from None
    return xarray


def _named(values: Any, words: str, unit: str = "") -> tuple[Any, dict[str, str]]:
    return values, {"long_name": words, **({"units": unit} if unit else {})}


def run_dataset(result: ResultData, readings: range | None = None) -> xarray.Dataset:
    """Readings, temperatures at the nodes, heat and contained air over time.

    Dimensions: ``time`` (s), ``sensor``, ``node``, ``cell`` with its ``corner``, ``heat`` (an entry of the budget).
    Variables: ``reading`` (time, sensor) and ``temperature`` (time, node), degC; ``heat_power`` (time, heat), W;
    ``gas_temperature``, ``gas_pressure``; ``cell_nodes`` (cell, corner) and ``region`` (cell) are the mesh.

    Parameters
    ----------
    readings : numbers of the times; None: all.

    Raises
    ------
    MissingLibraryError : xarray is not installed.
    """
    library = _xarray()
    from tyrefem.reports.figures.cells import linear_cells

    chosen = np.arange(len(result.times)) if readings is None else np.asarray(readings)
    operators, section = result.tyre.problem.operators, result.study.section
    cells, parent = linear_cells(operators)
    names = np.empty(result.tyre.mesh.n_elements, dtype=object)
    for region in section.regions:
        names[np.asarray(result.tyre.mesh.mesh.subdomains[region])] = region
    table, powers = result.readings.iloc[chosen], result.heat_budget.powers
    sensors = [name for name in table.columns if name != "time_s"]

    def variable(dims: tuple[str, ...], values: Any, words: str, unit: str = "") -> tuple[Any, ...]:
        return dims, *_named(values, words, unit)

    return library.Dataset(
        {
            "reading": variable(("time", "sensor"), table[sensors].to_numpy(copy=True), "reading of a sensor", "degC"),
            "temperature": variable(("time", "node"), result.history.values[chosen], "temperature", "degC"),
            "gas_temperature": variable(
                ("time",), result.gas_temperature[chosen], "temperature of the contained air", "degC"
            ),
            "gas_pressure": variable(
                ("time",), result.gas_pressure[chosen], "gauge pressure of the contained air", "Pa"
            ),
            "heat_power": variable(
                ("time", "heat"), np.array(list(powers.values())).T[chosen], "power, of the whole tyre", "W"
            ),
            "cell_nodes": variable(("cell", "corner"), np.array(cells.T), "numbers of a cell's nodes, from 0"),
            "region": variable(("cell",), names[parent].astype(str), "region of the section"),
        },
        coords={
            "time": variable(("time",), np.asarray(result.times)[chosen], "time", "s"),
            "sensor": sensors,
            "node": np.arange(operators.size),
            "r": variable(("node",), operators.points[0].copy(), "radius", "m"),
            "z": variable(("node",), operators.points[1].copy(), "axial position", "m"),
            "heat": [f"{kind}: {name}" for kind, name in powers],
        },
        attrs={
            "title": result.study.title,
            "study": result.study.name,
            "source": f"tyrefem {tyrefem.__version__}",
            "Conventions": "CF-1.11",
        },
    )
