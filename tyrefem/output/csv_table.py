"""A table as a CSV file, without pandas, whose import takes as long as the run of a small study."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from tyrefem.output import atomic_path

#: Columns with twelve digits: six are too few for a time, as no two rows may have the same.
TIMES = ("time_s", "time [s]")


def columns_of(rows: Sequence[Mapping[str, Any]]) -> dict[str, list[Any]]:
    """Rows with the same keys as columns.

    >>> columns_of([{"region": "tread", "time_s": 1.0}, {"region": "bead", "time_s": 2.0}])
    {'region': ['tread', 'bead'], 'time_s': [1.0, 2.0]}
    """
    return {name: [row[name] for row in rows] for name in (rows[0] if rows else ())}


def write_csv(columns: Mapping[str, Iterable[Any]], path: Path) -> Path:
    """Write columns of equal length, completely or not at all: floats with six digits, `TIMES` with twelve;
    NaN and None empty.

    Raises
    ------
    InputError : the file cannot be written.
    """
    # `tolist` makes Python's numbers of numpy's.
    values = [each.tolist() if hasattr(each, "tolist") else list(each) for each in columns.values()]
    digits = [12 if name in TIMES else 6 for name in columns]
    with atomic_path(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(map(_cell, row, digits) for row in zip(*values, strict=True))
    return path


def _cell(value: Any, digits: int) -> Any:
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.{digits}g}"
    return value
