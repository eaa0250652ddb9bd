"""File of a real-time model: reduced model and tables, stepped by `tyrefem.realtime.tyre` with numpy alone."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.points import located
from tyrefem.errors import InputError
from tyrefem.geometry.meshing.sagitta import kept_inside
from tyrefem.inputs.study import StudyData
from tyrefem.output import atomic_path, jsonable
from tyrefem.output.file import mark_archive
from tyrefem.realtime.tables import COLD, FINE, Probe, Tables, loss_tables
from tyrefem.realtime.tyre import ATMOSPHERE, FORMAT, KELVIN
from tyrefem.reduced.balance import ReducedBalance, reduced_balance
from tyrefem.reduced.model import ReducedModel
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.sensors import true_places
from tyrefem.simulation.surroundings import GAS, RIM

Array = NDArray[np.float64]


def arrays_of(model: ReducedModel, probe: Probe, tables: Tables, hot: Array) -> dict[str, Any]:
    """All arrays that `tyrefem.realtime.tyre` reads, except ``about``.

    The modes are rotated so that sum C M = 1 and sum k K is diagonal: only films change the matrix then.

    Parameters
    ----------
    hot : numbers of the nodes among which the hottest is searched.
    """
    study, middle = probe.study, probe.middle()
    balance = reduced_balance(model, middle.tyre)
    m = model.size
    rates, T = rotation(balance)
    even = np.linalg.solve(T[:m, :m], np.eye(m)[0] / model.V[0, 0])
    table, law = loss_tables(balance.tyre, [(zone, len(points)) for zone, points in model.samples.items()])
    doubled = 2.0 if study.section.half else 1.0
    read, lags = _read(model, study, balance)
    return {
        "rates": rates,
        "exchange": T.T @ balance.stack @ T,
        "exchange_load": balance.loads @ T,
        "capacity": np.diag(balance.M)[m:],
        "lumped_start": _starts(probe),
        "gas": _gas(study, balance.tyre),
        "held": np.array(study.card.boundaries.contained_air.start(study.card.drive.initial)),
        "even": even,
        "heating": T[:m, :m].T @ model.load,
        "power": doubled * model.power.sum(axis=0),
        "at_samples": model.at_samples @ T[:m, :m],
        "loss_table": table,
        "loss_axis": np.array([COLD, FINE]),
        "loss_row": law,
        "read": read @ T,
        "lag": lags,
        "hot": model.V[hot] @ T[:m, :m],
        **tables.arrays(sampled(model)),
    }


def rotation(balance: ReducedBalance) -> tuple[Array, Array]:
    """Rates (m,) 1/s and T (n, n), with T^T M T = 1 and T^T K T = diag(rates) on the modes; reservoirs stay."""
    m, n = balance.model.size, len(balance.start)
    low = np.linalg.inv(np.linalg.cholesky(balance.M[:m, :m]))
    rates, turned = np.linalg.eigh(low @ balance.K[:m, :m] @ low.T)
    T = np.eye(n)
    T[:m, :m] = low.T @ turned
    return rates, T


def outputs_of(study: StudyData, balance: ReducedBalance) -> list[dict[str, str]]:
    """Name, unit and meaning of every output, in order."""
    temperatures = [{"name": name, "unit": "degC", "what": f"sensor {name}"} for name in study.sensors]
    if RIM in balance.reservoirs:
        temperatures.append({"name": RIM, "unit": "degC", "what": "lumped rim"})
    return [
        *temperatures,
        {"name": GAS, "unit": "degC", "what": "contained air"},
        {"name": "hottest", "unit": "degC", "what": "hottest point of the rubber"},
        {"name": "gas_pressure", "unit": "Pa", "what": "gauge pressure of the contained air"},
        {"name": "rolling_resistance", "unit": "N", "what": "drag from hysteresis, heat over speed"},
    ]


def _read(model: ReducedModel, study: StudyData, balance: ReducedBalance) -> tuple[Array, Array]:
    """(n_read, n) rows on the state of sensors and a lumped rim, and their lags, s."""
    places = true_places(study)
    rows = np.zeros((len(places), len(balance.start)))
    lags = []
    if places:
        points = kept_inside(model.base.mesh, list(places.values()))
        rows[:, : model.size] = located(model.operators, points).value() @ model.V
    for name in places:
        lags.append(study.sensors[name].lag + sum(effect.lag_addend(name) for effect in study.effects))
        if any(effect.offset(name) or effect.channel(name) != name or effect.clock() for effect in study.effects):
            raise InputError("effects act on the logger; a real-time model can represent lags only", field="effects")
    lumped = list(balance.reservoirs)
    if RIM in lumped:
        rows = np.vstack([rows, np.eye(len(balance.start))[model.size + lumped.index(RIM)]])
        lags.append(0.0)
    return rows, np.array(lags, dtype=float)


def sampled(model: ReducedModel) -> Array:
    """Numbers of the samples among the nodes of all zones."""
    counts = [len(model.operators.dofs(zone)) for zone in model.zones]
    begins = np.cumsum([0, *counts[:-1]])
    return np.concatenate(
        [begin + points for begin, points in zip(begins, model.samples.values(), strict=True)]
    ).astype(int)


def _starts(probe: Probe) -> Array:
    """Start temperature of contained air and rim, degC; NaN: that of the tyre."""
    first, second = (probe.middle(initial).start[1:] for initial in (20.0, 30.0))
    return np.where(first == second, first, np.nan)


def _gas(study: StudyData, tyre: RollingTyre) -> Array:
    """Coefficients c0, c1 of the air's heat capacity c0 + c1 (p + p_atm) / T, J/K; empty for a given temperature."""
    law, volume, effects = study.card.boundaries.contained_air, study.section.gas_volume(), tyre.acting

    def capacity(pressure: float, temperature: float) -> float | None:
        heat_capacity = law.heat_capacity(volume, pressure, temperature)
        return None if heat_capacity is None else effects.gas_capacity(heat_capacity)

    states = [(1e5, 20.0), (8e5, 20.0), (3e5, 60.0)]
    values = [value for value in (capacity(*state) for state in states) if value is not None]
    if not values:
        return np.zeros(0)
    density = [(pressure + ATMOSPHERE) / (temperature + KELVIN) for pressure, temperature in states]
    slope = (values[1] - values[0]) / (density[1] - density[0])
    base = values[0] - slope * density[0]
    if abs(base + slope * density[2] - values[2]) > 1e-6 * values[2]:
        raise InputError("the heat capacity of the contained air is not that of an ideal gas", field="contained_air")
    return np.array([base, slope])


def write(path: str | Path, arrays: Mapping[str, Any], about: Mapping[str, Any]) -> Path:
    """Write the file; a failure leaves no partial file.

    Parameters
    ----------
    about : study, box, outputs, certificate: the content of `tyrefem.realtime.tyre.RealTimeTyre.about`.
    """
    path = Path(path)
    text = json.dumps(jsonable({"format": FORMAT, **about}))
    with atomic_path(path) as temporary:
        with open(temporary, "wb") as file:
            np.savez_compressed(file, about=np.array(text), **arrays)
        mark_archive(temporary)
    return path
