"""JSON schemas of the commands' answers, made of their keys."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from tyrefem.output.key_units import unit_of
from tyrefem.schemas.answers import ANSWERS, Keys
from tyrefem.schemas.draft import DRAFT, Schema
from tyrefem.schemas.rows import rows_of

TYPES: dict[str, Any] = {
    "text": "string", "number": "number", "integer": "integer", "boolean": "boolean", "list": "array",
    "table": "object", "written": "object",
}  # fmt: skip
TITLE = "Answers of tyrefem's commands in JSON"


def parts_of(line: str) -> tuple[str, bool, str]:
    """Kind, may be null, and words of a line of keys.

    >>> parts_of("number?: Gauge pressure.")
    ('number', True, 'Gauge pressure.')
    """
    kind, _, words = line.partition(": ")
    return kind.removesuffix("?"), kind.endswith("?"), words


def answer_schema(command: str) -> Schema:
    """The schema of one command's answer; rows and tables inside it may have further keys."""
    keys = ANSWERS[command]
    schema = {**_table(keys), "additionalProperties": "*" in keys}
    for place, inner in rows_of(command).items():
        entry = schema
        for name, ending in steps_of(place):
            if name:
                entry = entry.setdefault("properties", {}).setdefault(name, {})
            if ending:
                kind = "items" if ending == "[]" else "additionalProperties"
                entry = entry.setdefault(kind, {})
        # What is known already, null among it, stays.
        entry |= {**_table(inner), **entry}
        if "*" in inner:
            entry.setdefault("additionalProperties", True)
    _close(schema)
    return schema


def _close(node: Schema) -> None:
    """Values behind names (``->``) are no tables, unless their keys are known."""
    if "->" in node.get("description", "") and "properties" not in node:
        node.setdefault("additionalProperties", {"not": {"type": "object"}})
    for below in (*node.get("properties", {}).values(), node.get("items"), node.get("additionalProperties")):
        if isinstance(below, dict):
            _close(below)


def unknown_keys(data: Any, schema: Schema, place: str = "") -> Iterator[str]:
    """Places in an answer, at any depth, with a key that the schema does not know, or a table without known keys.

    >>> list(unknown_keys({"a": [{"b": 1, "c": 2}]}, {"properties": {"a": {"items": {"properties": {"b": {}}}}}}))
    ['.a[].c']
    """
    if isinstance(data, list):
        for each in data:
            yield from unknown_keys(each, schema.get("items", {}), f"{place}[]")
    elif isinstance(data, dict) and schema.get("additionalProperties") is not True:
        properties, names = schema.get("properties", {}), schema.get("additionalProperties")
        if "properties" not in schema and not names:
            yield f"{place} {sorted(data)[:9]}"
            return
        for key, value in data.items():
            if key in properties:
                yield from unknown_keys(value, properties[key], f"{place}.{key}")
            elif names:
                yield from unknown_keys(value, names, f"{place}{{}}")
            else:
                yield f"{place}.{key}"


def steps_of(place: str) -> list[tuple[str, str]]:
    """Names of a place inside an answer, each with ``[]``, ``{}`` or nothing after it.

    >>> steps_of("sweep.main_effects{}[]")
    [('sweep', ''), ('main_effects', '{}'), ('', '[]')]
    """
    return [(name, ending) for name, ending in re.findall(r"\.?(\w*)(\[\]|\{\})?", place) if name or ending]


def _table(keys: Keys) -> Schema:
    properties, required = {}, []
    for key, line in keys.items():
        if key == "*":
            continue
        kind, nullable, words = parts_of(line)
        unit = unit_of(key.removesuffix("*"))
        entry: Schema = {"title": f"{key.removesuffix('*')} [{unit}]" if unit else key.removesuffix("*")}
        entry["description"] = words
        if kind == "written":
            entry["additionalProperties"] = True
        if kind in TYPES:
            entry["type"] = [TYPES[kind], "null"] if nullable else TYPES[kind]
        properties[key.removesuffix("*")] = entry
        required += [] if key.endswith("*") else [key]
    return {"type": "object", "properties": properties, "required": required}


def answers_schema() -> Schema:
    """One schema with the answer of every command among its definitions: ``#/definitions/run``."""
    definitions = {name_of(command): answer_schema(command) for command in ANSWERS}
    words = "The answer of a command stands under #/definitions/COMMAND, with '-' for spaces. docs/commands.md"
    return {
        "$schema": DRAFT,
        "title": TITLE,
        "description": f"What a command prints with --json. {words}",
        "anyOf": [{"$ref": f"#/definitions/{name}"} for name in definitions],
        "definitions": definitions,
    }


def name_of(command: str) -> str:
    """The definition of a command's answer.

    >>> name_of("press --critical-speed")
    'press-critical-speed'
    """
    return re.sub(r"\W+", "-", command).strip("-")


def answer_of(command: str) -> tuple[str, ...]:
    """Names of the definitions of a command's answers: the usual one, and those of other questions to it."""
    return tuple(name_of(name) for name in ANSWERS if name == command or re.match(rf"{command} [(-]", name))
