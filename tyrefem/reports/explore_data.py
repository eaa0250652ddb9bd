"""What the page of an exploration holds: model, sliders, picture, limits, measured runs, texts to copy."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from tyrefem.cards import read_toml
from tyrefem.errors import InputError
from tyrefem.inputs.changes import all_changed
from tyrefem.inputs.study_plugins import plugin_summary
from tyrefem.output import jsonable, versions
from tyrefem.quantity import parse
from tyrefem.realtime.tyre import GAMMA, PHI, PHI_2
from tyrefem.reports.explore_picture import packed, picture, sensors
from tyrefem.reports.explore_settings import input_roles, measured_runs, slider, start_numbers

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData
    from tyrefem.realtime.box_model import BoxModel
    from tyrefem.variants.varied import Varied


def page_data(model: BoxModel) -> dict[str, Any]:
    """All data of the page, for JSON."""
    study, about = model.study, model.about
    start, phases = start_numbers(model), [phase.name for phase in study.card.drive.phases]
    data = {
        "name": study.name,
        "argument": argument(study),
        "changes": changes_of_file(study),
        "title": study.title,
        "versions": versions(),
        **plugin_summary(study),
        "constants": {"GAMMA": GAMMA, "PHI": PHI, "PHI_2": PHI_2},
        "about": {key: about[key] for key in ("read", "heat", "lost", "factors", "hot")},
        "arrays": {name: packed(values) for name, values in model.arrays.items() if name != "turn"},
        "numbers": [slider(number, first, phases) for number, first in zip(model.plan.varied, start, strict=True)],
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
    """The study as a command takes it: the name by which its file is found from here, or its path from here."""
    from tyrefem import library

    path = study.file_read
    if path is None:
        return study.name
    named = library.names("study").get(study.name)
    if named is not None and named.resolve() == path.resolve():
        return study.name
    return str(path.relative_to(Path.cwd())) if path.is_relative_to(Path.cwd()) else str(path)


def changes_of_file(study: StudyData) -> dict[str, Any]:
    """Dotted name -> value of the study, where it differs from its file: ``--set`` of the command, a case.

    A table in which a name has a dot is one value: a dotted name could not reach into it.
    """
    if study.file_read is None:
        return {}
    try:
        before = read_toml(study.file_read)
    except InputError:
        return {}

    def differences(old: Any, new: Any, name: str) -> Iterator[tuple[str, Any]]:
        if (
            isinstance(old, Mapping)
            and isinstance(new, Mapping)
            and set(old) <= set(new)
            and not any("." in key for key in new)
        ):
            for key, value in new.items():
                yield from differences(old.get(key), value, f"{name}.{key}" if name else key)
        elif old != new:
            yield name, new

    # A study of a campaign has no table of cases any more.
    before.pop("cases", None)
    return dict(differences(before, study.data, ""))


def limits_of(model: BoxModel, start: Sequence[float]) -> list[dict[str, Any]]:
    """Limits of the page, one each for what an answer must be below and above; without any, as hot as the study."""
    given = [
        {"answer": name, "below": None, "above": None, "given": True} | {side: value}
        for name, limit in model.plan.limits.items()
        for side, value in (("below", limit.below), ("above", limit.above))
        if value is not None
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

    data = all_changed(dict(study.data), {number.key: f"@{row}@" for row, number in enumerate(varied)})
    tables = dict.fromkeys(number.key.split(".")[0].replace("-", "_") for number in varied)
    return tomli_w.dumps({table: data[table] for table in tables})
