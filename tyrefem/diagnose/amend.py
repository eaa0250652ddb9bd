"""The amended study: the original study with the missing effects and the corrections that matter."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tyrefem.diagnose.data.residuals import Residuals
from tyrefem.diagnose.numbers import with_sd
from tyrefem.diagnose.unknowns.unknown import Unknown, with_values
from tyrefem.errors import InputError
from tyrefem.inputs.changes import all_changed, by_places, scaled, value_at
from tyrefem.inputs.study import StudyData


@dataclass(frozen=True)
class Change:
    """A number of the amended study: ``x`` and its standard deviation; ``missing``: it belongs to a named effect."""

    unknown: Unknown
    x: float
    sd: float
    missing: bool
    source: str


def changes(
    residuals: Residuals,
    values: Mapping[Unknown, float],
    sd: Mapping[Unknown, float],
    missing: Iterable[Unknown],
) -> tuple[Change, ...]:
    """The changes of a fit: the ``missing`` unknowns, then the corrections of base numbers and sensors.

    A correction is left out if it changes every block mean by less than ``DiagnosisSettings.negligible``.
    """
    fitted = [residuals.runs[number].name for number in residuals.fitted]
    source = f"diagnosis of {residuals.study.name}, fitted to {', '.join(fitted)}"
    missing_unknowns = set(missing)
    kept = []
    for unknown in sorted(values, key=lambda unknown: unknown not in missing_unknowns):
        if unknown in missing_unknowns:
            kept.append(Change(unknown, values[unknown], sd[unknown], True, source))
            continue
        column = residuals.unknowns.index(unknown)
        moved = max(float(np.abs(J[:, column] * values[unknown]).max()) for J in residuals.sensitivities.jacobians)
        if moved > residuals.settings.negligible:
            kept.append(Change(unknown, values[unknown], sd[unknown], False, source))
    return tuple(kept)


def rounded(change: Sequence[Change]) -> dict[Unknown, float]:
    """The values of the changes, each rounded to a hundredth of its standard deviation."""
    return {each.unknown: _rounded(each.x, each.sd) for each in change}


def amended(study: StudyData, change: Sequence[Change]) -> StudyData:
    """The study with the rounded changes and their sources.

    A factor on a number of the drive also applies to the drives of the ``[[measured]]`` runs. A deviation that the
    study states in ``[uncertainty]`` becomes that of the fit.
    """
    totals = rounded(change)
    new = with_values(study, {unknown: x for unknown, x in totals.items() if unknown.effect})
    base = [each for each in change if not each.unknown.effect]
    for each in base:
        for key in each.unknown.keys or (each.unknown.key,):
            new = new.replace({key: _written_value(study, each, key), **_provenance(study, each, key)})
    runs = [dict(entry) for entry in new.data.get("measured", [])]
    for each in base:
        if each.unknown.key.startswith("drive."):
            for entry in runs:
                if "drive" in entry:
                    entry["drive"] = {name: _of_run(new, name, x, each) for name, x in entry["drive"].items()}
    if runs != new.data.get("measured", []):
        new = new.replace({"measured": runs})
    if stated := _deviations(new, base):
        new = new.replace({"uncertainty": {**new.data["uncertainty"], **stated}})
    entries = [dict(entry) for entry in new.data.get("effects", [])]
    for each in change:
        if each.unknown.effect is None:
            continue
        for entry in entries:
            if each.unknown.belongs_to(entry):
                entry["from"] = each.source
                if each.unknown.parameter is None:
                    continue
                unit = each.unknown.unit
                number = float(f"{each.sd:.2g}")
                entry["sd"] = {
                    **entry.get("sd", {}),
                    each.unknown.parameter.name: number if unit == "1" else f"{number!r} {unit}",
                }
    if entries:
        # The named effects stand first in the file.
        named = {each.unknown.effect for each in change if each.missing}
        entries.sort(key=lambda entry: entry["name"] not in named)
        new = new.replace({"effects": entries})
    title = study.title if study.title.endswith("(amended)") else f"{study.title} (amended)"
    return new.replace({"title": title}) if change else new


def _written_value(study: StudyData, change: Change, key: str) -> Any:
    """A changed base number in the units of the study, rounded to a hundredth of its standard deviation."""
    return _scaled(value_at(study.data, key, study.folder), change)


def _scaled(written: Any, change: Change) -> Any:
    """A written base number after a change."""
    digits = max(3, int(np.ceil(-np.log10(max(change.sd, 1e-6) / 100))) + 1)
    return scaled(written, change.unknown.value(change.x), digits)


def _of_run(study: StudyData, name: str, written: Any, change: Change) -> Any:
    """A value of a run's ``drive`` after the change of a number of the drive: of this number, or of a list with it."""
    key = change.unknown.key
    if _place(study, f"drive.{name}") == _place(study, key):
        return _scaled(written, change)
    if not isinstance(written, list) or not key.startswith(f"drive.{name}."):
        return written
    alone = {"drive": {name: written}}
    try:
        return all_changed(alone, {key: _scaled(value_at(alone, key), change)})["drive"][name]
    except InputError:
        # The run has no such phase.
        return written


def _place(study: StudyData, key: str) -> str:
    """The name that a number has however it is written; of what the study's own drive does not have, as it is."""
    try:
        return by_places(study.data, key)
    except InputError:
        return key


def _deviations(study: StudyData, base: Sequence[Change]) -> dict[str, Any]:
    """Name in ``[uncertainty]`` -> deviation after the changes; a deviation stated there replaces that of a card.

    A quantity stays one, of the amended number.
    """
    known = {_place(study, key): each for each in base for key in (*each.unknown.keys, each.unknown.key)}
    deviations: dict[str, Any] = {}
    for key, stated in study.data.get("uncertainty", {}).items():
        change = known.get(_place(study, key))
        if change is None or not change.sd > 0:
            continue
        if not isinstance(study.card.uncertainty[key], str):
            share = f"{100 * change.sd:.2g} %"
            deviations[key] = share if isinstance(stated, str) else float(f"{change.sd:.2g}")
        elif change.unknown.kelvins:
            deviations[key] = f"{change.unknown.kelvins * change.unknown.value(change.x) * change.sd:.2g} K"
        else:
            deviations[key] = scaled(value_at(study.data, key, study.folder), change.sd, 2).lstrip("-")
    return deviations


def _provenance(study: StudyData, change: Change, key: str) -> dict[str, Any]:
    """The new source and standard deviation of a corrected number of a card."""
    # The source and the deviation of a law over frequency stand in the table above it.
    table = key.rpartition(".")[0].removesuffix(".frequency")
    if not table.startswith("materials."):
        return {}
    before = value_at(study.data, f"{table}.source", study.folder)
    value = change.unknown.value(change.x)
    factor = f"factor {with_sd(value, value * change.sd)} by {change.source}"
    return {f"{table}.source": f"{factor}; before: {before}", f"{table}.relative_sd": float(f"{change.sd:.2g}")}


def _rounded(x: float, sd: float) -> float:
    """x, rounded to a hundredth of its standard deviation."""
    if sd <= 0 or not np.isfinite(sd):
        return x
    digits = int(np.ceil(-np.log10(sd / 100)))
    return round(x, digits)


def difference(study: StudyData, new: StudyData) -> list[str]:
    """The unified difference between the files of the study and of the amended study."""
    import difflib

    import tomli_w

    before, after = (tomli_w.dumps(dict(each.data)).splitlines() for each in (study, new))
    return list(difflib.unified_diff(before, after, "study.toml", "amended.toml", n=1, lineterm=""))
