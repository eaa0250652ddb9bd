"""Properties of a card: source, tables over temperature or frequency, and softening.

Softening is the decrease of a modulus with temperature.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import WithJsonSchema, model_validator

from tyrefem.cards import Card, Temperature, Text
from tyrefem.cards.plausible import SOFTENED, Plausible
from tyrefem.errors import InputError, InputWarning
from tyrefem.quantity import Unit
from tyrefem.quantity.pattern import row_schema

Array = NDArray[np.float64]


class Sourced(Card):
    """A property with its source; the source of a guess is ``estimate: ...``."""

    source: Text
    #: Relative standard deviation of the number, from the source or an estimate.
    relative_sd: Annotated[float, Unit("1", ge=0, lt=1)] | None = None

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """Groups of fields to which ``relative_sd`` applies: one factor per group."""
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


#: Quantity in the first column of a table, by its unit.
FIRST = {"degC": "temperatures", "Hz": "frequencies"}


#: Highest temperature of a table, degC, as of every temperature of a card.
_HIGHEST = 2000.0


def columns(rows: list[list[Any]], units: tuple[str, ...], most: float | None = None) -> list[tuple[float, ...]]:
    """Columns of a table of quantities; the first, temperature (degC) or frequency (Hz), must increase.

    ``most``: largest value beside it.
    """
    if len(rows) < 2:
        raise InputError("needs at least two rows", field="table")
    parsed = []
    for number, row in enumerate(rows):
        if not isinstance(row, list | tuple) or len(row) != len(units):
            message = f"row must have {len(units)} entries in {', '.join(units)}"
            raise InputError(message, field=f"table.{number}")
        try:
            pairs = zip(row, units, strict=True)
            first, *others = pairs
            parsed.append([_first(*first), *(Unit(unit, gt=0, le=most)(cell) for cell, unit in others)])
        except InputError as error:
            raise error.within(field=f"table.{number}") from None
    parsed_columns = list(zip(*parsed, strict=True))
    if any(later <= earlier for earlier, later in zip(parsed_columns[0], parsed_columns[0][1:], strict=False)):
        raise InputError(f"{FIRST[units[0]]} must rise from row to row, without duplicates", field="table")
    return parsed_columns


def _first(cell: Any, unit: str) -> float:
    return Unit(unit, le=_HIGHEST)(cell) if unit == "degC" else Unit(unit, gt=0)(cell)


#: Temperature range of an exponential law, degC; constant beyond.
_COLDEST, _HOTTEST = -50.0, 250.0


class Softening(Sourced):
    """Modulus at a temperature over the modulus of the card.

    ``exponential``: m = exp(-rate (T - at)), so ``at`` is the temperature of the card's modulus;
    ``table``: rows ``[T, m]``, linear between them and constant beyond.

    Raises
    ------
    InputError : a law without its numbers, a table whose temperatures do not increase.

    >>> law = Softening.check({"rate": "0.004 1/delta_degC", "source": "estimate: example"})
    >>> law(25.0), round(law(75.0), 4)
    (1.0, 0.8187)
    """

    law: Literal["exponential", "table"] = "exponential"
    rate: Annotated[float, Unit("1/delta_degC", ge=-0.05, le=0.1)] | None = None
    at: Temperature = 25.0
    table: Annotated[list[list[Any]] | None, WithJsonSchema(row_schema("degC", "1"))] = None

    @model_validator(mode="after")
    def _complete(self) -> Softening:
        if self.law == "table":
            if self.table is None:
                raise InputError("the law 'table' needs 'table'")
            _ = self._tabulated
        elif self.rate is None:
            raise InputError("the law 'exponential' needs 'rate', e.g. '0.004 1/delta_degC'")
        elif self.table is not None:
            raise InputError("is only for the law 'table', not 'exponential'", field="table")
        return self

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """The rate; a table is relative and has no single number."""
        return (("rate",),)

    def warnings(self) -> tuple[InputWarning, ...]:
        """An unlikely factor: the first row of a table, or that of an exponential law at 25 or 100 degC."""
        if self.law == "table":
            return super().warnings() + self._tabulated.unlikely(SOFTENED)
        for temperature in (25.0, 100.0):
            unlikely = SOFTENED.warning(self(temperature), "rate")
            if unlikely is not None:
                words = f"at {temperature:g} degC the factor {unlikely.message}"
                return (*super().warnings(), InputWarning(words, field="rate"))
        return super().warnings()

    @functools.cached_property
    def _tabulated(self) -> PropertyTable:
        return PropertyTable(*columns(self.table or [], ("degC", "1")))

    def __call__(self, temperature: float) -> float:
        """m at a temperature, degC."""
        if self.law == "table":
            return float(self._tabulated(temperature))
        bounded = min(max(temperature, _COLDEST), _HOTTEST)
        return float(np.exp(-(self.rate or 0.0) * (bounded - self.at)))
