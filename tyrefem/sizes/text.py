"""A size's section as the text of a file: every named number with its source on top, then the section's tables."""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from tyrefem.sizes.drawn import Drawn

#: Longest line of lists of numbers.
WIDTH = 120


def section_text(drawn: Drawn, command: str) -> str:
    """The section's file. ``command`` made it.

    >>> from tyrefem.sizes import draw_size
    >>> text = section_text(draw_size("205/60R15"), "tyrefem new section 205/60R15")
    >>> "# rim_width" in text and "[[layers]]" in text
    True
    """
    return "\n".join([*_head(drawn, command), "", *table_lines(drawn.data), "", *_materials(drawn), ""])


def study_text(drawn: Drawn, section: Mapping[str, Any] | str, speed: str, places: Iterable[str]) -> str:
    """A study of a size: its section, its materials, its rated load and pressure, mechanics by finite elements, and
    sensors at places by name."""
    rules = drawn.rules
    lines = [
        f"title = {_value(f'{drawn.size.text}: rated load and pressure at {speed}')}",
        f"section = {_value(section)}",
        "",
        "[materials]                 # without a line here a region has the card of its size, which follows "
        "another size or number:",
        *(f"# {_key(region)} = {_value(card)}" for region, card in drawn.materials.items()),
        "",
        "[drive]",
        f"speed = {_value(speed)}",
        f"load = {_value(rules['rated_load'].text)}      # {rules['rated_load'].source}",
        f"pressure = {_value(rules['rated_pressure'].text)}      # {rules['rated_pressure'].source}",
        'duration = "1800 s"',
        'ambient = "25 degC"',
        "",
        "[mesh]",
        'size = "5 mm"',
        "through = 1                 # one quadratic element through a ply",
        "",
        "[mechanics]",
        'strain = "fem"',
        'loss_convention = "sinusoid"',
        "",
        "[sensors]                   # places that every such tyre has, whatever its size; your own: docs/studies.md",
        *(f"{name} = {_value({'place': name})}" for name in places),
        "",
    ]
    return "\n".join(lines)


def _head(drawn: Drawn, command: str) -> Iterator[str]:
    yield f"# {drawn.size.text}, kind {drawn.size.kind}. Written by: {command}"
    yield "# No maker's design, nothing measured: sizes of the standard or data book, the inside by rules of the trade."
    yield "# The named numbers that the tables below follow from; change one with --set NAME=VALUE and write anew."
    yield "#"
    wide = max(len(number.name) for number in drawn.rules)
    for number in drawn.rules:
        rows = textwrap.wrap(number.source, 100)
        yield f"# {number.name:{wide}}  {number.text:14}  {rows[0] if rows else ''}"
        for row in rows[1:]:
            yield f"# {'':{wide}}  {'':14}  {row}"


def _materials(drawn: Drawn) -> Iterator[str]:
    yield "# Material cards for a study of this section (not needed where the section is the size itself):"
    yield "# [materials]"
    for region, card in drawn.materials.items():
        yield f"# {_key(region)} = {_value(card)}"


def table_lines(data: Mapping[str, Any]) -> Iterator[str]:
    """Plain data as the lines of a TOML file: a table's values each on a line, what is below them inline."""
    tables = [isinstance(value, Mapping | list) for value in data.values()]
    # Behind a table's heading a plain value would be one of that table.
    for _, (key, value) in sorted(zip(tables, data.items(), strict=True), key=lambda pair: pair[0]):
        if isinstance(value, Mapping):
            yield ""
            yield f"[{key}]"
            yield from _pairs(value)
        elif isinstance(value, list) and key == "layers":
            for entry in value:
                yield ""
                yield f"[[{key}]]"
                yield from _pairs(entry)
        elif isinstance(value, list):
            for entry in value:
                yield f"[[{key}]]" if entry is not value[0] else f"\n[[{key}]]"
                yield from _pairs(entry)
        else:
            yield f"{key} = {_value(value)}"


def _pairs(table: Mapping[str, Any]) -> Iterator[str]:
    for key, value in table.items():
        text = _value(value)
        if len(text) > WIDTH and isinstance(value, Mapping) and isinstance(value.get("values"), list):
            yield f"{_key(key)} = {{ unit = {_value(value['unit'])}, values = ["
            row = ""
            for item in map(_value, value["values"]):
                if len(row) + len(item) > WIDTH - 6:
                    yield f"    {row.rstrip()}"
                    row = ""
                row += f"{item}, "
            yield f"    {row.rstrip()}"
            yield "] }"
        elif len(text) > WIDTH and isinstance(value, list):
            yield f"{_key(key)} = ["
            yield from (f"    {_value(item)}," for item in value)
            yield "]"
        else:
            yield f"{_key(key)} = {text}"


def _value(value: Any) -> str:
    if isinstance(value, str):
        # The escapes of JSON are those of TOML, which has one more.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(key)} = {_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_value, value)) + "]"
    return repr(value)


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else _value(key)
