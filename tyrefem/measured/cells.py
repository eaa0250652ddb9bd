"""Cells as numbers: empty is no reading, decimal comma or point, all else an error with its line."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.measured.heading import Heading

#: What loggers and spreadsheets write for "no reading", in small letters.
NO_READING = frozenset(("", "nan", "na", "n/a", "#n/a", "null", "none", "-", "--", "---"))
#: degC; above it stands the code of an open thermocouple, not a tyre.
HOTTEST = 2000.0
_NUMBER = re.compile(r"[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?", re.ASCII)
_PLAIN = re.compile(r"[0-9.eE+\-\n]*")


def numbers(cells: Sequence[str], lines: Sequence[int], column: str, file: Path, *, gaps: bool) -> NDArray[np.float64]:
    """(n,) floats of one column; NaN where there is no reading.

    Raises
    ------
    InputError : text, an infinite number, or (without ``gaps``) an empty cell; says line and column.
    """
    quick = _plain_numbers(cells, gaps)
    if quick is not None:
        return quick
    values = np.full(len(cells), np.nan)
    for index, cell in enumerate(cells):
        if gaps and cell.lower() in NO_READING:
            continue
        if _NUMBER.fullmatch(cell) is None:
            raise InputError(f"{_place(lines[index], column)}: {_wrong(cell, gaps)}", file=file)
        values[index] = float(cell.replace(",", "."))
        if not np.isfinite(values[index]):
            raise InputError(f"{_place(lines[index], column)}: {cell[:30]!r} is not finite", file=file)
    return values


def _plain_numbers(cells: Sequence[str], gaps: bool) -> NDArray[np.float64] | None:
    """The column at once where it has only plain numbers (ten times faster); None where a closer look is needed."""
    if _PLAIN.fullmatch("\n".join(cells)) is None or (not gaps and "" in cells):
        return None
    try:
        values = np.array([cell or "nan" for cell in cells], dtype=float)
    except ValueError:
        return None
    return None if np.isinf(values).any() else values


def _wrong(cell: str, gaps: bool) -> str:
    if cell.lower().lstrip("+-") in ("inf", "infinity"):
        return f"{cell!r} is not finite; leave the cell empty where there is no reading"
    if cell.lower() in NO_READING:
        return "the cell is empty; every row needs its time"
    if gaps:
        return f"{cell[:30]!r} is not a number; allowed: a number, or empty, NaN, - for no reading"
    return (
        f"{cell[:30]!r} is not a number; allowed: the time elapsed since the start, as a number, "
        "or timestamps like 2024-05-01T12:30:01 in every row"
    )


def _place(line: int, column: str) -> str:
    return f"line {line}, column '{column[:60]}'"


def one_decimal_mark(rows: Sequence[Sequence[str]], lines: Sequence[int], columns: Sequence[int], file: Path) -> None:
    """Refuse a table that mixes decimal points and decimal commas: one of them is a thousands mark.

    Raises
    ------
    InputError : says the first line of either kind.
    """
    marks = "".join(cell for row in rows for cell in row)
    if "," not in marks:
        return
    point = comma = 0
    for row, line in zip(rows, lines, strict=True):
        for column in columns:
            cell = row[column]
            if not point and "." in cell and _NUMBER.fullmatch(cell.replace(",", "")):
                point = line
            if not comma and "," in cell and _NUMBER.fullmatch(cell.replace(".", "")):
                comma = line
        if point and comma:
            raise InputError(
                f"mixes decimal points (line {point}) and decimal commas (line {comma}); use one of them",
                file=file,
            )


def plausible(heading: Heading, degC: NDArray[np.float64], lines: Sequence[int], file: Path) -> None:
    """Refuse what no thermocouple in a tyre can have read.

    Raises
    ------
    InputError : below absolute zero, or above 2000 degC; says line and column.
    """
    for index in np.flatnonzero((degC < -273.15 - 1e-9) | (degC > HOTTEST))[:1]:
        cold = degC[index] < 0.0
        wrong = "is below absolute zero" if cold else f"is above {HOTTEST:g} degC (an open thermocouple?)"
        place = _place(lines[index], f"{heading.name} [{heading.unit}]")
        raise InputError(
            f"{place}: {degC[index]:g} degC {wrong}; leave the cell empty where there is no reading",
            file=file,
        )
