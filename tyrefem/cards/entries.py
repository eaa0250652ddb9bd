"""An entry of a list by its name or number: `section.layers.belt-1`, `drive.phases.taxi`, `effects.0`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from tyrefem.errors import InputError, nearest

#: Joins the parts of a layer's name: ``belt-1 and apex``.
JOINT = " and "


def names_of(entries: Sequence[Any]) -> list[str]:
    """The names of a list's entries; empty for an entry without a name."""
    return [str(entry.get("name", "")) if isinstance(entry, Mapping) else "" for entry in entries]


def entry_number(entries: Sequence[Any], part: str, field: str) -> int:
    """The place of an entry by its name, by a part of its name, or by its number from 0.

    Raises
    ------
    InputError : no entry has the name, or several have it.

    >>> layers = [{"name": "liner"}, {"name": "belt-1 and apex"}]
    >>> entry_number(layers, "liner", "layers"), entry_number(layers, "belt-1", "layers")
    (0, 1)
    """
    names = names_of(entries)
    places = [place for place, name in enumerate(names) if name == part]
    if not places:
        if part.isdecimal() and int(part) < len(entries):
            return int(part)
        places = [place for place, name in enumerate(names) if part in name.split(JOINT)]
    if not places:
        allowed = [name or str(number) for number, name in enumerate(names)]
        raise InputError(f"no entry '{part}'{nearest(part, allowed)}", field=field)
    if len(places) > 1:
        named = ", ".join(f"{place} ({names[place]})" for place in places)
        raise InputError(f"several entries have the name '{part}': give a number: {named}", field=field)
    return places[0]
