"""Short descriptions of large objects, and pickles without cached values."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

#: Largest number of lines of a `repr`, and of characters of a line.
LINES, WIDTH = 20, 110
#: Number of names or values of a list in a description.
SHOWN = 6
_INDENT = "  "


def counted(number: int, noun: str) -> str:
    """A number of things in words.

    >>> counted(1, "run"), counted(1200, "reading")
    ('1 run', '1,200 readings')
    """
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


class Brief:
    """A class whose `repr` has at most 20 lines; a subclass gives its main facts in `_facts`.

    >>> from dataclasses import dataclass
    >>> import numpy as np
    >>> @dataclass
    ... class Readings(Brief):
    ...     sensor: str
    ...     values: object
    >>> Readings("crown", np.linspace(25.0, 60.0, 1000))
    Readings
      sensor  crown
      values  array (1000,), 25 to 60
    """

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        # A dataclass would add a `repr` with all numbers of all arrays.
        if "__repr__" not in cls.__dict__:
            cls.__repr__ = Brief.__repr__  # type: ignore[method-assign]

    def _title(self) -> str:
        """Text after the name of the class, mostly the object's name."""
        name = getattr(self, "name", "")
        return name if isinstance(name, str) else ""

    def _facts(self) -> Mapping[str, Any]:
        """Heading -> text or value; values are shortened by `short`."""
        if not is_dataclass(self):
            return {}
        return {field.name: getattr(self, field.name) for field in fields(self) if field.repr and field.name != "name"}

    def __repr__(self) -> str:
        return lines(heading_of(self), self._facts())


def heading_of(thing: Brief) -> str:
    """Class and name: ``Study nasa-22x5.5-8pr``."""
    return f"{type(thing).__name__} {thing._title()}".rstrip()


def lines(heading: str, facts: Mapping[str, Any]) -> str:
    """A heading, and a line for each fact."""
    shown = list(facts.items())
    if len(shown) > LINES - 1:
        shown = [*shown[: LINES - 2], ("...", f"and {len(shown) - LINES + 2} more")]
    width = max((len(name) for name, _ in shown), default=0)
    rows = [f"{_INDENT}{name:{width}}  {value if isinstance(value, str) else short(value)}" for name, value in shown]
    return "\n".join(cut(row) for row in [heading, *rows])


def cut(text: str, width: int = WIDTH) -> str:
    """One line of at most ``width`` characters."""
    line = " ".join(text.splitlines()) if "\n" in text else text
    return line if len(line) <= width else f"{line[: width - 3]}..."


def short(value: Any) -> str:
    """A value in a few words, for values of any type.

    >>> import numpy as np
    >>> short(0.123456789), short(np.zeros((3, 2))), short({"tread": 1, "bead": 2}), short(list(range(50)))
    ('0.123457', 'array (3, 2), 0 to 0', 'tread, bead', '50: 0, 1, 2, 3, 4, 5, ...')
    """
    if isinstance(value, Brief):
        return _in_line(value)
    if isinstance(value, bool) or value is None:
        return str(value)
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, str | int | Path):
        return cut(str(value), 80)
    if isinstance(value, Mapping):
        return listed(value)
    if hasattr(value, "columns") and hasattr(value, "index"):
        return f"table of {len(value)} rows: {listed(value.columns)}"
    if hasattr(value, "shape") and hasattr(value, "dtype"):
        return _array(value)
    if isinstance(value, Sequence | frozenset | set):
        return listed(value)
    return cut(repr(value).splitlines()[0], 80)


def _in_line(thing: Brief) -> str:
    """The object's name, or its first facts if it has no name."""
    heading = heading_of(thing)
    if thing._title():
        return cut(heading, 80)
    facts = (f"{name} {value if isinstance(value, str) else short(value)}" for name, value in thing._facts().items())
    return cut(", ".join(itertools.islice(facts, SHOWN)) or heading, 80)


def listed(names: Iterable[Any]) -> str:
    """The first few entries of a list, and the number of entries if there are more."""
    every = list(names)
    words = ", ".join(short(entry) for entry in every[:SHOWN])
    if len(every) <= SHOWN:
        return words or "none"
    return f"{len(every)}: {words}, ..."


def _array(array: Any) -> str:
    if array.dtype.kind not in "fiu" or not array.size:
        return f"array {array.shape}"
    low, high = float(array.min()), float(array.max())
    return f"array {array.shape}, {low:.6g} to {high:.6g}"


class PickledFields:
    """A dataclass that is pickled with its fields only, without cached values."""

    def __getstate__(self) -> dict[str, Any]:
        return {field.name: self.__dict__[field.name] for field in fields(self)}  # type: ignore[arg-type]
