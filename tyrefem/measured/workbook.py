"""Sheets of a workbook (Excel, OpenDocument) as text with tabs, so that the rules of a logger's file hold for them."""

from __future__ import annotations

import io
from datetime import date, datetime, time, timedelta
from pathlib import Path

from tyrefem.errors import InputError

#: How the files of workbooks begin: a zip archive, and the older format of Excel.
SIGNATURES = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0")
#: Day 0 of Excel. Times of a day or more have dates in that year.
_DAY_0 = datetime(1899, 12, 31)
_Cell = float | str | bool | date | datetime | time | timedelta


def is_workbook(data: bytes) -> bool:
    """Whether a file's bytes are those of a workbook (or of another archive)."""
    return data.startswith(SIGNATURES)


def sheet_texts(data: bytes, path: Path) -> dict[str, str]:
    """Visible sheet that is not empty -> its rows as lines, row 1 in line 1; cells of formulas have their saved values.

    Raises
    ------
    InputError : an archive that is no workbook, or one with a password; no such sheet.
    """
    from python_calamine import CalamineError, PasswordError, SheetTypeEnum, SheetVisibleEnum, load_workbook

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
    except CalamineError as error:
        message = f"is a workbook or archive that cannot be read ({error!s:.80}): save the sheet as CSV"
        raise InputError(message, file=path) from None
    texts = {name: "\n".join("\t".join(map(_text, row)) for row in of_sheet) for name, of_sheet in rows.items()}
    texts = {name: text for name, text in texts.items() if text.strip()}
    if not texts:
        raise InputError("is a workbook without a filled and visible sheet", file=path)
    return texts


def _text(cell: _Cell) -> str:
    """A cell as a logger writes it, in one line.

    >>> [_text(cell) for cell in (25.0, 0.1, "a\\n[K]", datetime(2024, 5, 1, 12, 30), timedelta(hours=30))]
    ['25', '0.1', 'a [K]', '2024-05-01T12:30:00', '30:00:00']
    """
    match cell:
        case bool():
            return str(cell)
        case float() | int():
            return str(int(cell)) if cell == int(cell) and abs(cell) < 1e15 else repr(cell)
        case datetime() if cell.year <= 1900:
            return _clock(cell - _DAY_0)
        case date():
            return cell.isoformat()
        case time():
            return _clock(timedelta(0, cell.hour * 3600 + cell.minute * 60 + cell.second, cell.microsecond))
        case timedelta():
            return _clock(cell)
    words = " ".join(cell.split())
    return '"' + words.replace('"', '""') + '"' if '"' in words else words


def _clock(since: timedelta) -> str:
    """h:mm:ss, with decimals where there are any; a time before 0 has a sign, which no table may have."""
    sign, microseconds = ("-" if since < timedelta(0) else ""), abs(since) // timedelta(microseconds=1)
    seconds, fraction = divmod(microseconds, 1_000_000)
    decimals = f".{fraction:06}".rstrip("0") if fraction else ""
    return f"{sign}{seconds // 3600}:{seconds // 60 % 60:02}:{seconds % 60:02}{decimals}"
