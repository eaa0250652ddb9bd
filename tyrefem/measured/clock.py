"""Times as hours, minutes and seconds: ``12:30:01.5``.

Two numbers, ``12:30``, may be hours and minutes or minutes and seconds: the heading must say which, as ``[mm:ss]``.
``1:30 PM`` is 13:30:00.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError

#: Form -> s per number.
FORMS = {"h:mm:ss": (3600, 60, 1), "h:mm": (3600, 60), "mm:ss": (60, 1)}
_SECONDS = r"[0-5]?\d(?:[.,]\d+)?"
_CELLS = {
    "h:mm:ss": re.compile(rf"(\d{{1,4}}):([0-5]?\d):({_SECONDS})", re.ASCII),
    "h:mm": re.compile(r"(\d{1,4}):([0-5]\d)", re.ASCII),
    "mm:ss": re.compile(rf"(\d{{1,5}}):({_SECONDS})", re.ASCII),
}
_UNITS = {
    "h:mm:ss": re.compile(r"h{1,2}:m(?:m|in)?:s{1,2}(?:[.,][s0fx]+)?|hms", re.IGNORECASE),
    "h:mm": re.compile(r"h{1,2}:m(?:m|in)?", re.IGNORECASE),
    "mm:ss": re.compile(r"m(?:m|in)?:s{1,2}(?:[.,][s0fx]+)?", re.IGNORECASE),
}
_HALF_DAYS = re.compile(
    r"(?P<before>|.*\s)(?P<h>0?[1-9]|1[0-2])(?P<rest>:[0-5]\d(?P<s>:[\d.,]+)?)\s*(?P<half>[ap])\.?m\.?",
    re.ASCII | re.IGNORECASE,
)
_DAY = 86_400_000_000


def in_24_hours(cell: str) -> str:
    """A clock time with AM or PM, alone or behind a date, as h:mm:ss of the whole day; all else as it is.

    >>> in_24_hours("1:30:01.5 pm"), in_24_hours("2024-05-01 12:05 AM"), in_24_hours("13:30")
    ('13:30:01.5', '2024-05-01 00:05:00', '13:30')
    """
    match = _HALF_DAYS.fullmatch(cell)
    if match is None:
        return cell
    hour = int(match["h"]) % 12 + (12 if match["half"].lower() == "p" else 0)
    return f"{match['before']}{hour:02}{match['rest']}{'' if match['s'] else ':00'}"


def form_of_unit(unit: str) -> str | None:
    """The form that a heading states in place of its unit.

    >>> form_of_unit("HH:MM:SS"), form_of_unit("min:s"), form_of_unit("s")
    ('h:mm:ss', 'mm:ss', None)
    """
    return next((form for form, pattern in _UNITS.items() if pattern.fullmatch(unit)), None)


def has_three_numbers(cell: str) -> bool:
    """Whether a cell is h:mm:ss, which can be nothing else.

    >>> has_three_numbers("0:00:01.5"), has_three_numbers("12:30")
    (True, False)
    """
    return _CELLS["h:mm:ss"].fullmatch(cell) is not None


def may_be_clock(cell: str) -> bool:
    """Whether a cell has two or three numbers with colons."""
    return any(pattern.fullmatch(cell) for pattern in _CELLS.values())


def clock_times(cells: Sequence[str], lines: Sequence[int], column: str, form: str, file: Path) -> NDArray[np.int64]:
    """(n,) microseconds of times in a form of `FORMS`.

    Raises
    ------
    InputError : a cell in another form; the message has line and column.
    """
    pattern, factors = _CELLS[form], FORMS[form]
    times = np.empty(len(cells), dtype=np.int64)
    for index, (cell, line) in enumerate(zip(cells, lines, strict=True)):
        match = pattern.fullmatch(cell)
        if match is None:
            wrong = (
                f"{cell[:40]!r} is not a time like {form}" if cell else "the cell is empty; every row needs its time"
            )
            raise InputError(f"line {line}, column '{column[:60]}': {wrong}", file=file)
        parts = (float(part.replace(",", ".")) for part in match.groups())
        times[index] = round(sum(factor * part for factor, part in zip(factors, parts, strict=True)) * 1e6)
    return times


def over_midnight(times: NDArray[np.int64]) -> NDArray[np.int64]:
    """(n,) microseconds of one run, counted on by a day where its clock passes midnight.

    A clock passes midnight if it falls back, and is then no further on than twice the run's longest other step.
    All else that falls back stays as it is.
    """
    steps = np.diff(times)
    falls = steps < 0
    if not falls.any() or falls.all() or times.max() >= _DAY:
        return times
    counted_on = np.where(falls, steps + _DAY, steps)
    if counted_on[falls].max() > 2 * steps[~falls].max():
        return times
    return np.concatenate([times[:1], times[0] + np.cumsum(counted_on)])
