"""Schemas of references to cards: a name, or a table with changes to a card; of tables with dotted names."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from tyrefem.quantity.pattern import quantity_schema
from tyrefem.schemas.draft import Schema
from tyrefem.sizes.designation import EXAMPLES as SIZES


def partial(schema: Any) -> Any:
    """The schema of changes to a table: nothing is required, and a list's entries may be named by number.

    >>> partial({"type": "object", "required": ["a"], "properties": {"a": {"type": "string"}}})
    {'type': 'object', 'properties': {'a': {'type': 'string'}}}
    """
    if isinstance(schema, list):
        return [partial(entry) for entry in schema]
    if not isinstance(schema, dict):
        return schema
    made: Schema = {}
    for key, value in schema.items():
        if key == "required":
            continue
        if key == "x-class":
            made[key] = f"{value}Changes"
        elif key == "properties":
            made[key] = {name: partial(below) for name, below in value.items()}
        else:
            # Without its required keys a table may fit several laws.
            made["anyOf" if key == "oneOf" else key] = partial(value)
    entry = made.get("items")
    if isinstance(entry, dict) and entry.get("type") == "object":
        by_number = {"type": "object", "patternProperties": {r"^\d+$": entry}, "additionalProperties": False}
        kept: Schema = {key: made.pop(key) for key in ("title", "description") if key in made}
        made = {**kept, "anyOf": [made, by_number]}
    return made


def names_of(names: Iterable[str], words: str) -> Schema:
    """Any text; an editor offers the names."""
    return {"anyOf": [{"type": "string", "enum": sorted(names)}, {"type": "string", "minLength": 1}], "title": words}


def with_changes(names: Iterable[str], card: Schema, kind: str) -> Schema:
    """A card's name or path, or a table with ``base`` and changes to that card."""
    name = names_of(names, f"Name or path of a {kind} card")
    changes: Schema = partial(card)
    base: Schema = {**name, "title": "Base", "description": name["title"]}
    changes["properties"] = {"base": base, **changes["properties"]}
    changes["description"] = f"A {kind} card with changes: base is its name or path, the other keys replace the card's."
    changes["x-class"] = f"{card['x-class']}Reference"
    return {"anyOf": [*name["anyOf"], changes]}


def section_reference(names: Iterable[str], card: Schema) -> Schema:
    """A section's name or path, a tyre's size, or a table with changes to either."""
    reference = with_changes(names, card, "section")
    changes = partial(card)["properties"]
    over = {key: changes[key] for key in ("title", "layers", "grooves", "pattern", "wrap", "boundaries", "rating")}
    rim = {**quantity_schema("m", {"gt": 0.0}), "description": "Width of the rim.", "title": "Rim width [m]"}
    load = {**quantity_schema("N", {"gt": 0.0}), "description": "A load that the tyre must carry.", "title": "Load [N]"}
    pressure = {
        **quantity_schema("Pa", {"gt": 0.0}), "description": "Gauge pressure of that load.", "title": "Pressure [Pa]",
    }  # fmt: skip
    numbers = {
        "type": "object",
        "title": "Parameters",
        "description": "Numbers of the size's rules in place of the rules' own; 'tyrefem new section SIZE' lists them.",
        "additionalProperties": {"type": ["string", "number", "object"]},
    }
    size = {
        "type": "object",
        "description": "A tyre's size, drawn by the rules of its kind.",
        "required": ["size"],
        "properties": {
            "size": {
                "type": "string",
                "minLength": 3,
                "examples": list(SIZES),
                "title": "Size",
                "description": "The size as it stands on the wall.",
            },
            "rim_width": _bare(rim),
            "load": _bare(load),
            "pressure": _bare(pressure),
            "parameters": numbers,
            **over,
        },
        "additionalProperties": False,
        "x-class": "SizeReference",
    }
    return {"anyOf": [*reference["anyOf"], size]}


def _bare(schema: Schema) -> Schema:
    return {key: value for key, value in schema.items() if not key.startswith("x-")}


def dotted(leaf: Schema, keys: Iterable[str], name: str) -> tuple[Schema, Schema]:
    """A table of dotted names, quoted or as nested tables, and the definition ``name`` that it refers to.

    ``keys``: keys that make a table a leaf.
    """
    nested = {
        "type": "object",
        "propertyNames": {"not": {"enum": sorted(keys)}},
        "additionalProperties": {"$ref": f"#/definitions/{name}"},
        "minProperties": 1,
    }
    definition = {"anyOf": [leaf, nested]}
    return {"type": "object", "additionalProperties": {"$ref": f"#/definitions/{name}"}}, definition
