"""A property of a card: its source, and its table over temperature or frequency."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.cards import Card, Text
from tyrefem.errors import InputError, InputWarning
from tyrefem.plausible import Plausible
from tyrefem.quantity import Unit

Array = NDArray[np.float64]


class Sourced(Card):
    """A property: every one names its source; a guess says ``estimate: ...``."""

    source: Text
    #: Relative standard deviation of the number, where the source or an estimate gives one.
    relative_sd: Annotated[float, Unit("1", ge=0, lt=1)] | None = None

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """Fields that ``relative_sd`` speaks of: those of one group have one factor, every group its own."""
        return ("value",), ("table",)


@dataclass(frozen=True)
class PropertyTable:
    """A property tabulated over temperature: linear between rows, constant beyond the ends.

    >>> k = PropertyTable((20.0, 100.0), (0.20, 0.24))
    >>> float(k(60.0)), float(k(500.0))
    (0.22, 0.24)
    """

    temperatures: tuple[float, ...]
    values: tuple[float, ...]

    def __call__(self, temperature: Array | float) -> Array:
        return np.asarray(np.interp(temperature, self.temperatures, self.values))

    def unlikely(self, likely: Plausible) -> tuple[InputWarning, ...]:
        """The first row whose value is unlikely."""
        rows = (likely.warning(value, f"table.{number}") for number, value in enumerate(self.values))
        return tuple(filter(None, rows))[:1]


#: What the first column of a table holds, by its unit.
FIRST = {"degC": "temperatures", "Hz": "frequencies"}


def columns(rows: list[list[Any]], units: tuple[str, ...]) -> list[tuple[float, ...]]:
    """Columns of a table of quantities whose first column, temperature (degC) or frequency (Hz), must rise."""
    if len(rows) < 2:
        raise InputError("needs at least two rows", field="table")
    parsed = []
    for number, row in enumerate(rows):
        if not isinstance(row, list | tuple) or len(row) != len(units):
            message = f"row must have {len(units)} entries in {', '.join(units)}"
            raise InputError(message, field=f"table.{number}")
        try:
            pairs = zip(row, units, strict=True)
            parsed.append([Unit(unit, gt=None if unit == "degC" else 0)(cell) for cell, unit in pairs])
        except InputError as error:
            raise error.within(field=f"table.{number}") from None
    found = list(zip(*parsed, strict=True))
    if any(later <= earlier for earlier, later in zip(found[0], found[0][1:], strict=False)):
        raise InputError(f"{FIRST[units[0]]} must rise from row to row, without duplicates", field="table")
    return found
