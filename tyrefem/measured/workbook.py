"""Sheets of a workbook (Excel, OpenDocument) as text with tabs, so that the rules of a logger's file hold for them."""

from __future__ import annotations

import io
import math
import re
import zipfile
from datetime import date, datetime, time, timedelta
from pathlib import Path
from typing import IO
from xml.etree import ElementTree

from tyrefem.errors import InputError
from tyrefem.estimates.work import check_memory

#: How the files of workbooks begin: a zip archive, and the older format of Excel.
SIGNATURES = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0")
#: Day 0 of Excel. Times of a day or more have dates in that year.
_DAY_0 = datetime(1899, 12, 31)
#: A time of a day or more in an OpenDocument sheet.
_DURATION = re.compile(r"PT(\d{1,6})H(\d{1,2})M(\d{1,2})(?:[.,](\d{1,6})\d*)?S", re.ASCII)
#: Bytes of memory per cell of a sheet, empty or not, to its last row and column (measured: 75 for empty ones).
CELL = 80.0
#: File of a sheet in an Excel workbook; a cell in it that is not empty: its column and its row.
_SHEET = re.compile(r"(?:.*/)?worksheets/[^/]+\.xml")
_FILLED = re.compile(rb'<(?:\w+:)?c\b[^<>]*?\sr="([A-Z]{1,3})(\d{1,7})"[^<>]*(?<!/)>\s*<(?!/)')
#: Files of an Excel workbook with the names of its sheets, and with the files of the sheets.
_BOOK = ("workbook.xml", "_rels/workbook.xml.rels")
#: A cell: its attributes, and what is in it.
_CELL = re.compile(r"<(?:\w+:)?c\b([^<>]*[^<>/])>(.*?)</(?:\w+:)?c>", re.DOTALL)
_VALUE = re.compile(r"<(?:\w+:)?v\b[^<>]*>([^<]+)")
_FORMULA = re.compile(r"<(?:\w+:)?f\b")
_Cell = float | str | bool | date | datetime | time | timedelta


def is_workbook(data: bytes) -> bool:
    """Whether a file's bytes are those of a workbook (or of another archive)."""
    return data.startswith(SIGNATURES)


def sheet_texts(data: bytes, path: Path) -> dict[str, str]:
    """Visible sheet that is not empty -> its rows as lines, row 1 in line 1; cells of formulas have their saved values.

    Raises
    ------
    InputError : an archive that is no workbook, or one with a password; no such sheet; a cell so far off its table
        that the sheet does not fit into memory.
    """
    from python_calamine import CalamineError, PasswordError, SheetTypeEnum, SheetVisibleEnum, load_workbook

    _check_extent(data, path)
    try:
        workbook = load_workbook(io.BytesIO(data))
        names = [
            sheet.name
            for sheet in workbook.sheets_metadata
            if sheet.typ == SheetTypeEnum.WorkSheet and sheet.visible == SheetVisibleEnum.Visible
        ]
        rows = {name: workbook.get_sheet_by_name(name).to_python(skip_empty_area=False) for name in names}
    except PasswordError:
        raise InputError("is a workbook with a password: save it without one, or its sheet as CSV", file=path) from None
    except (CalamineError, OverflowError) as error:
        message = f"is a workbook or archive that cannot be read ({error!s:.80}): save the sheet as CSV"
        raise InputError(message, file=path) from None
    texts = {name: "\n".join("\t".join(map(_text, row)) for row in of_sheet) for name, of_sheet in rows.items()}
    texts = {name: text for name, text in texts.items() if text.strip()}
    if not texts:
        raise InputError("is a workbook without a filled and visible sheet", file=path)
    return texts


def check_formulas(data: bytes, path: Path) -> None:
    """Check that the visible sheets of an Excel workbook have a value for each formula; other formats are not checked.

    Raises
    ------
    InputError : a cell with an error such as #DIV/0!, or with a formula that was not computed.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            sheets = [archive.read(name).decode("utf-8") for name in _visible_parts(archive)]
    except Exception:  # zipfile and the parser raise many kinds; the reader says what is wrong with the archive
        return
    for attributes, content in (cell.groups() for text in sheets for cell in _CELL.finditer(text)):
        kind, value = _attribute(attributes, "t"), _VALUE.search(content)
        place = f"cell {_attribute(attributes, 'r')}"
        if kind == "e":
            raise InputError(f"{place}: {value[1] if value else 'an error'} is the error of a formula", file=path)
        if not kind and value is None and _FORMULA.search(content):
            message = f"{place}: a formula without its value; open and save the workbook, or write the value"
            raise InputError(message, file=path)


def _visible_parts(archive: zipfile.ZipFile) -> list[str]:
    """Names of the files of the visible sheets in an Excel workbook."""
    book, links = (ElementTree.fromstring(archive.read(f"xl/{name}")) for name in _BOOK)
    targets = {link.get("Id"): link.get("Target", "") for link in links}
    shown = [
        sheet for sheet in book.iter() if sheet.tag.endswith("}sheet") and sheet.get("state", "visible") == "visible"
    ]
    files = [next(targets[value] for key, value in sheet.items() if key.endswith("}id")) for sheet in shown]
    return [target[1:] if target.startswith("/") else f"xl/{target}" for target in files]


def _attribute(attributes: str, name: str) -> str:
    match = re.search(rf'\b{name}="([^"]*)"', attributes)
    return "" if match is None else match[1]


def _check_extent(data: bytes, path: Path) -> None:
    """Raise InputError for an Excel sheet whose last row and column make more cells than fit into memory.

    Reading makes all cells up to them, and ends the whole process where they do not fit.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            parts = [name for name in archive.namelist() if _SHEET.fullmatch(name)]
            corners = [_last_cell(archive.open(name)) for name in parts]
    except Exception:  # zipfile raises many kinds; the reader says what is wrong with the archive
        return
    for column, row in corners:
        columns = sum(26**place * (ord(letter) - 64) for place, letter in enumerate(reversed(column)))
        try:
            check_memory(CELL * row * columns, f"a sheet's last cell is in column {column} and row {row:,}")
        except InputError as error:
            words = f"{error.message}; empty the cells beyond the table, or save the sheet as CSV"
            raise InputError(words, file=path) from None


def _last_cell(stream: IO[bytes]) -> tuple[str, int]:
    """Last column and last row of a sheet with a cell that is not empty; "" and 0 without such a cell."""
    columns, last, text = set[bytes](), 0, b""
    while piece := stream.read(1 << 20):
        # A cell may begin in the piece before.
        text = text[-1000:] + piece
        filled = _FILLED.findall(text)
        columns.update(column for column, _ in filled)
        last = max(last, *(int(row) for _, row in filled)) if filled else last
    return max(columns, key=lambda column: (len(column), column), default=b"").decode("ascii"), last


def _text(cell: _Cell) -> str:
    """A cell as a logger writes it, in one line.

    >>> [_text(cell) for cell in (25.0, 0.1, "a\\n[K]", datetime(2024, 5, 1, 12, 30), timedelta(hours=30))]
    ['25', '0.1', 'a [K]', '2024-05-01T12:30:00', '30:00:00']
    >>> [_text(cell) for cell in (math.inf, date(1900, 1, 1), "PT30H00M01.5S")]
    ['inf', '24:00:00', '30:00:01.5']
    """
    match cell:
        case bool():
            return str(cell)
        case float() | int():
            return str(int(cell)) if math.isfinite(cell) and cell == int(cell) and abs(cell) < 1e15 else repr(cell)
        case date() if cell.year <= 1900:
            # A whole number of days is a date.
            return _clock((cell if isinstance(cell, datetime) else datetime.combine(cell, time())) - _DAY_0)
        case date():
            return cell.isoformat()
        case time():
            return _clock(timedelta(0, cell.hour * 3600 + cell.minute * 60 + cell.second, cell.microsecond))
        case timedelta():
            return _clock(cell)
    if duration := _DURATION.fullmatch(cell):
        hours, minutes, seconds, fraction = duration.groups(default="0")
        since = int(hours) * 3600 + int(minutes) * 60 + int(seconds)
        return _clock(timedelta(0, since, int(fraction.ljust(6, "0"))))
    words = " ".join(cell.split())
    return '"' + words.replace('"', '""') + '"' if '"' in words else words


def _clock(since: timedelta) -> str:
    """h:mm:ss, with decimals where there are any; a time before 0 has a sign, which no table may have."""
    sign, microseconds = ("-" if since < timedelta(0) else ""), abs(since) // timedelta(microseconds=1)
    seconds, fraction = divmod(microseconds, 1_000_000)
    decimals = f".{fraction:06}".rstrip("0") if fraction else ""
    return f"{sign}{seconds // 3600}:{seconds // 60 % 60:02}:{seconds % 60:02}{decimals}"
