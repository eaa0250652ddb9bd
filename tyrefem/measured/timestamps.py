"""Times as ISO 8601 timestamps: ``2024-05-01T12:30:01.5+02:00``, also with a blank in place of the T."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError

_TIMESTAMP = re.compile(r"\d{4}-\d{2}-\d{2}[T ]\d{2}:\d{2}")


def are_timestamps(cells: Sequence[str]) -> bool:
    """True if the first cell of a column of times that is not empty is a timestamp.

    >>> are_timestamps(["", "2024-05-01 12:30:01"]), are_timestamps(["0.5"]), are_timestamps([])
    (True, False, False)
    """
    return _TIMESTAMP.match(next(filter(None, cells), "")) is not None


def microseconds(cells: Sequence[str], lines: Sequence[int], column: str, file: Path) -> NDArray[np.int64]:
    """(n,) microseconds since the first timestamp, exact.

    Raises
    ------
    InputError : no timestamp, or offsets from UTC in some of them only; the message has line and column.
    """
    times: list[datetime] = []
    for cell, line in zip(cells, lines, strict=True):
        where = f"line {line}, column '{column[:60]}'"
        try:
            times.append(datetime.fromisoformat(cell))
        except ValueError:
            words = f"{cell[:40]!r} is not a timestamp like 2024-05-01T12:30:01"
            words += ", but the first time is" if times else " or 2024-05-01T12:30:01+02:00; the date must exist"
            raise InputError(f"{where}: {words}", file=file) from None
        if (times[-1].tzinfo is None) != (times[0].tzinfo is None):
            words = "one timestamp has an offset from UTC and another has none"
            raise InputError(f"{where}: {words}", file=file)
    return np.array([(time - times[0]) // timedelta(microseconds=1) for time in times], dtype=np.int64)
