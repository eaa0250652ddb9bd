"""Headings of TOA5 tables, which Campbell Scientific's loggers write: four lines above the readings.

They are the logger and its program, the names, the units, and how readings were made (``Smp``, ``Avg``). Spreadsheets
that save such a table write semicolons or tabs in place of its commas.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence

#: Units that say no more than what a column is: timestamps. Record numbers (RN) are known to `heading.is_channel`.
_NO_UNITS = ("", "TS")
_FIRST = re.compile(r'\s*"?TOA5"?([,;\t])')


def one_heading(content: Sequence[tuple[int, str]]) -> tuple[str, list[tuple[int, str]]] | None:
    """The logger's line of a TOA5 table, and its other lines with one heading: names with their units.

    None for any other table. ``content``: line number and text of each line that is not empty.

    >>> head = ['"TOA5","CR1000"', '"TIMESTAMP","crown"', '"TS","Deg C"', '"","Avg"', '"2026-05-01 10:00:00",25.1']
    >>> one_heading(list(enumerate(head, 1)))
    ('"TOA5","CR1000"', [(2, 'TIMESTAMP,crown [Deg C]'), (5, '"2026-05-01 10:00:00",25.1')])
    """
    match = _FIRST.match(content[0][1])
    if match is None or len(content) < 3:
        return None
    (_, logger), (number, first), (_, second), *rest = content
    names, units, *kinds = (
        next(csv.reader([line], delimiter=match[1])) for line in (first, second, *(line for _, line in rest[:1]))
    )
    if len(names) != len(units):
        return None
    cells = [
        name if unit.strip() in _NO_UNITS else f"{name} [{unit.strip()}]"
        for name, unit in zip(names, units, strict=True)
    ]
    heading = io.StringIO()
    csv.writer(heading, delimiter=match[1], lineterminator="").writerow(cells)
    has_kinds = bool(kinds) and not kinds[0][0].strip()  # a line of empty cells only is not among these
    return logger, [(number, heading.getvalue()), *rest[has_kinds:]]
