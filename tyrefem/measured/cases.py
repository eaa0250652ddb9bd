"""A table of cases (CSV, or a sheet): columns are dotted names of a study's values, one row per case."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tyrefem.errors import InputError
from tyrefem.measured.heading import is_time, parts
from tyrefem.measured.lines import DELIMITERS, LONGEST_PREAMBLE, decode, texts
from tyrefem.measured.workbook import check_formulas
from tyrefem.output.device_names import is_device

_HEADING = re.compile(r"^\s*([^\[\]]+?)\s*(?:\[([^\[\]]*)\])?\s*$")
_DECIMAL_COMMA = re.compile(r"^(\s*[-+]?\d+),(\d+(?:[eE][-+]?\d+)?\s*)$")
#: Columns for people, not values of the study.
LABELS = ("name", "note")


@dataclass(frozen=True)
class Case:
    """One row: its name, its note, and its changes to the study."""

    name: str
    note: str
    changes: dict[str, Any]
    line: int


def read_cases(path: Path) -> tuple[Case, ...]:
    """The cases of a CSV file or of a workbook with one sheet.

    The heading names each column: ``name``, optionally ``note``, and dotted names such as ``drive.load [lbf]``, whose
    unit is added to every number. Lines that begin with ``#`` are comments; an empty cell keeps the study's value;
    empty columns at its end are none.
    Cells are separated by commas, semicolons or tabs; without commas between them a number may have a decimal comma.

    Raises
    ------
    InputError : unreadable, no ``name`` column, a row of another length, a missing or repeated name, a cell of an
        Excel workbook whose formula has no value.

    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp()) / "cases.csv"
    >>> _ = file.write_text("name,drive.speed [mph],note\\nslow,20,as measured\\nfast,35,\\n")
    >>> [case.changes for case in read_cases(file)]
    [{'drive.speed': '20 mph'}, {'drive.speed': '35 mph'}]
    """
    lines = _content(decode(path))
    # An empty cell keeps the study's value: one whose formula has failed would be taken for that.
    check_formulas(path.read_bytes(), path)
    if len(lines) < 2:
        raise InputError("needs a heading and at least one case", file=path)
    delimiter = _delimiter(lines[0][1])
    rows = [(number, _cells(line, number, path, delimiter)) for number, line in lines]
    width = max((place for place, cell in enumerate(rows[0][1], 1) if cell.strip()), default=0)
    whole = len(rows[0][1])
    rows = [(number, _without_empty(cells, width) if len(cells) == whole else cells) for number, cells in rows]
    columns = [_heading(cell, path) for cell in rows[0][1]]
    names = [name for name, _ in columns]
    if "name" not in names:
        raise InputError(f"line {rows[0][0]}: the heading has no column 'name'", file=path)
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"line {rows[0][0]}: the heading has column '{twice}' twice", file=path)
    if "cases" in names:
        raise InputError(f"line {rows[0][0]}: column 'cases' would be a table of cases for each case", file=path)
    cases = [_case(number, cells, columns, path) for number, cells in rows[1:]]
    seen: dict[str, Case] = {}
    for case in cases:
        # Every case has a folder of its name; file systems of Windows and macOS do not tell A from a.
        earlier = seen.setdefault(case.name.casefold(), case)
        if earlier is case:
            continue
        if earlier.name == case.name:
            raise InputError(f"case '{case.name}' stands in lines {earlier.line} and {case.line}", file=path)
        raise InputError(
            f"cases '{earlier.name}' and '{case.name}', lines {earlier.line} and {case.line}, differ only in capital "
            "letters: on Windows and macOS their folders would be one",
            file=path,
        )
    return tuple(cases)


def looks_like_cases(path: Path) -> bool:
    """True if the first row of a table is the heading of a table of cases, not of thermocouple histories.

    A logger's file may begin with lines such as "name,Lab 3"; its heading, with a time and units, follows.
    """
    of_sheets = texts(path)
    if len(of_sheets) > 1:
        return False
    lines = [line for _, line in _content(*of_sheets.values())[: LONGEST_PREAMBLE + 1]]
    cells = [cell.strip(' "') for cell in lines[0].split(_delimiter(lines[0]))] if lines else []
    return "name" in cells and not any(_is_of_histories(line) for line in lines)


def _is_of_histories(line: str) -> bool:
    """Whether a line is the heading of thermocouple histories: a time, and a unit in any column."""
    rows = ([cell.strip(' "') for cell in line.split(delimiter)] for delimiter in DELIMITERS)
    return any(any(map(is_time, cells)) and any(parts(cell)[1] for cell in cells) for cells in rows)


def _content(text: str) -> list[tuple[int, str]]:
    """The lines with a filled cell that are no comments, with their numbers in the file; comments may be in quotes."""
    lines = enumerate(re.split("\r\n|\r|\n", text), 1)
    filled = ((number, line) for number, line in lines if line.strip().strip(DELIMITERS + ' "'))
    return [(number, line) for number, line in filled if not line.lstrip().lstrip('"').startswith("#")]


def _delimiter(heading: str) -> str:
    """The separator of the cells of a heading, by which one of them is "name"; without any a comma."""
    named = (each for each in DELIMITERS if "name" in (cell.strip(' "') for cell in heading.split(each)))
    return next((each for each in named if each in heading), ",")


def _cells(line: str, number: int, path: Path, delimiter: str) -> list[str]:
    try:
        cells = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True, strict=True))
        return cells if delimiter == "," else [_DECIMAL_COMMA.sub(r"\1.\2", cell) for cell in cells]
    except csv.Error as error:
        raise InputError(f"line {number}: quotes do not match ({error})", file=path) from None


def _without_empty(cells: list[str], width: int) -> list[str]:
    """A row without empty cells behind the last column, which spreadsheets write."""
    return cells if any(cell.strip() for cell in cells[width:]) else cells[:width]


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
    if not re.fullmatch(r"\w[\w.+-]{0,99}", name):
        allowed = "allowed: a letter or digit, then letters, digits, . + - _, 100 at most"
        raise InputError(f"line {number}: '{name}' is no name; {allowed}", file=path)
    if is_device(name) or name.endswith("."):
        raise InputError(f"line {number}: '{name}' can be no folder on Windows; give the case another name", file=path)
    changes = {key: f"{cell} {unit}".strip() for key, (cell, unit) in values.items() if key not in LABELS and cell}
    return Case(name, values.get("note", ("", ""))[0], changes, number)
