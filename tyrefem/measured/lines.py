"""A logger's file, or a sheet of a workbook, as numbered rows of cells: encoding, comments, delimiter recognised."""

from __future__ import annotations

import codecs
import csv
import os
import re
import unicodedata
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from tyrefem.errors import InputError, nearest
from tyrefem.estimates.work import TEXT, check_memory
from tyrefem.measured.heading import is_time, parts
from tyrefem.measured.names import in_table_words
from tyrefem.measured.toa5 import one_heading
from tyrefem.measured.unit_row import with_units
from tyrefem.measured.workbook import is_workbook, sheet_texts
from tyrefem.output import note_input

#: Largest size of a table; larger files are mistakes (a video, a raw waveform). 5 million rows of 10 sensors fit.
LARGEST_BYTES = 400_000_000
#: Largest number of lines of free text above the heading.
LONGEST_PREAMBLE = 100
DELIMITERS = "\t;,"
_CONTROL = re.compile("[\x00-\x08\x0e-\x1f]")
_COMMENT = re.compile(r'^[\s"]*(?:#|//)')


@dataclass(frozen=True)
class Lines:
    """The heading and the rows of a table, with their line numbers in the file (counted from 1).

    ``notes``: how the heading was read, if not as it stands.
    """

    comments: tuple[str, ...]
    heading: tuple[str, ...]
    heading_line: int
    rows: list[list[str]]
    numbers: list[int]
    notes: tuple[str, ...] = ()


class NoTableError(InputError):
    """A text without any heading of a table of histories."""


def decode(path: Path) -> str:
    """The text of a file, or of the only filled sheet of a workbook. Errors of `texts`, or several sheets."""
    of_sheets = texts(path)
    if len(of_sheets) > 1:
        raise InputError(f"has several sheets ({', '.join(of_sheets)}): keep one of them", file=path)
    return next(iter(of_sheets.values()))


def texts(path: Path) -> dict[str, str]:
    """The texts of a file by sheet of a workbook; any other file has one, "".

    UTF-8 with or without mark, UTF-16 with mark, else Windows-1252 or Latin-1. Letters and marks are composed.

    Raises
    ------
    InputError : no such file, a folder, empty, far too large, no text and no workbook.
    """
    note_input(path)
    try:
        if path.stat().st_size > LARGEST_BYTES:
            raise InputError(f"larger than {LARGEST_BYTES // 10**6} MB; thin the table out", file=path)
        size = path.stat().st_size
        check_memory(TEXT * size, f"a table of {size / 1e6:.0f} MB")
        data = path.read_bytes()
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise error.within(file=path) from None
        reason = f"cannot be read: {getattr(error, 'strerror', None) or error}{_beside(path)}"
        raise InputError(reason, file=path) from None
    if is_workbook(data):
        of_sheets = sheet_texts(data, path).items()
        return {unicodedata.normalize("NFC", name): unicodedata.normalize("NFC", text) for name, text in of_sheets}
    try:
        marked = data.startswith((b"\xff\xfe", b"\xfe\xff"))
        text = data.decode("utf-16" if marked else "utf-8-sig")
    except UnicodeDecodeError:
        text = _in_one_byte(data.removeprefix(codecs.BOM_UTF8))
    binary = _CONTROL.search(text)
    if binary:
        line = text.count("\n", 0, binary.start()) + 1
        raise InputError(
            f"is not a text file (control character in line {line}): a CSV or a workbook is wanted", file=path
        )
    if not text.strip():
        raise InputError("is empty", file=path)
    return {"": unicodedata.normalize("NFC", text)}


def _in_one_byte(data: bytes) -> str:
    """Text with one byte per letter: Latin-1, or Windows' code page 1252, which has dashes and quotes beside it."""
    try:
        return data.decode("cp1252")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _beside(path: Path) -> str:
    """The nearest of the tables in the folder of a missing file, as a hint; empty without any."""
    names = []
    with suppress(OSError, ValueError):
        if not os.path.lexists(path):
            names = [file.name for file in path.parent.glob(f"*{path.suffix or '.csv'}") if file.is_file()]
    return nearest(path.name, names) if names else ""


def is_comment(line: str) -> bool:
    """Whether a line is a comment, perhaps in quotes."""
    return _COMMENT.match(line) is not None


def split(text: str, path: Path, rename: Mapping[str, str] | None = None) -> Lines:
    """The cells of a table's text. Blank lines, and lines that begin with ``#`` or ``//``, are not rows.

    A line that begins with ``;`` is a row (in a semicolon table its first cell is empty), not a comment.
    Up to 100 lines of free text may precede the heading, which is the first line with a time column. Units in a row
    of their own below it are joined to its names; so are those of a TOA5 table.

    Parameters
    ----------
    path : the file, in errors. rename : column -> name, for a time column that is called otherwise.

    Raises
    ------
    NoTableError : no time column.
    InputError : errors of `with_units`; rows longer or shorter than the heading.
    """
    rename = rename or {}
    lines = re.split("\r\n|\r|\n", text)
    comments, content = [], []
    for number, line in enumerate(lines, 1):
        if is_comment(line):
            comments.append(_COMMENT.sub("", line).strip(DELIMITERS + ' "'))
        elif line.strip(DELIMITERS + ' "'):
            content.append((number, line))
    if not content:
        raise NoTableError("has only comments, no heading and no readings", file=path)
    toa5 = one_heading(content)
    if toa5 is not None:
        comments, content = [toa5[0].replace('"', "").strip(DELIMITERS + " "), *comments], toa5[1]
    try:
        position, delimiter = _heading(content, path, rename)
    except InputError as error:
        raise error.within(file=path) from None
    number, line = content[position]
    heading = tuple(_without_trailing_empty(_cells(line, delimiter, number, path)))
    place = f", line {number}," if position else ""
    rows, numbers = _rows(content[position + 1 :], delimiter, heading, path, place)
    if toa5 is not None and not rows:
        raise InputError("has a heading but no readings", file=path)
    preamble = [text.strip(DELIMITERS + ' "') for _, text in content[:position]]
    notes: tuple[str, ...] = ()
    if rows:
        try:
            joined = with_units(heading, rows[0], [rank is not None for rank in (_rank(c, rename) for c in heading)])
        except InputError as error:
            raise InputError(f"line {numbers[0]}: {error.message}", file=path) from None
        if joined is not None:
            notes = (f"units are those of line {numbers[0]}",)
            heading, rows, numbers = joined, rows[1:], numbers[1:]
    return Lines((*preamble, *comments), heading, number, rows, numbers, notes)


def _heading(content: list[tuple[int, str]], path: Path, rename: Mapping[str, str]) -> tuple[int, str]:
    """Index and delimiter of the line with a time column: the first of those of the lowest `_rank`."""
    best: tuple[int, int, str] | None = None
    surest = 0 if rename else 2
    for position, (number, line) in enumerate(content[: LONGEST_PREAMBLE + 1]):
        if best is not None and best[0] <= surest:
            break
        for delimiter in DELIMITERS:
            cells = _cells(line, delimiter, number, path, strict=False)
            for rank in (_rank(cell, rename) for cell in cells):
                if rank is not None and (best is None or rank < best[0]):
                    best = rank, position, delimiter
    if best is not None:
        return best[1:]
    number, line = content[0]
    raise NoTableError(
        f"line {number}: no time column in {line.strip()[:60]!r}; the heading must have "
        "'time [s]' (or [min], [h], [ms]) and one column per sensor, like 'crown [degC]'; "
        "rename a time column of another name to 'time'",
        file=path,
    )


def _rank(cell: str, rename: Mapping[str, str]) -> int | None:
    """How surely a cell is the heading of a time column, 0 most; None: it is none.

    Names that the user gives go before all others, names in other words behind them; with a unit before without.
    """
    renamed = in_table_words(cell, rename)
    kinds = renamed != cell and is_time(renamed), is_time(cell), is_time(cell, in_other_words=True)
    if not any(kinds):
        return None
    return 2 * kinds.index(True) + (not parts(renamed)[1])


def _rows(
    content: list[tuple[int, str]], delimiter: str, heading: tuple[str, ...], path: Path, place: str
) -> tuple[list[list[str]], list[int]]:
    width = len(heading)
    rows, numbers = [], []
    for number, line in content:
        cells = _cells(line, delimiter, number, path)
        if len(cells) > width and not any(cells[width:]):
            cells = cells[:width]
        if len(cells) != width:
            hint = " (a cell without a reading is empty, not left out)"
            if len(cells) > width:
                hint = " (decimal commas need ';' between the columns)" if delimiter == "," else ""
            raise InputError(f"line {number}: {len(cells)} cells, but the heading{place} has {width}{hint}", file=path)
        rows.append(cells)
        numbers.append(number)
    return rows, numbers


def _cells(line: str, delimiter: str, number: int, path: Path, *, strict: bool = True) -> list[str]:
    if '"' not in line:
        return [cell.strip() for cell in line.split(delimiter)]
    try:
        cells = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True, strict=strict), [])
    except csv.Error as error:
        message = f"line {number}: quotes do not match ({error}); a cell must end in its line"
        raise InputError(message, file=path) from None
    return [cell.strip() for cell in cells]


def _without_trailing_empty(cells: list[str]) -> list[str]:
    last = max(index for index, cell in enumerate(cells) if cell)
    return cells[: last + 1]
