"""Times as timestamps: ``2024-05-01T12:30:01.5+02:00``, with a blank in place of the T, or in two columns.

Dates are ISO 8601, or have one meaning all the same: ``2024/05/01``, ``01.05.2024``. ``05/01/2024`` has two: it is read
where only one of them is a date in all rows, or both give the same times.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError

#: A date alone is its midnight, which spreadsheets write so.
_TIMESTAMP = re.compile(r"\d{4}-\d{2}-\d{2}(?:[T ]\d{2}:\d{2}|\Z)")
_DATE = re.compile(
    r"(?:(?P<y>\d{4})([-/.])(?P<m>\d{1,2})\2(?P<d>\d{1,2})|(?P<day>\d{1,2})\.(?P<month>\d{1,2})\.(?P<year>\d{4})"
    r"|(?P<first>\d{1,2})/(?P<second>\d{1,2})/(?P<in_year>\d{4}))"
    r"(?:[T ]+(?P<clock>\d.*))?",
    re.ASCII,
)


#: Order of slashed dates -> groups of `_DATE` that are month and day.
ORDERS = {"month/day/year": ("first", "second"), "day/month/year": ("second", "first")}
MONTH_FIRST, DAY_FIRST = ORDERS


def are_timestamps(cells: Sequence[str]) -> bool:
    """True if the first cell of a column of times that is not empty is a timestamp.

    >>> are_timestamps(["", "2024-05-01 12:30:01"]), are_timestamps(["2024-05-01"])
    (True, True)
    >>> are_timestamps(["0.5"]), are_timestamps([])
    (False, False)
    """
    return _TIMESTAMP.match(_iso(next(filter(None, cells), ""))) is not None


def is_day_first(cell: str) -> bool:
    """Whether a cell begins with a date like ``01.05.2024``."""
    match = _DATE.fullmatch(cell)
    return match is not None and match["day"] is not None


def is_slashed(cell: str) -> bool:
    """Whether a cell begins with a date like ``05/01/2024``, whose order is not known."""
    match = _DATE.fullmatch(cell)
    return match is not None and match["first"] is not None


def stamped(date: str, clock: str) -> str:
    """A date and a clock time of one row as a timestamp.

    >>> stamped("01.05.2024", "9:30:01"), stamped("05/01/2024", "")
    ('01.05.2024 9:30:01', '')
    """
    return f"{date} {clock}" if date and clock else ""


def microseconds(
    cells: Sequence[str], lines: Sequence[int], column: str, file: Path, order: str = MONTH_FIRST
) -> NDArray[np.int64]:
    """(n,) microseconds since the first timestamp, exact; ``order``: of slashed dates, a key of `ORDERS`.

    Raises
    ------
    InputError : no timestamp, or offsets from UTC in some of them only; the message has line and column.
    """
    times: list[datetime] = []
    for cell, line in zip(cells, lines, strict=True):
        where = f"line {line}, column '{column[:60]}'"
        try:
            times.append(datetime.fromisoformat(_iso(cell, order)))
        except ValueError:
            words = f"{cell[:40]!r} is not a timestamp like 2024-05-01T12:30:01"
            words += ", but the first time is" if times else " or 2024-05-01T12:30:01+02:00; the date must exist"
            raise InputError(f"{where}: {words}", file=file) from None
        if (times[-1].tzinfo is None) != (times[0].tzinfo is None):
            words = "one timestamp has an offset from UTC and another has none"
            raise InputError(f"{where}: {words}", file=file)
    return np.array([(time - times[0]) // timedelta(microseconds=1) for time in times], dtype=np.int64)


def _iso(cell: str, order: str = MONTH_FIRST) -> str:
    """A timestamp with its date as ISO 8601 and two digits of the hour; all else as it is."""
    match = _DATE.fullmatch(cell)
    if match is None:
        return cell
    of_month, of_day = ORDERS[order]
    groups = (("year", "y", "in_year"), ("month", "m", of_month), ("day", "d", of_day))
    year, month, day = (next(match[name] for name in names if match[name]) for names in groups)
    clock = match["clock"]
    text = f"{year}-{month:0>2}-{day:0>2}"
    return text if clock is None else f"{text} {'0' if clock[1:2] == ':' else ''}{clock}"
