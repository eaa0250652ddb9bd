"""A certified reduced model saved to one file that `tyrefem.realtime` steps with numpy alone."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.points import located
from tyrefem.errors import InputError
from tyrefem.heating import HeatSource
from tyrefem.output import atomic_path
from tyrefem.realtime import FORMAT
from tyrefem.reduced.batch import COLD, FINE, HOT
from tyrefem.reduced.model import ReducedBalance, ReducedModel
from tyrefem.reduced.surrogate import Surrogate
from tyrefem.result import GAS, RIM
from tyrefem.rolling import RollingTyre
from tyrefem.sensors import true_places
from tyrefem.studies import Study
from tyrefem.summary import versions
from tyrefem.sweep.varied import Varied

Array = NDArray[np.float64]
#: Input of the file -> dotted name of the study.
DRIVEN = {
    "speed": "drive.speed",
    "load": "drive.load",
    "pressure": "drive.pressure",
    "ambient": "drive.ambient",
    "road_temperature": "drive.road_temperature",
}
#: Points of the tables over speed (even in its square root), load and pressure.
POINTS = {"speed": 41, "load": 21, "pressure": 9}


def export(found: Surrogate, study: Study, path: str | Path) -> Path:
    """Write a real-time model.

    Parameters
    ----------
    found : certified in a box of `DRIVEN` names; those that it does not vary are fixed at the study's own value.
    study : the study it was trained for, of one steady phase.
    path : ``.npz`` file.

    Raises
    ------
    InputError : a drive of several phases or ramps, effects on the heat, a box of something else.
    """
    from tyrefem.quantity import parse

    phases = study.card.drive.phases
    if len(phases) != 1:
        raise InputError("needs a drive of one steady phase", field="drive")
    others = [one.key for one in found.varied if one.key not in DRIVEN.values()]
    if others:
        raise InputError(f"the box varies '{others[0]}'; allowed: {', '.join(DRIVEN.values())}")
    units = {"speed": "m/s", "load": "N", "pressure": "Pa", "ambient": "degC", "road_temperature": "degC"}
    ranges = {one.key: one for one in found.varied}
    box, axes = {}, {}
    for name, key in DRIVEN.items():
        ends = _ends(ranges.get(key), study, name, lambda text, name=name: parse(text, units[name]))
        box[name] = ends
        if name in POINTS:
            count = POINTS[name] if ends[1] > ends[0] else 1
            low, high = (np.sqrt(ends[0]), np.sqrt(ends[1])) if name == "speed" else ends
            axes[name] = np.linspace(low, high, count)
    model = found.model
    arrays = _constant(model, study) | _tables(model, study, axes)
    names, output = _outputs(model, study)
    about = {
        "format": FORMAT,
        "study": study.name,
        "title": study.title,
        "box": box,
        "outputs": names,
        "initial": study.card.drive.initial,
        "certificate": {
            "largest_error_K": found.certificate.worst,
            "fresh_cases": found.certificate.cases,
            "training_runs": found.certificate.trained_on,
        },
        "versions": versions(),
    }
    path = Path(path)
    with atomic_path(path) as temporary, open(temporary, "wb") as file:
        np.savez_compressed(file, about=np.array(json.dumps(about)), output=output, **arrays)
    return path


def _ends(one: Varied | None, study: Study, name: str, parsed: Any) -> tuple[float, float]:
    if one is not None:
        return parsed(one.at(0.0)), parsed(one.at(1.0))
    phase = study.card.drive.phases[0]
    ramp = getattr(phase, name)
    value = study.card.drive.value("ambient", 0.0) if ramp is None else ramp.start
    return float(value), float(value)


def _at(study: Study, **inputs: float) -> Study:
    units = {"speed": "m/s", "load": "N", "pressure": "Pa", "ambient": "degC", "road_temperature": "degC"}
    return study.replace({DRIVEN[name]: f"{value:.12g} {units[name]}" for name, value in inputs.items()})


def _balance(model: ReducedModel, study: Study) -> ReducedBalance:
    return model.balance(RollingTyre(study, model.base))


def _constant(model: ReducedModel, study: Study) -> dict[str, Array]:
    balance = _balance(model, study)
    grid = np.arange(COLD, HOT + FINE / 2, FINE)
    sources = balance.tyre.sources
    if not all(type(one) is HeatSource for one in sources.values()):
        raise InputError("effects act on the heat: a real-time model knows only the strain cycle's", field="effects")
    zones = list(model.sample_slices.items())
    return {
        "mass": balance.M,
        "conduction": balance.K,
        "exchange": balance.stack,
        "exchange_load": balance.loads,
        "sink": _sinks(model, study),
        "source_load": model.load,
        "at_samples": model.at_samples,
        "even": np.array(model.V[0, 0]),
        "zone_of_sample": np.concatenate([np.full(part.stop - part.start, z) for z, (_, part) in enumerate(zones)]),
        "loss_grid": grid,
        "loss_table": np.array([sources[zone].loss_tangent(grid) for zone, _ in zones]),  # type: ignore[union-attr]
    }


def _sinks(model: ReducedModel, study: Study) -> Array:
    """(n_exchanges, 3): every sink is c + a ambient + b road temperature."""
    base = {"ambient": 20.0, "road_temperature": 20.0}

    def sinks(**changed: float) -> Array:
        return _balance(model, _at(study, **(base | changed))).coefficients(0.0)[1]

    still = sinks()
    by_air, by_road = ((sinks(**{name: 21.0}) - still) for name in ("ambient", "road_temperature"))
    return np.column_stack([still - 20.0 * (by_air + by_road), by_air, by_road])


def _tables(model: ReducedModel, study: Study, axes: Mapping[str, Array]) -> dict[str, Array]:
    """Films over (sqrt speed, load, pressure); heat per speed and tan delta at the samples over (load, pressure)."""
    films, heats = [], []
    for speed in axes["speed"] ** 2:
        for load in axes["load"]:
            for pressure in axes["pressure"]:
                inputs = {"speed": float(speed), "load": float(load), "pressure": float(pressure)}
                balance = _balance(model, _at(study, **inputs))
                films.append(balance.coefficients(0.0)[0])
                if speed == axes["speed"][-1] ** 2:
                    heats.append(_heat(model, balance) / float(speed))
    shape = tuple(len(axes[name]) for name in ("speed", "load", "pressure"))
    found = {"film_table": np.array(films).reshape(*shape, -1), "heat_table": np.array(heats).reshape(*shape[1:], -1)}
    for number, name in enumerate(("speed", "load", "pressure")):
        found[f"film_axis_{number}"] = axes[name]
    for number, name in enumerate(("load", "pressure")):
        found[f"heat_axis_{number}"] = axes[name]
    return found


def _heat(model: ReducedModel, balance: ReducedBalance) -> Array:
    """Strain energy x revolution rate x convention at the samples."""
    parts = []
    for zone in model.zones:
        source = balance.tyre.sources[zone]
        rate = source.loss_factor * source.schedule.revolution_rate(0.0)  # type: ignore[union-attr]
        parts.append(rate * source.energy_density(model.sample_points[zone], 0.0))  # type: ignore[union-attr]
    return np.concatenate(parts)


def _outputs(model: ReducedModel, study: Study) -> tuple[list[str], Array]:
    """Sensors (without lag), contained air and rim, as rows on the state."""
    balance = _balance(model, study)
    places = true_places(study)
    section = study.section
    s, depth = section.locate(np.array(list(places.values())).reshape(-1, 2))
    points = section.place(*section.clamp(s, depth, model.base.mesh.size**2 / 0.1))
    rows = np.zeros((len(places), len(balance.start)))
    rows[:, : model.size] = located(model.operators, points).value() @ model.V
    names, lumped = list(places), list(balance.reservoirs)
    for name in (GAS, RIM):
        if name in lumped:
            names.append(name)
            rows = np.vstack([rows, np.eye(len(balance.start))[model.size + lumped.index(name)]])
    return names, rows
