"""Names that a user gives for the columns of tables: columns to rename, columns to leave out."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tyrefem.errors import InputError, nearest, quoted
from tyrefem.measured.heading import is_time, parts


@dataclass(frozen=True)
class ColumnNames:
    """Names for the columns of all tables: ``rename``, column -> sensor, time or run, and columns to ``ignore``."""

    rename: Mapping[str, str]
    ignore: tuple[str, ...]

    @classmethod
    def of(cls, *, ignore: Any = (), rename: Any = None) -> ColumnNames:
        """The names as a user of Python gives them; a text in ``ignore`` is one column.

        Raises
        ------
        InputError : ``ignore`` is not one or several texts, or ``rename`` has not a text for each text.

        >>> ColumnNames.of(ignore="room", rename={"T1": "crown"})
        ColumnNames(rename={'T1': 'crown'}, ignore=('room',))
        """
        columns = (ignore,) if isinstance(ignore, str) else ignore
        columns = tuple(columns) if isinstance(columns, Iterable) and not hasattr(columns, "magnitude") else (columns,)
        if not all(isinstance(name, str) for name in columns):
            raise InputError(f"must be a column's name, or a list of them, not {ignore!r:.60}", field="ignore")
        names = {} if rename is None else rename
        if not isinstance(names, Mapping) or not all(isinstance(text, str) for pair in names.items() for text in pair):
            message = f"must give columns their sensors, like {{'T1': 'crown'}}, not {rename!r:.60}"
            raise InputError(message, field="rename")
        return cls({_composed(a): _composed(b) for a, b in names.items()}, tuple(map(_composed, columns)))

    def require(self, columns: Sequence[str]) -> None:
        """Raises InputError for names that no table has."""
        for names, purpose in ((self.rename, "to rename"), (self.ignore, "to ignore")):
            missing = [name for name in names if name not in {*columns, *self.rename.values()}]
            if missing:
                raise missing_columns_error(missing, purpose, dict.fromkeys(parts(name)[0] for name in columns))


def is_time_or_run(name: str) -> bool:
    """Whether a new name makes a column that of times or runs."""
    return is_time(name) or name.lower() == "run"


def in_table_words(text: str, rename: Mapping[str, str]) -> str:
    """A heading with the name that ``rename`` gives to a column of times or runs; all others as they are.

    Raises
    ------
    InputError : the new name has a unit other than that of the heading.

    >>> in_table_words("Zeit [s]", {"Zeit": "time"}), in_table_words("Dauer", {"Dauer": "time [mm:ss]"})
    ('time [s]', 'time [mm:ss]')
    """
    name, unit = parts(text)
    new = rename.get(text, rename.get(name, ""))
    if new.lower() == "run":
        return new
    if not is_time(new):
        return text
    new_name, new_unit = parts(new)
    if unit and new_unit and unit != new_unit:
        raise InputError(f"column '{text}' has its unit; rename it to '{new_name}' instead of '{new}'", field="rename")
    unit = unit or new_unit
    return f"{new_name} [{unit}]" if unit else new_name


def _composed(name: str) -> str:
    """A name as tables have it: a letter and its mark as one character."""
    return unicodedata.normalize("NFC", name)


def missing_columns_error(
    names: Iterable[str], purpose: str, columns: Iterable[str], file: Path | None = None
) -> InputError:
    """The error for missing columns: all of them, each with the nearest name."""
    missing, known = list(names), list(columns)
    if len(missing) == 1:
        return InputError(f"no column '{missing[0]}' {purpose}{nearest(missing[0], known)}", file=file)
    return InputError(f"no columns {quoted(missing, known)} {purpose}; allowed: {', '.join(known)}", file=file)
