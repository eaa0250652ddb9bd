"""What the page of an exploration holds: model, sliders, picture of the section, measured runs, texts to copy."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.geometry.place_names import place
from tyrefem.inputs.changes import all_changed, value_at
from tyrefem.output import jsonable, versions
from tyrefem.quantity import parse
from tyrefem.realtime.drive_inputs import inputs_of
from tyrefem.realtime.tyre import GAMMA, PHI, PHI_2
from tyrefem.reports.figures.cells import triangles

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.realtime.box_model import BoxModel
    from tyrefem.variants.varied import Varied

Array = NDArray[Any]
#: Nodes of the picture: all unknowns of the mesh up to this number, above it the corners of its elements.
MOST_NODES = 16_000
#: Relative difference below which a measured run's drive is a setting of the box.
SAME = 1e-5
_KINDS = {"f8": np.float64, "f4": np.float32, "i2": np.int16, "i4": np.int32, "u2": np.uint16}


def packed(values: Any, kind: str | None = None) -> dict[str, Any]:
    """An array for the page: shape, kind of its numbers, base64 of its bytes; single precision where it is exact."""
    array = np.asarray(values)
    if kind is None:
        plain = array.astype(np.float64)
        kind = "f4" if plain.size and np.array_equal(plain.astype(np.float32).astype(float), plain) else "f8"
    data = np.ascontiguousarray(array, dtype=np.dtype(_KINDS[kind]).newbyteorder("<"))
    return {"shape": list(data.shape), "type": kind, "data": base64.b64encode(data.tobytes()).decode()}


def page_data(model: BoxModel) -> dict[str, Any]:
    """All data of the page, for JSON."""
    study, about = model.study, model.about
    start = start_numbers(model)
    data = {
        "name": study.name,
        "argument": argument(study),
        "title": study.title,
        "versions": versions(),
        "constants": {"GAMMA": GAMMA, "PHI": PHI, "PHI_2": PHI_2},
        "about": {key: about[key] for key in ("read", "heat", "lost", "factors", "hot")},
        "arrays": {name: packed(values) for name, values in model.arrays.items() if name != "turn"},
        "numbers": [_number(number, first, study) for number, first in zip(model.plan.varied, start, strict=True)],
        "inputs": input_roles(model),
        "phases": [
            {"name": phase.name, "start": begin, "duration": phase.duration}
            for phase, begin in zip(study.card.drive.phases, study.card.drive.starts, strict=True)
        ],
        "picture": picture(model),
        "sensors": sensors(study),
        "certificate": {
            key: getattr(model.certificate, key) for key in ("errors", "field", "tolerance", "cases", "trained_on")
        },
        "limits": limits_of(model, start),
        "axes": axes_of(model),
        "pressure": pressure_unit(study),
        "toml": toml_template(study, model.plan.varied),
        "measured": measured_runs(model),
    }
    return dict(jsonable(data))


def argument(study: StudyData) -> str:
    """The study as a command takes it: its name, or its path from here."""
    from tyrefem import library

    if study.file is None or study.name in library.names("study"):
        return study.name
    path = Path(study.file)
    return str(path.relative_to(Path.cwd())) if path.is_relative_to(Path.cwd()) else str(path)


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


def label_of(key: str) -> tuple[str, str]:
    """Group and label of a slider.

    >>> label_of("drive.phases.taxi.speed"), label_of("materials.tread.loss_tangent.value")
    (('Drive', 'speed, taxi'), ('Rubber', 'tan δ, tread'))
    """
    parts = key.split(".")
    match parts:
        case ["drive", name]:
            return "Drive", WORDS.get(name, name.replace("_", " "))
        case ["drive", "phases", phase, name]:
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


def _number(number: Varied, start: float, study: StudyData) -> dict[str, Any]:
    group, label = label_of(number.key)
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


def picture(model: BoxModel) -> dict[str, Any]:
    """Nodes, triangles and modes of the picture; the modes as integers, column by column: V = low + step q."""
    reduced, section = model.reduced, model.study.section
    operators = reduced.operators
    corners, _ = triangles(operators)
    points, modes = operators.points, reduced.V
    if len(modes) > MOST_NODES:
        vertices = np.asarray(operators.element_dofs)[: 3 if len(operators.element_dofs) in (3, 6) else 4]
        cells = [vertices[[0, 1, 2]]] + ([vertices[[0, 2, 3]]] if len(vertices) == 4 else [])
        used, corners = np.unique(np.concatenate(cells, axis=1).T, return_inverse=True)
        corners = corners.reshape(-1, 3)
    else:
        used = np.arange(len(modes))
    hot = model.arrays["hot_nodes"].astype(int)
    rows = modes[used]
    low, step = rows.min(axis=0), np.maximum(np.ptp(rows, axis=0), 1e-300) / 65000.0
    size = reduced.size
    return {
        "points": packed(points[:, used].T * 1e3, "f4"),
        "triangles": packed(corners, "u2" if len(used) < 65536 else "i4"),
        "modes": packed(np.round((rows - low) / step) - 32500, "i2"),
        "low": packed(low + 32500 * step, "f8"),
        "step": packed(step, "f8"),
        "turn": packed(model.arrays["turn"][:size, :size], "f8"),
        "hot": packed(points[:, hot].T * 1e3, "f8"),
        "where": [place(section, *_located(section, points[:, node])) for node in hot],
        "outlines": [packed(line * 1e3, "f4") for line in outlines(section)],
        "mirror": bool(section.half),
        "regions": region_places(section),
        "colours": base64.b64encode(colours()).decode(),
    }


def _located(section: Any, point: Array) -> tuple[float, float]:
    s, depth = section.locate(point[None])
    return float(np.ravel(s)[0]), float(np.ravel(depth)[0])


def outlines(section: Any) -> list[Array]:
    """Borders of all regions, (k, 2) m in (r, z), broken at the mid plane of a half section."""
    lines = []
    for region in section.regions:
        for polygon in section.outline(region, 1e-3):
            closed = np.vstack([polygon, polygon[:1]])
            cut = (np.abs(closed[:-1, 1]) < 1e-9) & (np.abs(closed[1:, 1]) < 1e-9) & section.half
            begin = 0
            for end in [*(np.flatnonzero(cut) + 1).tolist(), len(closed)]:
                if end - begin > 1:
                    lines.append(closed[begin:end])
                begin = end
    return lines


def region_places(section: Any) -> list[dict[str, Any]]:
    """Region -> the middle of its longest piece, mm."""
    places = []
    for region in section.regions:
        piece = max((p for p in section.pieces if p.region == region), key=lambda p: p.end - p.start)
        s = piece.start + (0.62 if piece.layer else 0.5) * (piece.end - piece.start)
        faces = section.interfaces(s)
        depth = float((faces[piece.layer] + faces[piece.layer + 1]) / 2 - faces[0])
        r, z = np.ravel(section.place(s, depth))
        places.append({"name": region, "r": float(r) * 1e3, "z": float(z) * 1e3})
    return places


def colours() -> bytes:
    """256 colours of temperature, red, green and blue bytes, from cold to hot."""
    from matplotlib import colormaps

    from tyrefem.reports.figures.style import temperature_map

    chosen: Any = temperature_map()
    table = colormaps[chosen] if isinstance(chosen, str) else chosen
    return bytes((table(np.linspace(0, 1, 256))[:, :3] * 255).round().astype(np.uint8).tobytes())


def sensors(study: StudyData) -> list[dict[str, Any]]:
    """Name, place in mm, region and lag of every sensor."""
    from tyrefem.simulation.sensors import true_places

    section, listed = study.section, []
    for name, (r, z) in true_places(study).items():
        s, depth = _located(section, np.array([r, z]))
        listed.append(
            {
                "name": name, "r": r * 1e3, "z": z * 1e3, "where": place(section, s, depth),
                "noise": study.sensors[name].noise, "lag": study.sensors[name].lag,
            }
        )  # fmt: skip
    return listed


def limits_of(model: BoxModel, start: Sequence[float]) -> list[dict[str, Any]]:
    """Limits of the page; without any, as hot as the study itself."""
    given = [
        {"answer": name, "below": limit.below, "above": limit.above, "given": True}
        for name, limit in model.plan.limits.items()
    ]
    if given:
        return given
    hottest = model.solve(start).answers["hottest_degC"]
    return [{"answer": "hottest_degC", "below": float(np.ceil(hottest)), "above": None, "given": False}]


def axes_of(model: BoxModel) -> list[int]:
    """The numbers of the envelope's axes: those of the study, else load and speed, else the first two."""
    keys = [number.key for number in model.plan.varied]
    if model.axes is not None:
        return [keys.index(key) for key in model.axes]
    roles = input_roles(model)
    first = next(iter(roles["load"]), 0)
    second = next((number for number in roles["speed"] if number != first), None)
    if second is None:
        second = next((number for number in range(len(keys)) if number != first), first)
    return [first, second]


def pressure_unit(study: StudyData) -> dict[str, Any]:
    """Unit of the contained air's pressure, as the study writes it, and its value in Pa."""
    drive = study.data["drive"]
    text = drive.get("pressure") or next((p.get("pressure") for p in drive.get("phases", []) if "pressure" in p), "")
    unit = text.strip().lstrip("+-.0123456789eE").strip() if isinstance(text, str) else ""
    try:
        return {"unit": unit, "pascal": parse(f"1 {unit}", "Pa")} if unit else {"unit": "kPa", "pascal": 1e3}
    except InputError:
        return {"unit": "kPa", "pascal": 1e3}


def toml_template(study: StudyData, varied: Sequence[Varied]) -> str:
    """The tables of the study that sliders change; ``"@3@"`` stands for the value of number 3."""
    import tomli_w

    data = all_changed(dict(study.data), {number.key: f"@{place}@" for place, number in enumerate(varied)})
    tables = dict.fromkeys(number.key.split(".")[0].replace("-", "_") for number in varied)
    return tomli_w.dumps({table: data[table] for table in tables})


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
