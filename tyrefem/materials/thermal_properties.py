"""Conductivity and heat capacity of a material card: numbers, or tables over temperature."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import GetJsonSchemaHandler, WithJsonSchema, model_validator
from pydantic_core import CoreSchema

from tyrefem.cards.plausible import CONDUCTIVITY, DENSITY, SPECIFIC_HEAT, Plausible
from tyrefem.errors import InputError, InputWarning
from tyrefem.materials.properties import PropertyTable, Sourced, columns
from tyrefem.quantity import Unit
from tyrefem.quantity.pattern import quantity_schema, row_schema

#: Rows [T, k] or [T, along, across].
_CONDUCTIVITIES = {"anyOf": [row_schema("degC", "W/m/K"), row_schema("degC", "W/m/K", "W/m/K")]}


class Conductivity(Sourced):
    """Isotropic ``value``, or ``along`` and ``across`` the plies, or a ``table`` in temperature.

    A table's rows are ``[T, k]`` or ``[T, k_along, k_across]``.
    """

    UNIT: ClassVar[str] = "W/m/K"
    value: Annotated[float, Unit("W/m/K", gt=0), CONDUCTIVITY] | None = None
    along: Annotated[float, Unit("W/m/K", gt=0), CONDUCTIVITY] | None = None
    across: Annotated[float, Unit("W/m/K", gt=0), CONDUCTIVITY] | None = None
    table: Annotated[list[list[Any]] | None, WithJsonSchema(_CONDUCTIVITIES)] = None

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
        listed = columns(rows, ("degC", *[self.UNIT] * (2 if width == 3 else 1)))
        return [PropertyTable(listed[0], values) for values in listed[1:]]

    def warnings(self) -> tuple[InputWarning, ...]:
        """Unlikely numbers, including those of the table."""
        tables = self._tables() if self.table is not None else []
        return super().warnings() + tuple(warning for table in tables for warning in table.unlikely(CONDUCTIVITY))

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """The values along and across the plies are two independent numbers."""
        return ("value",), ("along",), ("across",), ("table",)

    @property
    def orthotropic(self) -> bool:
        """True if values along and across the plies differ."""
        return self.along is not None or (self.table is not None and len(self._tables()) == 2)

    def law(self) -> Any:
        """Conductivity for the conduction solver, W/m/K: a number, a pair, or a function of temperature."""
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
    LIKELY: ClassVar[Plausible]
    value: Any = None
    table: list[list[Any]] | None = None

    @model_validator(mode="after")
    def _one_form(self) -> Scalar:
        if (self.value is None) == (self.table is None):
            raise InputError("give exactly one of 'value' and 'table'")
        if self.table is not None:
            columns(self.table, ("degC", self.UNIT))
        else:
            self._at("value", self.value)
        return self

    @classmethod
    def __get_pydantic_json_schema__(cls, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        table = handler.resolve_ref_schema(handler(core))
        likely = {"low": cls.LIKELY.low, "high": cls.LIKELY.high, "source": cls.LIKELY.source}
        table["properties"]["value"] |= {**quantity_schema(cls.UNIT, {"gt": 0.0}), "x-likely": likely}
        table["properties"]["table"].pop("anyOf")
        table["properties"]["table"] |= row_schema("degC", cls.UNIT)
        return table

    def _at(self, field: str, value: Any) -> float:
        try:
            return Unit(self.UNIT, gt=0)(value)
        except InputError as error:
            raise error.within(field=field) from None

    def warnings(self) -> tuple[InputWarning, ...]:
        """The unlikely number, or unlikely numbers of the table."""
        law = self.law()
        if isinstance(law, PropertyTable):
            return super().warnings() + law.unlikely(self.LIKELY)
        return super().warnings() + tuple(filter(None, [self.LIKELY.warning(law, "value")]))

    def law(self) -> float | PropertyTable:
        """A number, or a function of temperature (degC)."""
        if self.table is None:
            return self._at("value", self.value)
        temperatures, values = columns(self.table, ("degC", self.UNIT))
        return PropertyTable(temperatures, values)

    def at(self, temperature: float) -> float:
        """The value at one temperature, degC."""
        law = self.law()
        return float(law(temperature)) if callable(law) else law


class Density(Scalar):
    """kg/m3."""

    UNIT: ClassVar[str] = "kg/m**3"
    LIKELY: ClassVar[Plausible] = DENSITY


class SpecificHeat(Scalar):
    """J/kg/K."""

    UNIT: ClassVar[str] = "J/kg/K"
    LIKELY: ClassVar[Plausible] = SPECIFIC_HEAT
