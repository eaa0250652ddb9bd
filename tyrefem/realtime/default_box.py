"""The box of an exploration, where neither the study nor the user chooses one."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from tyrefem.errors import InputError
from tyrefem.inputs.changes import scaled, value_at
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.strain_laws import strain_law
from tyrefem.quantity import parse
from tyrefem.realtime.few_presses import changes_cycles

#: Ends over the study's value, and K about it.
FACTORS = {"speed": (0.5, 1.5), "load": (0.6, 1.25), "pressure": (0.8, 1.2)}
#: The same with footprints by finite elements, which have no equilibrium in large motion at small loads and high
#: pressures: the passenger radial's ends at 0.58 of its load and 1.24 of its pressure.
PRESSED = {**FACTORS, "load": (0.75, 1.25), "pressure": (0.85, 1.15)}
AROUND = {"ambient": (-20.0, 20.0), "road_temperature": (-20.0, 40.0)}
UNITS = {"speed": "m/s", "load": "N", "pressure": "Pa", "ambient": "degC", "road_temperature": "degC"}
#: Ends of rubber and of films, over the study's value.
LOSS, CONDUCTIVITY, FILM = (0.7, 1.3), (0.7, 1.3), (0.5, 2.0)
#: Regions whose rubber varies: the largest.
REGIONS = 4
#: Numbers of films by side, in the order of preference, with their units.
FILMS = {
    "road": (("coefficient", "W/m**2/K"),),
    "outside_air": (("coefficient", "W/m**2/K"), ("per_speed", "W*s/m**3/K")),
    "contained_air": (("film", "W/m**2/K"),),
}
_AMOUNT = re.compile(r"^\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*(.*?)\s*$")


def default_box(study: StudyData) -> dict[str, Any]:
    """Dotted name -> range: speed, load, pressure, surroundings; tan delta and conductivity by region; films.

    The drives of the study's measured runs lie inside, where they are numbers of this box. With a strain law by finite
    elements, rubber that such a law reads is left out (tan delta of plies whose cords lose energy): every value of it
    would need footprints of its own.

    >>> import tyrefem
    >>> list(default_box(tyrefem.study("nasa-22x5.5-8pr")))[:3]
    ['drive.speed', 'drive.load', 'drive.pressure']
    """
    return _drive(study) | _rubbers(study) | _films(study)


def _drive(study: StudyData) -> dict[str, Any]:
    data = study.data["drive"]
    phases = data.get("phases")
    names = [str(phase.get("name", number)) for number, phase in enumerate(phases or [])]
    # A name with a dot is no part of a dotted name.
    names = [str(number) if "." in name else name for number, name in enumerate(names)]
    box: dict[str, Any] = {}
    for quantity in UNITS:
        used = not phases or any(quantity not in phase for phase in phases)
        keys = {f"drive.{quantity}": data.get(quantity)} if used and (quantity in data or quantity in AROUND) else {}
        keys |= {
            f"drive.phases.{name}.{quantity}": phase[quantity]
            for name, phase in zip(names, phases or [], strict=True)
            if quantity in phase
        }
        for key, value in keys.items():
            span = _span(study, quantity, value)
            if span is not None:
                box[key] = span
    return box


def _span(study: StudyData, quantity: str, value: Any) -> dict[str, str] | None:
    """Range about a written quantity; None for ramps, and for speeds and loads of nothing."""
    measured = [
        run
        for entry in study.measured
        for name, run in entry.drive.items()
        if name.rpartition(".")[2] == quantity and isinstance(run, str)
    ]
    if quantity in AROUND:
        base = _temperature(study, quantity) if value is None else value
        if isinstance(base, Mapping):
            return None
        about = parse(base, "degC") if isinstance(base, str) else float(base)
        runs = [parse(run, "degC") for run in measured]
        low, high = (about + part for part in AROUND[quantity])
        return {"from": f"{min([low, *runs]):.4g} degC", "to": f"{max([high, *runs]):.4g} degC"}
    match = _AMOUNT.match(value) if isinstance(value, str) else None
    if match is None or not float(match[1]) > 0:
        return None
    amount, unit = float(match[1]), match[2]
    runs = [run for run in (parse(run, unit) for run in measured) if run > 0]
    factors = PRESSED if strain_law(study).by_elements else FACTORS
    low, high = (amount * factor for factor in factors[quantity])
    return {"from": f"{_even(min([low, *runs]), -1):.6g} {unit}", "to": f"{_even(max([high, *runs]), 1):.6g} {unit}"}


def _temperature(study: StudyData, quantity: str) -> float:
    phase, law = study.card.drive.phases[0], study.card.boundaries.road.temperature
    ramp = phase.road_temperature if quantity == "road_temperature" else phase.ambient
    if ramp is None:
        return law if law is not None else phase.ambient.start
    return ramp.start


def _even(value: float, away: int) -> float:
    """A number of two digits, not nearer to zero by more than rounding (``away`` = -1: below, 1: above).

    >>> _even(2025.0, -1), _even(3375.0, 1), _even(10.0, -1)
    (2000.0, 3400.0, 10.0)
    """
    step = 10.0 ** (np.floor(np.log10(value)) - 1)
    rounded = np.floor(value / step + 1e-9) if away < 0 else np.ceil(value / step - 1e-9)
    return float(rounded * step)


def _rubbers(study: StudyData) -> dict[str, Any]:
    areas = {region: sum(map(_area, study.section.outline(region, 1e-3))) for region in study.section.regions}
    largest = sorted(areas, key=lambda region: -areas[region])[:REGIONS]
    box: dict[str, Any] = {}
    costly = strain_law(study).by_elements
    for table, factor in (("loss_tangent", LOSS), ("conductivity", CONDUCTIVITY)):
        for region in study.section.regions:
            names = (f"materials.{region}.{table}.{name}" for name in ("value", "table", "across"))
            key = next(filter(None, (_scalable(study, name) for name in names)), None)
            if region in largest and key and not (costly and _read(study, key, factor)):
                box[key] = {"factor": list(factor)}
    return box


def _read(study: StudyData, key: str, factor: tuple[float, float]) -> bool:
    """Does the strain law read a number?"""
    return changes_cycles(study.replace({key: scaled(value_at(study.data, key, study.folder), factor[0])}), study)


def _area(polygon: Any) -> float:
    r, z = np.asarray(polygon).T
    return 0.5 * abs(float(np.dot(r, np.roll(z, -1)) - np.dot(z, np.roll(r, -1))))


def _scalable(study: StudyData, key: str) -> str | None:
    """The key, if the study or its cards have such a number."""
    try:
        scaled(value_at(study.data, key, study.folder), 1.0)
    except InputError:
        return None
    return key


def _films(study: StudyData) -> dict[str, Any]:
    box: dict[str, Any] = {}
    for side, names in FILMS.items():
        law = getattr(study.card.boundaries, side)
        for name, unit in names:
            value = getattr(law, name, None)
            if isinstance(value, float) and value > 0:
                ends = _even(FILM[0] * value, -1), _even(FILM[1] * value, 1)
                box[f"boundaries.{side}.{name}"] = {"from": f"{ends[0]:.6g} {unit}", "to": f"{ends[1]:.6g} {unit}"}
                break
    return box
