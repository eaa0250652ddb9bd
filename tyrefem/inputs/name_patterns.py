"""Dotted names with ``*``: ``materials.belt-*.cords.angle``, ``section.thickness_scale.*``."""

from __future__ import annotations

import fnmatch
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tyrefem.cards.entries import names_of
from tyrefem.errors import InputError, nearest
from tyrefem.inputs.changes import canonical, value_at
from tyrefem.sizes import completed_materials

#: Tables that a ``*`` often ends or crosses.
TABLES = ("materials", "section.layers", "section.thickness_scale", "sensors", "drive.phases", "effects")
SCALES = "section.parameters.thickness_scale"


def number_at(data: Mapping[str, Any], key: str, near: Path | None = None) -> Any:
    """The value at a dotted name, as `value_at`; a region's thickness scale is 1 where it is not set.

    >>> number_at({"section": "passenger-205-55r16"}, "section.thickness_scale.tread")
    1.0
    """
    try:
        return value_at(data, key, near)
    except InputError:
        table, _, region = canonical(data, key).rpartition(".")
        if table != SCALES or region not in _scaled_regions(data, near):
            raise
        return 1.0


def matching(data: Mapping[str, Any], pattern: str, near: Path | None = None) -> list[str]:
    """The names in a study that a dotted name with ``*`` means, in the order of the files.

    ``*`` stands for any text within one part. A value that only some of the entries have counts where it is.

    Raises
    ------
    InputError : no name matches; names the entries there are.

    >>> matching({"section": "passenger-205-55r16"}, "section.thickness_scale.belt-*")
    ['section.thickness_scale.belt-1', 'section.thickness_scale.belt-2']
    """
    keys, parts = [""], pattern.split(".")
    for part in parts:
        if "*" not in part:
            keys = [_joined(key, part) for key in keys]
            continue
        names = {key: _entries(data, key, near) for key in keys}
        matches = [_joined(key, name) for key in keys for name in names[key] if fnmatch.fnmatchcase(name, part)]
        if not matches:
            allowed = list(dict.fromkeys(name for entries in names.values() for name in entries))
            if not allowed:
                raise InputError(f"'{keys[0]}' has no entries{nearest(keys[0], TABLES)}", field=pattern)
            raise InputError(f"no entry matches '{part}'{nearest(part, allowed)}", field=pattern)
        keys = matches
    there, missing = [], None
    for key in keys:
        try:
            number_at(data, key, near)
            there.append(key)
        except InputError as error:
            missing = missing or error
    if missing is not None and not there:
        raise missing
    return there


def _joined(key: str, part: str) -> str:
    return f"{key}.{part}" if key else part


def _entries(data: Mapping[str, Any], key: str, near: Path | None) -> list[str]:
    """Names of the entries of a table or list."""
    if key == "materials":
        return list(completed_materials(data.get("section"), data.get("materials", {})))
    if key and canonical(data, key) == SCALES:
        return _scaled_regions(data, near)
    try:
        place = value_at(data, key, near) if key else data
    except InputError:
        return []
    if isinstance(place, Mapping):
        return [str(name) for name in place]
    if isinstance(place, list):
        return [name or str(number) for number, name in enumerate(names_of(place))]
    return []


def _scaled_regions(data: Mapping[str, Any], near: Path | None) -> list[str]:
    """The regions of the section's layers."""
    layers = value_at(data, "section.layers", near)
    return list(dict.fromkeys(region["name"] for layer in layers for region in layer["regions"]))
