"""Material cards: conductivity, heat capacity, stiffness and loss tangent, each with unit and source."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from tyrefem.cards import Card, Temperature, Text
from tyrefem.errors import InputError
from tyrefem.material_elasticity import Cords, Elasticity
from tyrefem.quantity import Unit

Array = NDArray[np.float64]
#: From absolute zero to the highest temperature that a card may name, degC.
_RUBBER = (-273.15, 2000.0)


class Sourced(Card):
    """A property: every one names its source; a guess says ``estimate: ...``."""

    source: Text
    #: Relative standard deviation of the number, where the source or an estimate gives one.
    relative_sd: Annotated[float, Unit("1", ge=0, lt=1)] | None = None


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


def _columns(rows: list[list[Any]], units: tuple[str, ...]) -> list[tuple[float, ...]]:
    """Columns of a table of quantities whose first column, the temperature, must rise."""
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
    columns = list(zip(*parsed, strict=True))
    if any(later <= earlier for earlier, later in zip(columns[0], columns[0][1:], strict=False)):
        raise InputError("temperatures must rise from row to row, without duplicates", field="table")
    return columns


class Conductivity(Sourced):
    """Isotropic ``value``, or ``along`` and ``across`` the plies, or a ``table`` in temperature.

    A table's rows are ``[T, k]`` or ``[T, k_along, k_across]``.
    """

    UNIT: ClassVar[str] = "W/m/K"
    value: Annotated[float, Unit("W/m/K", gt=0)] | None = None
    along: Annotated[float, Unit("W/m/K", gt=0)] | None = None
    across: Annotated[float, Unit("W/m/K", gt=0)] | None = None
    table: list[list[Any]] | None = None

    @model_validator(mode="after")
    def _one_form(self) -> Conductivity:
        pair = self.along is not None or self.across is not None
        if (self.value is not None) + pair + (self.table is not None) != 1:
            raise InputError("give exactly one of 'value', 'along' and 'across', or 'table'")
        if pair and (self.along is None or self.across is None):
            raise InputError("'along' and 'across' belong together")
        if self.table is not None:
            self._tables()
        return self

    def _tables(self) -> list[PropertyTable]:
        rows = self.table or []
        width = len(rows[0]) if rows and isinstance(rows[0], list) else 2
        columns = _columns(rows, ("degC", *[self.UNIT] * (2 if width == 3 else 1)))
        return [PropertyTable(columns[0], values) for values in columns[1:]]

    @property
    def orthotropic(self) -> bool:
        """Does it differ along and across the plies?"""
        return self.along is not None or (self.table is not None and len(self._tables()) == 2)

    def law(self) -> Any:
        """What the conduction solver takes: a number, a pair, or a function of temperature, W/m/K."""
        if self.value is not None:
            return self.value
        if self.along is not None:
            return (self.along, self.across)
        tables = self._tables()
        if len(tables) == 1:
            return tables[0]
        along, across = tables
        return lambda temperature: (along(temperature), across(temperature))


class Scalar(Sourced):
    """A positive number, or a table of rows ``[T, value]``; subclasses name the unit."""

    UNIT: ClassVar[str] = "1"
    value: Any = None
    table: list[list[Any]] | None = None

    @model_validator(mode="after")
    def _one_form(self) -> Scalar:
        if (self.value is None) == (self.table is None):
            raise InputError("give exactly one of 'value' and 'table'")
        if self.table is not None:
            _columns(self.table, ("degC", self.UNIT))
        else:
            self._at("value", self.value)
        return self

    def _at(self, field: str, value: Any) -> float:
        try:
            return Unit(self.UNIT, gt=0)(value)
        except InputError as error:
            raise error.within(field=field) from None

    def law(self) -> float | PropertyTable:
        """A number, or a function of temperature (degC)."""
        if self.table is None:
            return self._at("value", self.value)
        temperatures, values = _columns(self.table, ("degC", self.UNIT))
        return PropertyTable(temperatures, values)

    def at(self, temperature: float) -> float:
        """The value at one temperature, degC."""
        law = self.law()
        return float(law(temperature)) if callable(law) else law


class Density(Scalar):
    """kg/m3."""

    UNIT: ClassVar[str] = "kg/m**3"


class SpecificHeat(Scalar):
    """J/kg/K."""

    UNIT: ClassVar[str] = "J/kg/K"


class Modulus(Sourced):
    """A stiffness, Pa."""

    value: Annotated[float, Unit("Pa", gt=0)]


class LossTangent(Sourced):
    """tan delta and its temperature law.

    ``exponential``: tan d = value exp(-rate (T - at))  (Clark & Dodge 1980, table 3, note 5, with
    rate = 0.0148 per kelvin); ``constant``; ``table``: rows ``[T, tan delta]``.
    """

    law: Literal["exponential", "constant", "table"] = "exponential"
    value: Annotated[float, Unit("1", ge=0, le=10)] | None = None
    at: Temperature = 25.0
    rate: Annotated[float, Unit("1/delta_degC", ge=-0.1, le=0.2)] | None = None
    table: list[list[Any]] | None = None

    @model_validator(mode="after")
    def _complete(self) -> LossTangent:
        if self.law == "table":
            if self.table is None:
                raise InputError("the law 'table' needs 'table'")
            _ = self._tabulated
        elif self.value is None:
            raise InputError(f"the law '{self.law}' needs 'value'")
        elif self.law == "exponential" and self.rate is None:
            raise InputError("the law 'exponential' needs 'rate', e.g. '0.0148 1/delta_degC'")
        return self

    @functools.cached_property
    def _tabulated(self) -> PropertyTable:
        return PropertyTable(*_columns(self.table or [], ("degC", "1")))

    def __call__(self, temperature: Array | float) -> Array:
        """tan delta at temperatures in degC, same shape."""
        if self.law == "table":
            return self._tabulated(temperature)
        value = self.value or 0.0
        if self.law == "constant":
            return np.full_like(np.asarray(temperature, dtype=float), value)
        # A rejected trial step may stray far: outside these bounds no rubber has a tan delta to speak of.
        bounded = np.minimum(np.maximum(temperature, _RUBBER[0]), _RUBBER[1])
        return np.asarray(value * np.exp(-(self.rate or 0.0) * (bounded - self.at)))


class Cord(Sourced):
    """Bias plies: crown angle to the circumference, and the in-plane shear modulus of the ply pair."""

    crown_angle: Annotated[float, Unit("rad", gt=0)] | None = None
    ply_shear_modulus: Annotated[float, Unit("Pa", gt=0)] | None = None


class MaterialCard(Card):
    """One compound or composite. Read with `material`."""

    kind: ClassVar[str] = "material"
    title: Text
    notes: str = ""
    conductivity: Conductivity
    density: Density
    specific_heat: SpecificHeat
    loss_tangent: LossTangent
    shear_modulus: Modulus | None = None
    youngs_modulus: Modulus | None = None
    cord: Cord | None = None
    elasticity: Elasticity | None = None
    cords: Cords | None = None

    def heat_capacity(self) -> Any:
        """Volumetric heat capacity rho c, J/m3/K: a number or a function of temperature."""
        density, specific = self.density.law(), self.specific_heat.law()
        if not callable(density) and not callable(specific):
            return density * specific
        return lambda temperature: (
            (density(temperature) if callable(density) else density)
            * (specific(temperature) if callable(specific) else specific)
        )


def material(reference: object, near: Path | None = None) -> MaterialCard:
    """The material card of a name, path or ``{base = NAME, ...}``.

    >>> float(material("nasa-tread").loss_tangent(25.0))
    0.2
    """
    from tyrefem import library

    data, path, _ = library.load("material", reference, near)
    return MaterialCard.check(data, path)
