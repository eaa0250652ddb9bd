"""The tyre that is scaled: its size, and how its section was made."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tyrefem import library
from tyrefem.cards import read_toml
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.quantity import parse
from tyrefem.sizes import Drawn, draw_size, drawn_of, parse_size
from tyrefem.sizes.rules import UNITS, written
from tyrefem.sizes.section import NUMBERS

#: First line of a section that was written by its size.
_BY_SIZE = re.compile(r"^# (.+?), kind ([\w-]+)\. Written by: ", re.MULTILINE)
#: A number of its list that was given in place of the rule's.
_GIVEN = re.compile(r"^# (\w+)\s{2,}(\S.*?)\s{2,}given\s*$", re.MULTILINE)
#: Numbers that follow the size itself, not the construction.
OF_SIZE = frozenset(
    {*NUMBERS, "rated_load", "rated_pressure", "outer_diameter", "section_width", "rim_diameter", "flange_height",
     "flange_radius", "seat_taper", "ply_rating"}
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class SourceTyre:
    """A tyre by its size.

    Parameters
    ----------
    drawn : its size drawn by the rules with the numbers given in place of them. rules : without these. given : name
        -> number as written. by_rules : is its section drawn by the rules? scales : region -> factor on its thickness.
    edited : parts of its file that differ from the rules.
    """

    drawn: Drawn
    rules: Drawn
    given: Mapping[str, str]
    by_rules: bool
    scales: Mapping[str, Any]
    edited: tuple[str, ...] = ()

    def given_for(self, other: Drawn) -> dict[str, str]:
        """The given numbers of the construction for another size: lengths times the ratio of the rules' numbers."""
        names = [name for name in self.given if name not in OF_SIZE and name in other.rules.numbers]
        scaled = {}
        for name in names:
            mine, its = self.rules.rules.numbers.get(name), other.rules[name]
            if mine is None or its.unit == "1" or not mine.value:
                scaled[name] = self.given[name]
            else:
                value = parse(self.given[name], UNITS[its.unit][0]) * its.value / mine.value
                scaled[name] = written(value, its.unit)
        return scaled


def source_tyre(study: StudyData) -> SourceTyre:
    """The tyre of a study.

    Raises
    ------
    InputError : its section names no size.
    """
    reference = study.data["section"]
    changes = dict(reference) if isinstance(reference, Mapping) else {}
    scales = changes.get("parameters", {}).get("thickness_scale", {})
    if library.of_size("section", reference, study.folder):
        drawn = drawn_of(reference)
        parameters = {key: str(value) for key, value in changes.get("parameters", {}).items()}
        given = {key: value for key, value in parameters.items() if key in drawn.rules.numbers}
        laid = tuple(key for key in changes if key not in ("size", "parameters", *NUMBERS))
        return SourceTyre(drawn, draw_size(drawn.size.text), given, True, scales, laid)
    data, path, name = library.load("section", reference, study.folder)
    head = path.read_text(encoding="utf-8-sig").partition("\ntitle")[0]
    by_size = _BY_SIZE.search(head)
    if by_size is not None:
        given = dict(_GIVEN.findall(head))
        drawn = draw_size(by_size[1], given)
        edited = _edited(read_toml(path), drawn.data)
        laid = tuple(key for key in changes if key not in ("base", "parameters"))
        laid += tuple(key for key in changes.get("parameters", {}) if key != "thickness_scale")
        return SourceTyre(drawn, draw_size(by_size[1]), given, True, scales, (*edited, *laid))
    drawn = draw_size(_size_in(str(data.get("title", "")), name))
    return SourceTyre(drawn, drawn, {}, False, {})


def _edited(written_data: Mapping[str, Any], drawn_data: Mapping[str, Any]) -> tuple[str, ...]:
    """Tables of a section's file that are not as the rules draw them; layers by name."""
    edited = []
    for key in dict.fromkeys([*drawn_data, *written_data]):
        first, second = written_data.get(key), drawn_data.get(key)
        if key == "layers" and isinstance(first, list) and isinstance(second, list):
            edited += [
                f"layer '{layer.get('name')}'"
                for place, layer in enumerate(first)
                if place >= len(second) or layer != second[place]
            ]
        elif first != second:
            edited.append(key)
    return tuple(edited)


def _size_in(title: str, name: str) -> str:
    """The size that a section's title begins with or contains."""
    words = title.split()
    for start in range(len(words)):
        for count in (2, 1):
            text = " ".join(words[start : start + count])
            if not re.match(r"[A-Z]{0,2}\d", text, re.IGNORECASE):
                continue
            try:
                return parse_size(text).text
            except InputError:
                continue
    raise InputError(f"the title of section '{name}' names no size to scale from: '{title}'", field="--from")
