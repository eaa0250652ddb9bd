"""How a modulus falls as a material warms."""

from __future__ import annotations

import functools
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from tyrefem.cards import Temperature
from tyrefem.errors import InputError
from tyrefem.property_table import PropertyTable, Sourced, columns
from tyrefem.quantity import Unit

Array = NDArray[np.float64]
#: Range in which an exponential law is used, degC; held beyond.
_COLDEST, _HOTTEST = -50.0, 250.0


class Softening(Sourced):
    """Modulus at a temperature over the modulus that the card gives.

    ``exponential``: m = exp(-rate (T - at)), so that the card's modulus is that at the temperature ``at``;
    ``table``: rows ``[T, m]``, linear between them and constant beyond.

    Raises
    ------
    InputError : a law without its numbers, a table whose temperatures do not rise.

    >>> law = Softening.check({"rate": "0.004 1/delta_degC", "source": "estimate: example"})
    >>> law(25.0), round(law(75.0), 4)
    (1.0, 0.8187)
    """

    law: Literal["exponential", "table"] = "exponential"
    rate: Annotated[float, Unit("1/delta_degC", ge=-0.05, le=0.1)] | None = None
    at: Temperature = 25.0
    table: list[list[Any]] | None = None

    @model_validator(mode="after")
    def _complete(self) -> Softening:
        if self.law == "table":
            if self.table is None:
                raise InputError("the law 'table' needs 'table'")
            _ = self._tabulated
        elif self.rate is None:
            raise InputError("the law 'exponential' needs 'rate', e.g. '0.004 1/delta_degC'")
        return self

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """The rate: a table is relative, and has no one number."""
        return (("rate",),)

    @functools.cached_property
    def _tabulated(self) -> PropertyTable:
        return PropertyTable(*columns(self.table or [], ("degC", "1")))

    def __call__(self, temperature: float) -> float:
        """m at a temperature, degC."""
        if self.law == "table":
            return float(self._tabulated(temperature))
        bounded = min(max(temperature, _COLDEST), _HOTTEST)
        return float(np.exp(-(self.rate or 0.0) * (bounded - self.at)))
