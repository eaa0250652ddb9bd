"""A table of cases: CSV whose columns are dotted names of a study's values, one row per case."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tyrefem.errors import InputError

_HEADING = re.compile(r"^\s*([^\[\]]+?)\s*(?:\[([^\[\]]*)\])?\s*$")
#: Columns that are for people, not values of the study.
LABELS = ("name", "note")


@dataclass(frozen=True)
class Case:
    """One row: its name, its note, and the values it lays over the study."""

    name: str
    note: str
    changes: dict[str, Any]
    line: int


def read_cases(path: Path) -> tuple[Case, ...]:
    """The cases of a CSV file.

    The heading names each column: ``name``, optionally ``note``, and dotted names such as ``drive.load [lbf]``, whose
    unit is put behind every number. Lines that begin with ``#`` are comments; an empty cell leaves the study's value.

    Raises
    ------
    InputError : unreadable, no ``name`` column, a row of another length, a name missing or given twice.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", file=path) from None
    except UnicodeDecodeError:
        raise InputError("not a text file in UTF-8", file=path) from None
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    lines = [(number, line) for number, line in lines if not line.lstrip().startswith("#")]
    if len(lines) < 2:
        raise InputError("needs a heading and at least one case", file=path)
    rows = [(number, next(csv.reader([line], skipinitialspace=True))) for number, line in lines]
    columns = [_heading(cell, path) for cell in rows[0][1]]
    names = [name for name, _ in columns]
    if "name" not in names or len(set(names)) < len(names):
        raise InputError("the heading needs a column 'name', and no column twice", file=path)
    cases = [_case(number, cells, columns, path) for number, cells in rows[1:]]
    seen: dict[str, int] = {}
    for case in cases:
        if case.name in seen:
            raise InputError(f"case '{case.name}' stands in lines {seen[case.name]} and {case.line}", file=path)
        seen[case.name] = case.line
    return tuple(cases)


def _heading(cell: str, path: Path) -> tuple[str, str]:
    match = _HEADING.match(cell)
    if match is None:
        raise InputError(f"'{cell}' is not a column heading such as 'drive.load [lbf]'", file=path)
    return match[1], (match[2] or "").strip()


def _case(number: int, cells: list[str], columns: list[tuple[str, str]], path: Path) -> Case:
    if len(cells) != len(columns):
        raise InputError(f"line {number} has {len(cells)} cells, the heading {len(columns)}", file=path)
    values = {name: (cell.strip(), unit) for (name, unit), cell in zip(columns, cells, strict=True)}
    name = values["name"][0]
    if not re.fullmatch(r"[\w.+-]+", name):
        raise InputError(f"line {number}: '{name}' is no name; allowed: letters, digits, . + - _", file=path)
    changes = {key: f"{cell} {unit}".strip() for key, (cell, unit) in values.items() if key not in LABELS and cell}
    return Case(name, values.get("note", ("", ""))[0], changes, number)
