"""JSON schemas of the commands' answers, made of their keys."""

from __future__ import annotations

import re
from typing import Any

from tyrefem.schemas.answers import ANSWERS, Keys
from tyrefem.schemas.draft import DRAFT, Schema

TYPES: dict[str, Any] = {
    "text": "string", "number": "number", "integer": "integer", "truth": "boolean", "list": "array", "table": "object",
}  # fmt: skip
#: End of a key -> unit.
UNITS = {
    "_W_m2_K": "W/m2/K", "_mm_per_1000_km": "mm per 1000 km", "_mg_per_km": "mg/km", "_rad_s": "rad/s",
    "_m_rad": "m/rad", "_km_h": "km/h", "_m_s": "m/s", "_N_m": "N/m", "_W_m2": "W/m2", "_1_m": "1/m", "_m3": "m3",
    "_m2": "m2", "_degC": "degC", "_nats": "nats", "_Nm": "N m", "_Pa": "Pa", "_rad": "rad", "_km": "km", "_kg": "kg",
    "_Hz": "Hz", "_N": "N", "_W": "W", "_J": "J", "_K": "K", "_m": "m", "_s": "s",
}  # fmt: skip
TITLE = "Answers of tyrefem's commands in JSON"


def unit_of(key: str) -> str:
    """The unit at the end of a key; empty: a pure number, or no number.

    >>> unit_of("load_N"), unit_of("films_W_m2_K"), unit_of("harmonics")
    ('N', 'W/m2/K', '')
    """
    return next((unit for end, unit in UNITS.items() if key.endswith(end)), "")


def parts_of(line: str) -> tuple[str, bool, str]:
    """Kind, may be null, and words of a line of keys.

    >>> parts_of("number?: Gauge pressure.")
    ('number', True, 'Gauge pressure.')
    """
    kind, _, words = line.partition(": ")
    return kind.removesuffix("?"), kind.endswith("?"), words


def answer_schema(keys: Keys) -> Schema:
    """The schema of one command's answer."""
    properties, required = {}, []
    for key, line in keys.items():
        if key == "*":
            continue
        kind, nullable, words = parts_of(line)
        unit = unit_of(key.removesuffix("*"))
        entry: Schema = {"title": f"{key.removesuffix('*')} [{unit}]" if unit else key.removesuffix("*")}
        entry["description"] = words
        if kind in TYPES:
            entry["type"] = [TYPES[kind], "null"] if nullable else TYPES[kind]
        properties[key.removesuffix("*")] = entry
        required += [] if key.endswith("*") else [key]
    return {"type": "object", "properties": properties, "required": required, "additionalProperties": "*" in keys}


def answers_schema() -> Schema:
    """One schema with the answer of every command among its definitions: ``#/definitions/run``."""
    definitions = {_name(command): answer_schema(keys) for command, keys in ANSWERS.items()}
    words = "The answer of a command stands under #/definitions/COMMAND, with '-' for spaces. docs/commands.md"
    return {
        "$schema": DRAFT,
        "title": TITLE,
        "description": f"What a command prints with --json. {words}",
        "anyOf": [{"$ref": f"#/definitions/{name}"} for name in definitions],
        "definitions": definitions,
    }


def _name(command: str) -> str:
    return re.sub(r"\W+", "-", command).strip("-")


def answer_of(command: str) -> tuple[str, ...]:
    """Names of the definitions of a command's answers: the usual one, and those of other questions to it."""
    return tuple(_name(name) for name in ANSWERS if name == command or re.match(rf"{command} [(-]", name))
