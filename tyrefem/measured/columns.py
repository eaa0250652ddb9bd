"""Columns of numbers: cells with decimal comma or point, empty for no reading; the readings of a sensor in degC."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import counted
from tyrefem.errors import InputError
from tyrefem.measured.heading import in_brackets, parts
from tyrefem.measured.lines import Lines
from tyrefem.quantity import KELVIN

Array = NDArray[np.float64]
#: degC; range of readings at a tyre. No air at the ground was colder than -89 degC, and a brake disc glows at 900 degC;
#: rubber chars at half of that. Loggers write codes beyond it (-200, 1372, 9999) for an open thermocouple.
COLDEST, HOTTEST = -90.0, 900.0
ABSOLUTE_ZERO = -KELVIN
#: Numbers of loggers for no reading, where they are beyond `COLDEST` or `HOTTEST`: -9999, 999.9.
_NINES = re.compile(r"[-+]?9{3,}(?:[.,]9+)?(?:[.,]?0*)", re.ASCII)
#: Texts of loggers and spreadsheets for "no reading", in small letters.
NO_READING = frozenset(("", "nan", "na", "n/a", "#n/a", "null", "none", "-", "--", "---"))
#: Texts of loggers for a broken or missing thermocouple: no reading, too, which a note says.
BROKEN = frozenset(("ol", "+ol", "-ol", "open", "over", "overload", "overrange", "over range"))
_NUMBER = re.compile(r"[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][-+]?\d+)?", re.ASCII)
_PLAIN = re.compile(r"[0-9.eE+\-\n]*")


@dataclass(frozen=True)
class SensorColumn:
    """A column of readings.

    Parameters
    ----------
    name : of the sensor. unit : degC, degF or K. column : its index in the row. heading : as it stands in the table.
    """

    name: str
    unit: str
    column: int
    heading: str

    @property
    def has_bare_unit(self) -> bool:
        """Whether the unit stands in the heading without brackets."""
        return in_brackets(self.heading)[1] is None

    @property
    def words(self) -> str:
        """Name and unit: "crown in degC"."""
        return f"{parts(self.heading)[0][:60]} in {self.unit}"

    def cells(self, lines: Lines) -> list[str]:
        """The column's cells."""
        return [row[self.column] for row in lines.rows]

    def to_degC(self, values: Array) -> Array:
        """Readings in this column's unit, converted to degC.

        >>> SensorColumn("crown", "degF", 1, "crown [degF]").to_degC(np.array([212.0])).tolist()
        [100.0]
        """
        if self.unit == "degF":
            return (values - 32.0) / 1.8
        return values + ABSOLUTE_ZERO if self.unit == "K" else values

    def readings(self, lines: Lines, file: Path) -> Array:
        """(n,) degC; NaN where there is no reading.

        Raises
        ------
        InputError : text; no reading in any row; below `COLDEST` or above `HOTTEST`.
        """
        cells = self.cells(lines)
        degC = self.to_degC(numbers(cells, lines.numbers, self.heading, file, gaps=True))
        beyond = np.flatnonzero((degC < COLDEST - 1e-9) | (degC > HOTTEST + 1e-9)).tolist()
        wrong = next((row for row in beyond if not _NINES.fullmatch(cells[row])), None)
        if wrong is not None:
            place = _place(lines.numbers[wrong], f"{self.name} [{self.unit}]")
            raise InputError(f"{place}: {degC[wrong]:g} degC {self._why_implausible(degC[wrong])}", file=file)
        degC[beyond] = np.nan
        if not np.isfinite(degC).any():
            raise InputError(f"column '{self.heading[:60]}' has no reading in any row", file=file)
        return degC

    def notes(self, lines: Lines, readings: Array) -> tuple[str, ...]:
        """A note on words and numbers for a broken thermocouple, if there are any."""
        cells = self.cells(lines)
        without = [cells[row] for row in np.flatnonzero(np.isnan(readings)).tolist()]
        broken = [cell for cell in without if cell.lower() not in NO_READING]
        if not broken:
            return ()
        words = ", ".join(dict.fromkeys(broken))
        return (f"no reading in {counted(len(broken), 'cell')} of '{self.heading[:60]}' ({words})",)

    def _why_implausible(self, degC: float) -> str:
        """What is wrong with a reading, and what to do."""
        written = degC - ABSOLUTE_ZERO
        if self.unit == "K" and degC < COLDEST and COLDEST <= written <= HOTTEST:
            return f"({written:g} K) is too cold; K is kelvin: a thermocouple of type K is written '{self.name} [degC]'"
        what = f"is above {HOTTEST:g} degC (an open thermocouple?)"
        if degC < COLDEST:
            what = "is below absolute zero" if degC < ABSOLUTE_ZERO else f"is below {COLDEST:g} degC"
        return f"{what}; leave the cell empty where there is no reading, or ignore the column"


def bare_units(sensors: Sequence[SensorColumn]) -> tuple[str, ...]:
    """A note on units without brackets, if there are any."""
    bare = [sensor.words for sensor in sensors if sensor.has_bare_unit]
    return (f"units without brackets: {', '.join(bare)}",) if bare else ()


def numbers(cells: Sequence[str], lines: Sequence[int], column: str, file: Path, *, gaps: bool) -> NDArray[np.float64]:
    """(n,) floats of one column; NaN for no reading.

    Raises
    ------
    InputError : text, an infinite number, or (without ``gaps``) an empty cell; the message has line and column.
    """
    quick = _plain_numbers(cells, gaps)
    if quick is not None:
        return quick
    values = np.full(len(cells), np.nan)
    for index, cell in enumerate(cells):
        if gaps and (cell.lower() in NO_READING or cell.lower() in BROKEN):
            continue
        if _NUMBER.fullmatch(cell) is None:
            raise InputError(f"{_place(lines[index], column)}: {_reason(cell, gaps)}", file=file)
        values[index] = float(cell.replace(",", "."))
        if not np.isfinite(values[index]):
            raise InputError(f"{_place(lines[index], column)}: {cell[:30]!r} is not finite", file=file)
    return values


def has_words_only(cells: Sequence[str]) -> bool:
    """Whether every cell of a column has letters, and none a number, a clock time or a word for a missing reading.

    A column without cells has no words.
    """
    gaps = NO_READING | BROKEN
    return bool(cells) and all(
        any(map(str.isalpha, cell)) and ":" not in cell and cell.lower() not in gaps and not is_number(cell)
        for cell in set(cells)
    )


def is_number(cell: str) -> bool:
    """Whether a cell is a number, with decimal comma or point."""
    return _NUMBER.fullmatch(cell) is not None


def _plain_numbers(cells: Sequence[str], gaps: bool) -> NDArray[np.float64] | None:
    """The whole column if it has only plain numbers (ten times faster); None if cells need a closer check."""
    if _PLAIN.fullmatch("\n".join(cells)) is None or (not gaps and "" in cells):
        return None
    try:
        values = np.array([cell or "nan" for cell in cells], dtype=float)
    except ValueError:
        return None
    return None if np.isinf(values).any() else values


def _reason(cell: str, gaps: bool) -> str:
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


def check_decimal_mark(rows: Sequence[Sequence[str]], lines: Sequence[int], columns: Sequence[int], file: Path) -> None:
    """Raise an error for a table with decimal points and decimal commas: one of them is a thousands separator.

    Raises
    ------
    InputError : the message has the first line of each kind.
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
