"""A card's class as JSON schema, draft 7: what pydantic gives, in the form that editors of TOML read."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any, get_args

from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import core_schema

from tyrefem.cards import Card
from tyrefem.quantity import Ramp, convert
from tyrefem.quantity.pattern import EXAMPLES, pattern_names
from tyrefem.schemas.keys import words_of_key
from tyrefem.schemas.words import field_words, summary

Schema = dict[str, Any]
DRAFT = "http://json-schema.org/draft-07/schema#"
_BOUNDS = {"gt": "more than", "ge": "at least", "lt": "less than", "le": "at most"}


class CardSchema(GenerateJsonSchema):
    """Schema with the words of docstrings, and defaults as a person writes them."""

    def encode_default(self, dft: Any) -> Any:
        """A default as in a file; None for tables."""
        if isinstance(dft, Ramp):
            return dft.start
        return None if isinstance(dft, Card) else super().encode_default(dft)

    def model_schema(self, schema: core_schema.ModelSchema) -> JsonSchemaValue:
        """The table of a card, with the words of its fields."""
        made = super().model_schema(schema)
        card = schema["cls"]
        if not issubclass(card, Card):
            return made
        made["description"] = summary(card)
        made["x-class"] = card.__name__
        words, bases = field_words(card), [base.__name__ for base in card.__mro__ if issubclass(base, Card)]
        for name, field in card.model_fields.items():
            below = made["properties"].get(field.alias or name)
            text = words.get(name) or words_of_key(bases, name) or _of_table(field.annotation)
            if below is not None and text and "description" not in below:
                below["description"] = text
        return made


def _of_table(annotation: Any) -> str:
    """The summary of the card that a field holds."""
    for kind in (annotation, *get_args(annotation)):
        if isinstance(kind, type) and issubclass(kind, Card):
            return summary(kind).split("\n\n")[0]
    return ""


def table_schema(card: type[Card]) -> Schema:
    """Draft 7 of a card's table, with its subtables in place.

    >>> from tyrefem.materials.wear import Wear
    >>> table_schema(Wear)["properties"]["depth"]["title"]
    'Depth [m]'
    """
    made = card.model_json_schema(schema_generator=CardSchema)
    definitions = made.pop("$defs", {})
    return dict(_tidy(_inlined(made, definitions)))


def _inlined(schema: Any, definitions: Mapping[str, Any]) -> Any:
    if isinstance(schema, list):
        return [_inlined(entry, definitions) for entry in schema]
    if not isinstance(schema, dict):
        return schema
    if "$ref" in schema:
        target = _inlined(definitions[schema["$ref"].rpartition("/")[2]], definitions)
        beside = {key: value for key, value in schema.items() if key != "$ref"}
        return {"allOf": [target], **beside} if beside else target
    made = {key: _inlined(value, definitions) for key, value in schema.items()}
    if "discriminator" in made:
        made = _by_law(made)
    return made


def _by_law(schema: Schema) -> Schema:
    """A union of laws: the key of the law is needed, and its name is checked before the other keys."""
    key = schema.pop("discriminator")["propertyName"]
    names = []
    for table in schema["oneOf"]:
        table["required"] = list(dict.fromkeys([key, *table.get("required", [])]))
        names.append(table["properties"][key].get("const"))
    return {**schema, "type": "object", "required": [key], "properties": {key: {"type": "string", "enum": names}}}


def _tidy(schema: Any, key: str | None = None) -> Any:
    """Without null, which TOML has not; titles, units, ranges and defaults as text; draft 7's tuples.

    ``key``: the name under which the schema stands in a table.
    """
    if isinstance(schema, list):
        return [_tidy(entry) for entry in schema]
    if not isinstance(schema, dict):
        return schema
    made = {name: _below(name, value) for name, value in schema.items()}
    if "prefixItems" in made:
        made["items"], made["additionalItems"] = made.pop("prefixItems"), False
    options = made.get("anyOf")
    if options:
        kept = [option for option in options if option.get("type") != "null"]
        made["anyOf"] = kept
        if len(kept) == 1:
            del made["anyOf"]
            made = {**made, "allOf": kept} if "x-class" in kept[0] else {**kept[0], **made}
    if made.get("default", 0) is None or made.get("default") in ([], {}, ()):
        del made["default"]
    if key is not None:
        _named(made, key, made.pop("x-quantity", None), made.pop("x-likely", None))
    if isinstance(made.get("description"), str):
        made["description"] = made["description"].replace("``", "`")
    return made


def _below(name: str, value: Any) -> Any:
    if name in ("properties", "patternProperties"):
        return {key: _tidy(below, key) for key, below in value.items()}
    if name in ("items", "prefixItems", "anyOf", "oneOf", "allOf", "additionalProperties", "if", "then"):
        return _tidy(value)
    return value


def _named(schema: Schema, key: str, quantity: Mapping[str, Any] | None, likely: Mapping[str, Any] | None) -> None:
    """Title, range, likely range and default of a key."""
    title = key.replace("_", " ").replace("-", " ")
    title = title[:1].upper() + title[1:]
    unit = "1" if quantity is None else quantity["unit"]
    schema["title"] = title if unit == "1" or "\\" in key else f"{title} [{_shown(unit)}]"
    if quantity is None:
        return
    text = [schema["description"]] if schema.get("description") else []
    bounds = [f"{words} {_number(quantity[name])}" for name, words in _BOUNDS.items() if name in quantity]
    tail = "" if unit == "1" else f" {_shown(unit)}"
    if bounds:
        text.append(f"{' and '.join(bounds)}{tail}.".capitalize() if unit == "1" else _first_up(bounds, tail))
    if likely is not None:
        text.append(f"Likely: {_number(likely['low'])} to {_number(likely['high'])}{tail} ({likely['source']}).")
    schema["description"] = " ".join(text)
    if isinstance(schema.get("default"), int | float) and unit != "1":
        schema["default"] = written_default(float(schema["default"]), unit, quantity.get("written"))
        if schema["default"] is None:
            del schema["default"]


def _first_up(bounds: list[str], tail: str) -> str:
    joined = " and ".join(bounds)
    return f"{joined[:1].upper()}{joined[1:]}{tail}."


def _number(value: float) -> str:
    return f"{value:.6g}"


def _shown(unit: str) -> str:
    return unit.replace("delta_degC", "K").replace("**", "")


def written_default(value: float, unit: str, written: str | None = None) -> str | None:
    """A default as text with a unit that people write; None for an infinite one.

    >>> written_default(3e-3, "m"), written_default(25.0, "degC"), written_default(float("inf"), "m")
    ('3 mm', '25 degC', None)
    """
    if value in (float("inf"), float("-inf")):
        return None
    usual = written or EXAMPLES.get(unit, (f"1 {unit}",))[0].split(" ", 1)[1]
    number = value if usual == unit or (usual, unit) == ("K", "delta_degC") else convert(value, unit, usual)
    return f"{number:.6g} {usual}"


def hoisted(schema: Schema) -> Schema:
    """The schema with tables of classes, and patterns that occur more than once, in ``definitions``."""
    given = schema.get("definitions", {})
    definitions: dict[str, Any] = {}
    texts: dict[str, str] = {}

    def lifted(part: Any, top: bool = False) -> Any:
        if isinstance(part, list):
            return [lifted(entry) for entry in part]
        if not isinstance(part, dict):
            return part
        made = {key: lifted(value) for key, value in part.items() if key not in ("x-quantity", "x-likely")}
        if "pattern" in made and made.get("type") == "string":
            name = pattern_names().get(made["pattern"], "text")
            # In "anyOf" an editor's message is short; that of a pattern would repeat the whole of it.
            text = {"type": "string", "anyOf": [{"pattern": made.pop("pattern")}]}
            made.pop("type")
            reference = {"$ref": f"#/definitions/{_name(text, name)}"}
            return {**made, "allOf": [reference]} if made else reference
        name = made.pop("x-class", None)
        if name is None or top:
            return made
        beside = {key: made.pop(key) for key in ("title", "default") if key in made}
        made["title"] = name
        reference = {"$ref": f"#/definitions/{_name(made, name)}"}
        kept = {key: value for key, value in beside.items() if value != name}
        return {**kept, "allOf": [reference]} if kept else reference

    def _name(part: Schema, wanted: str) -> str:
        text = json.dumps(part, sort_keys=True)
        if text not in texts:
            number = sum(name == wanted or re.fullmatch(rf"{wanted}-\d+", name) is not None for name in definitions)
            texts[text] = f"{wanted}-{number + 1}" if number else wanted
            definitions[texts[text]] = part
        return texts[text]

    made = lifted({key: value for key, value in schema.items() if key != "definitions"}, top=True)
    made.pop("x-class", None)
    further = {name: lifted(part, top=True) for name, part in given.items()}
    return {**made, "definitions": dict(sorted({**definitions, **further}.items()))}
