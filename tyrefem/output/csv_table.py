"""A table as a CSV file, without pandas, whose import takes as long as the run of a small study."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from tyrefem.output import atomic_path


def columns_of(rows: Sequence[Mapping[str, Any]]) -> dict[str, list[Any]]:
    """Rows with the same keys as columns.

    >>> columns_of([{"region": "tread", "time_s": 1.0}, {"region": "bead", "time_s": 2.0}])
    {'region': ['tread', 'bead'], 'time_s': [1.0, 2.0]}
    """
    return {name: [row[name] for row in rows] for name in (rows[0] if rows else ())}


def write_csv(columns: Mapping[str, Iterable[Any]], path: Path) -> Path:
    """Write columns of equal length, completely or not at all: floats with six digits, NaN and None empty.

    Raises
    ------
    InputError : the file cannot be written.
    """
    # `tolist` makes Python's numbers of numpy's.
    values = [each.tolist() if hasattr(each, "tolist") else list(each) for each in columns.values()]
    with atomic_path(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows([_cell(value) for value in row] for row in zip(*values, strict=True))
    return path


def _cell(value: Any) -> Any:
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.6g}"
    return value
