"""Change one value of a study by its dotted name: ``drive.speed``, ``section.crown_radius``, ``sensors.crown.s``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tyrefem import library
from tyrefem.cards.entries import entry_number
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.deviations import has_arbitrary_zero
from tyrefem.inputs.drive_table import EXCLUSIVE_KEYS
from tyrefem.quantity import KELVIN, amount_parts, parse, written
from tyrefem.quantity.factors import FACTORS
from tyrefem.sizes import completed_materials, is_size, with_numbers
from tyrefem.sizes.section import NUMBERS

#: Tables whose text value names a card: a change of a value below it overrides the card's value.
_REFERENCES = {"section": "section", "materials.*": "material"}


def changed(data: Mapping[str, Any], key: str, value: Any) -> dict[str, Any]:
    """Copy plain data with the value at a dotted name replaced.

    >>> changed({"section": "nasa"}, "section.crown_radius", "3 in")
    {'section': {'base': 'nasa', 'parameters': {'crown_radius': '3 in'}}}
    """
    return all_changed(data, {key: value})


def check_changes_table(changes: object) -> None:
    """Raise `InputError` for changes that are no table of dotted names."""
    if not isinstance(changes, Mapping):
        raise InputError(f"changes must be a table like {{'drive.speed': '25 mph'}}, not {changes!r:.60}")
    for key in changes:
        if not isinstance(key, str):
            raise InputError(f"{key!r:.60} is not a dotted name such as drive.speed")


def all_changed(data: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Copy plain data with the values at dotted names replaced, in order; unchanged tables are shared.

    >>> all_changed({"mesh": {}}, {"mesh.size": "3 mm", "mesh.element": "P1"})
    {'mesh': {'size': '3 mm', 'element': 'P1'}}
    """
    check_changes_table(changes)
    result: dict[str, Any] = dict(data)
    copied: set[str] = set()
    for key, value in changes.items():
        parts = _parts(result, key)
        table = parts[0]
        if table in result and table not in copied:
            result[table] = written(result[table])
            copied.add(table)
        _change(result, key, parts, written(value))
    return result


def _change(data: dict[str, Any], key: str, parts: list[str], value: Any) -> None:
    _refuse_overridden(data, parts)
    if parts[0] == "section":
        _as_table(data, parts)
    place: Any = data
    for depth, part in enumerate(parts[:-1]):
        place = _step(place, part, ".".join(parts[: depth + 1]), parts[: depth + 1])
    last = parts[-1]
    if isinstance(place, list):
        place[entry_number(place, last, key)] = value
    else:
        place[last] = value
        _drop_exclusive(parts, place)
        _drop_other_name(data, parts)


def _drop_other_name(data: Mapping[str, Any], parts: list[str]) -> None:
    """Leave out the other name of a number of a size, which stands in the table or in its ``parameters``."""
    section = data.get("section")
    if parts[0] == "section" and parts[-1] in NUMBERS and isinstance(section, dict) and is_size(section):
        other = section.get("parameters") if len(parts) == 2 else section
        if isinstance(other, dict) and parts[1:-1] in ([], ["parameters"]):
            other.pop(parts[-1], None)


def _as_table(data: dict[str, Any], parts: list[str]) -> None:
    """A size as a table, so that its numbers can be set; a size in place of a card, a card in place of a size."""
    section = data.get("section")
    if isinstance(section, str) and is_size(section) and len(parts) > 1:
        data["section"] = {"size": section}
    elif parts[1:] in (["size"], ["base"]) and not (isinstance(section, Mapping) and parts[1] in section):
        data["section"] = {}


def canonical(data: Mapping[str, Any], key: str) -> str:
    """The full dotted name: with the table that a short name leaves out.

    >>> canonical({"section": "nasa-22x5.5-8pr"}, "section.crown_radius")
    'section.parameters.crown_radius'
    """
    return ".".join(_parts(data, key))


def by_places(data: Mapping[str, Any], key: str) -> str:
    """The full dotted name with entries of lists by their numbers: the same for all names of one number of a study.

    >>> phases = {"drive": {"phases": [{"name": "rolling", "speed": "20 mph"}]}}
    >>> by_places(phases, "drive.phases.rolling.speed"), by_places(phases, "drive.phases.0.speed")
    ('drive.phases.0.speed', 'drive.phases.0.speed')
    """
    place: Any = data
    parts = _parts(data, key)
    for depth, part in enumerate(parts):
        if isinstance(place, list):
            parts[depth] = str(entry_number(place, part, key))
            place = place[int(parts[depth])]
        else:
            place = place.get(part) if isinstance(place, Mapping) else None
    return ".".join(parts)


def check_compatible(data: Mapping[str, Any], changes: Mapping[str, Any]) -> None:
    """Raise `InputError` for changes that belong together, of which one would undo another.

    That is one number by two names, or alternatives such as a load and a deflection.

    >>> check_compatible({"drive": {}}, {"drive.load": "2 kN", "drive.deflection": "20 mm"})
    Traceback (most recent call last):
    ...
    tyrefem.errors.InputError: drive.deflection: 'drive.load' sets it too: give one of them
    """
    after = all_changed(data, changes)
    given: dict[str, str] = {}
    for key in changes:
        for place in alternatives(after, key):
            if place in given:
                raise InputError(f"'{given[place]}' sets it too: give one of them", field=key)
        given[by_places(after, key)] = key


def alternatives(data: Mapping[str, Any], key: str) -> list[str]:
    """The full dotted name of a number, and those of the drive's numbers that it replaces.

    >>> alternatives({"drive": {"phases": [{"name": "taxi"}]}}, "drive.phases.taxi.load")
    ['drive.phases.0.load', 'drive.phases.0.deflection']
    """
    place = by_places(data, key)
    table, _, name = place.rpartition(".")
    others = EXCLUSIVE_KEYS.get(name, []) if place.startswith("drive.") else []
    return [place, *(f"{table}.{other}" for other in others)]


def _parts(data: Mapping[str, Any], key: str) -> list[str]:
    parts = [part.strip().replace("-", "_") if i == 0 else part.strip() for i, part in enumerate(key.split("."))]
    if not all(parts):
        raise InputError(f"'{key}' is not a dotted name such as drive.speed")
    if parts[0] == "uncertainty" and len(parts) > 1:
        # Its keys are dotted names.
        return ["uncertainty", ".".join(parts[1:])]
    if parts[:2] == ["section", "layers"] and parts[3:] == ["angle"]:
        return ["materials", _cord_region(data, parts[2], key), "cords", "angle"]
    if parts == ["section", "parameters", "rim_width"] and is_size(data.get("section")):
        return ["section", "rim_width"]
    if parts[0] == "section" and len(parts) >= 2 and parts[1] != "base":
        return [*_section_parts(parts[1]), *parts[2:]]
    return parts


def _cord_region(data: Mapping[str, Any], name: str, key: str) -> str:
    """The region whose cords ``section.layers.NAME.angle`` means; cards of materials have the cords."""
    regions = completed_materials(data.get("section"), data.get("materials", {}))
    if name not in regions:
        message = f"cords are of a region, as materials.REGION.cords.angle; '{name}' is none{nearest(name, regions)}"
        raise InputError(message, field=key)
    return name


def _section_parts(name: str) -> list[str]:
    """Parts of a section's dotted name: ``section.crown_radius`` is a parameter, ``section.cord_angle`` a rating."""
    from tyrefem.geometry.card import RatingCard, SectionCard

    if name in SectionCard.model_fields or name in ("size", "rim_width"):
        return ["section", name]
    return ["section", "rating" if name in RatingCard.model_fields else "parameters", name]


def _step(place: Any, part: str, so_far: str, path: list[str]) -> Any:
    if isinstance(place, list):
        return place[entry_number(place, part, so_far)]
    below = place.get(part)
    reference = so_far in _REFERENCES or (path[0] == "materials" and len(path) == 2)
    if reference and isinstance(below, str):
        below = place[part] = {"base": below}
    elif below is None:
        below = place[part] = {}
    elif not isinstance(below, dict | list):
        raise InputError(f"'{so_far}' is a value, not a table: nothing below it can be set", field=so_far)
    return below


def _refuse_overridden(data: Mapping[str, Any], parts: list[str]) -> None:
    if names := _overriding(data, parts):
        same = {parts[1], *EXCLUSIVE_KEYS.get(parts[1], ())}
        raise InputError(
            f"every phase sets '{' or '.join(sorted(same))}': name the phase, "
            f"e.g. drive.phases.{names[0]}.{parts[1]} (phases: {', '.join(names)})",
            field=".".join(parts),
        )


def is_overridden(data: Mapping[str, Any], key: str) -> bool:
    """Whether every phase sets a number of the drive, or its alternative, by itself: that of ``[drive]`` is not used.

    >>> is_overridden({"drive": {"speed": "9 m/s", "phases": [{"speed": "8 m/s"}]}}, "drive.speed")
    True
    """
    return bool(_overriding(data, _parts(data, key)))


def _overriding(data: Mapping[str, Any], parts: list[str]) -> list[str]:
    """Names of all phases, if every one sets the number of the drive or its alternative; else empty."""
    drive = data.get("drive")
    if parts[0] != "drive" or len(parts) < 2 or not isinstance(drive, Mapping):
        return []
    phases = drive.get("phases")
    same = {parts[1], *EXCLUSIVE_KEYS.get(parts[1], ())}
    if isinstance(phases, list) and phases and all(isinstance(p, Mapping) and same & set(p) for p in phases):
        return [str(p.get("name", number)) for number, p in enumerate(phases)]
    return []


def _drop_exclusive(parts: list[str], place: dict[str, Any]) -> None:
    """Remove the alternative of a changed value: load or deflection, or a sensor's other kind of place."""
    exclusive_keys = EXCLUSIVE_KEYS if parts[0] == "drive" else {}
    if parts[0] == "sensors":
        exclusive_keys = {
            "at": ["s", "depth", "below_surface", "place"],
            "place": ["s", "depth", "below_surface", "at"],
            "s": ["at", "place"],
            "depth": ["at", "below_surface"],
            "below_surface": ["at", "depth"],
        }
    for exclusive_key in exclusive_keys.get(parts[-1], []):
        place.pop(exclusive_key, None)


def check_used(data: Mapping[str, Any], key: str) -> None:
    """Raises InputError for a number of the drive that every phase sets by itself, so that it is not used."""
    _refuse_overridden(data, _parts(data, key))


def value_at(data: Mapping[str, Any], key: str, near: Any = None) -> Any:
    """The value at a dotted name, looked up through the cards that the study refers to."""
    place: Any = data
    parts = _parts(data, key)
    if parts[0] == "materials" and "section" in data:
        place = {**data, "materials": completed_materials(data["section"], data.get("materials", {}))}
    for depth, part in enumerate(parts):
        reference = (depth == 1 and parts[0] == "section") or (depth == 2 and parts[0] == "materials")
        if reference:
            sized = depth == 1 and library.of_size("section", place, near)
            card, _, _ = library.load("section" if depth == 1 else "material", place, near)
            place = with_numbers(place, card) if sized else card
        if isinstance(place, list):
            place = place[entry_number(place, part, key)]
        elif isinstance(place, Mapping) and part in place:
            place = place[part]
        else:
            allowed = list(place) if isinstance(place, Mapping) else []
            raise InputError(f"not set in the study or its cards{nearest(part, allowed)}", field=key)
    return place


def scaled(value: Any, factor: float, significant: int | None = None) -> Any:
    """Multiply the number of a written quantity by a factor, optionally rounded to ``significant`` digits.

    The first column of a table's rows is not changed: temperatures, frequencies, places.

    A temperature in degC or degF is multiplied in kelvins.

    Raises
    ------
    InputError : no number.

    >>> scaled("20 mph", 1.5), scaled("20 mph", 1.23456, significant=3), scaled(0.1, 1.23456, significant=3)
    ('30 mph', '24.7 mph', 0.123)
    >>> scaled({"unit": "mm", "values": [1.0, 2.0]}, 1.5)
    {'unit': 'mm', 'values': [1.5, 3.0]}
    >>> scaled([["20 degC", "0.2 W/m/K"], ["80 degC", "0.3 W/m/K"]], 2.0)
    [['20 degC', '0.4 W/m/K'], ['80 degC', '0.6 W/m/K']]
    >>> scaled("25 degC", 1.01)
    '27.9815 degC'
    """
    if isinstance(value, bool):
        raise InputError(f"{value!r} is not a number that can be scaled")
    if isinstance(value, int | float):
        return value * factor if significant is None else float(f"{value * factor:.{significant}g}")
    if isinstance(value, Mapping) and set(value) == {"unit", "values"}:
        if has_arbitrary_zero(str(value["unit"])):
            texts = [scaled(f"{entry!r} {value['unit']}", factor, significant) for entry in value["values"]]
            return {"unit": "degC", "values": [float(text.split()[0]) for text in texts]}
        return {"unit": value["unit"], "values": [scaled(entry, factor, significant) for entry in value["values"]]}
    if isinstance(value, list):
        if value and all(isinstance(row, list) and row for row in value):
            return [[row[0], *scaled(row[1:], factor, significant)] for row in value]
        return [scaled(entry, factor, significant) for entry in value]
    amount, unit = amount_parts(value) or ("", "")
    if not amount:
        raise InputError(f"{value!r} is not a number that can be scaled")
    if has_arbitrary_zero(unit):
        return f"{(parse(value, 'degC') + KELVIN) * factor - KELVIN:.{significant or 12}g} degC"
    # The unit stands as far from the number as it was written.
    return f"{float(amount) * factor:.{significant or 12}g}{value.strip()[len(amount) :]}"


def check_factor(value: Any) -> None:
    """Raises InputError for a temperature in degC or degF: a factor of it is another change on each scale."""
    if isinstance(value, Mapping) and "unit" in value:
        unit, shown = str(value["unit"]), f"{value.get('values')} {value['unit']}"
    else:
        unit, shown = (amount_parts(value) or ("", ""))[1], repr(value)
    if has_arbitrary_zero(unit):
        raise InputError(f"{shown} is a temperature: a share of it means nothing; give values, or an sd like '2 K'")


def check_number(value: Any) -> None:
    """Raises InputError for a text that only begins with a number, such as a title.

    >>> check_number("20 mph")
    """
    unit = (amount_parts(value) or ("", ""))[1]
    if unit and not any(unit in usual for usual in FACTORS.values()):
        try:
            parse(value, unit)
        except InputError:
            raise InputError(f"{value!r:.80} is not a number that can be scaled") from None
