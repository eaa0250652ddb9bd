"""Settings of an exploration: sliders with their labels, the study's numbers, measured runs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.inputs.changes import value_at
from tyrefem.quantity import parse
from tyrefem.realtime.drive_inputs import inputs_of

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.realtime.box_model import BoxModel
    from tyrefem.variants.varied import Varied

Array = NDArray[Any]
#: Relative difference below which a measured run's drive is a setting of the box.
SAME = 1e-5


def start_numbers(model: BoxModel) -> list[float]:
    """The study's numbers, in the units of the sliders; the middle where the study does not say."""
    study = model.study
    of_drive = drive_numbers(model, inputs_of(study)) or {}
    numbers = []
    for row, number in enumerate(model.plan.varied):
        value = of_drive[row] if row in of_drive else _value(study, number)
        numbers.append(float(f"{value:.9g}"))
    return numbers


def _value(study: StudyData, number: Varied) -> float:
    if number.nominal is not None:
        return 1.0
    try:
        value = value_at(study.data, number.key, study.folder)
    except InputError:
        # A default of a law: its SI number.
        table, side, name = (*number.key.split("."), "", "")[:3]
        default = getattr(getattr(study.card.boundaries, side, None), name, None) if table == "boundaries" else None
        if not isinstance(default, float):
            return number.number(0.5)
        return default / parse(f"1 {number.unit}", _si(number.unit)) if number.unit else default
    return parse(value, number.unit) if isinstance(value, str) and number.unit else float(number.of(value))


def _si(unit: str) -> str:
    from tyrefem.quantity import registry

    return str(registry()(unit).to_base_units().units)


def drive_numbers(model: BoxModel, wanted: tuple[Array, float]) -> dict[int, float] | None:
    """Numbers of the drive that give these inputs and this initial temperature; None: no setting of the box does."""
    inputs = model.inputs
    values = np.append(wanted[0].ravel(), wanted[1])
    if len(values) != len(inputs.constant):
        return None
    rows = np.flatnonzero(inputs.slopes.any(axis=1))
    scale = np.maximum(np.abs(values), 1.0)
    A = (inputs.slopes[rows] / scale).T
    right = (values - inputs.constant) / scale
    # A standing wheel carries any load alike.
    solution = np.linalg.lstsq(A, right, rcond=None)[0] if len(rows) else np.zeros(0)
    off = np.abs(A @ solution - right) if len(rows) else np.abs(right)
    if (off > SAME).any():
        return None
    return {int(row): float(value) for row, value in zip(rows, solution, strict=True)}


def input_roles(model: BoxModel) -> dict[str, list[int]]:
    """Input -> the numbers that move it: the page says which sliders are the drive's."""
    slopes = model.inputs.slopes[:, :-1].reshape(len(model.plan.varied), -1, 2, 5)
    names = ("speed", "load", "pressure", "ambient", "road_temperature")
    return {name: np.flatnonzero(slopes[:, :, :, k].any(axis=(1, 2))).tolist() for k, name in enumerate(names)}


#: Last part of a key -> its name for people; unit of the field's.
WORDS = {
    "speed": "speed",
    "load": "load",
    "pressure": "pressure",
    "ambient": "ambient",
    "road_temperature": "road temperature",
    "initial": "start temperature",
    "loss_tangent": "tan δ",
    "conductivity": "conductivity",
    "specific_heat": "specific heat",
    "density": "density",
    "coefficient": "film",
    "film": "film",
    "per_speed": "film over speed",
    "at_rest": "film at rest",
}
SIDES = {"road": "road", "outside_air": "outside air", "contained_air": "contained air", "rim": "rim"}


def label_of(key: str, phases: Sequence[str] = ()) -> tuple[str, str]:
    """Group and label of a slider; ``phases``: names of the drive's phases, for a key that has a number.

    >>> label_of("drive.phases.taxi.speed"), label_of("materials.tread.loss_tangent.value")
    (('Drive', 'speed, taxi'), ('Rubber', 'tan δ, tread'))
    """
    parts = key.split(".")
    match parts:
        case ["drive", name]:
            return "Drive", WORDS.get(name, name.replace("_", " "))
        case ["drive", "phases", phase, name]:
            phase = phases[int(phase)] if phase not in phases and phase.isdigit() and phases else phase
            return "Drive", f"{WORDS.get(name, name.replace('_', ' '))}, {phase}"
        case ["materials", region, table, *rest]:
            name = WORDS.get(table, table.replace("_", " "))
            part = rest[-1] if rest and rest[-1] not in ("value", "table", "across") else ""
            return "Rubber", f"{name}{' ' + part if part else ''}, {region}"
        case ["boundaries", side, name]:
            return "Films", f"{WORDS.get(name, name.replace('_', ' '))}, {SIDES.get(side, side)}"
        case _:
            return "Other", " ".join(parts[1:]) or key


#: Units as people read them.
SYMBOLS = {"degC": "°C", "degF": "°F", "W/m**2/K": "W/m²K", "W*s/m**3/K": "Ws/m³K", "W/m/K": "W/mK", "J/kg/K": "J/kgK"}


def slider(number: Varied, start: float, phases: Sequence[str] = ()) -> dict[str, Any]:
    """A slider: key, group, label, unit, ends, the study's number; ``phases`` as in `label_of`."""
    group, label = label_of(number.key, phases)
    return {
        "key": number.key,
        "group": group,
        "label": label,
        "unit": number.unit,
        "symbol": "×" if number.nominal is not None else SYMBOLS.get(number.unit, number.unit),
        "low": number.low,
        "high": number.high,
        "log": number.log,
        "nominal": number.nominal,
        "start": start,
    }


def measured_runs(model: BoxModel) -> dict[str, Any]:
    """The study's measured runs: settings and readings; and those whose drive is no setting of the box."""
    from tyrefem.compare.experiment import acting_in, driven, experiments

    study = model.study
    shown: list[dict[str, Any]] = []
    left_out: list[dict[str, str]] = []
    if not study.measured:
        return {"runs": shown, "left_out": left_out}
    for experiment in experiments(study):
        run: Any = driven(study, experiment)
        durations = [phase.duration for phase in run.card.drive.phases]
        same = durations == [phase.duration for phase in study.card.drive.phases]
        numbers = drive_numbers(model, inputs_of(run)) if same and not acting_in(study, experiment) else None
        if numbers is None:
            why = "its phases are others" if not same else "its drive needs numbers that do not vary here"
            left_out.append({"name": experiment.name, "why": why})
            continue
        table = experiment.run.temperatures
        known = [name for name in experiment.run.sensors if name in model.about["read"] or name == "contained-air"]
        shown.append(
            {
                "name": experiment.name,
                "hold_out": experiment.hold_out,
                "numbers": {str(place): float(f"{value:.9g}") for place, value in numbers.items()},
                "times": experiment.run.times.tolist(),
                "readings": {name: table[name].tolist() for name in known},
            }
        )
    return {"runs": shown, "left_out": left_out}
