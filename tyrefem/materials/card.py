"""Material cards: conductivity, heat capacity, stiffness and loss tangent, each with unit and source."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, get_args

import numpy as np
from numpy.typing import NDArray
from pydantic import GetJsonSchemaHandler, WithJsonSchema, model_validator
from pydantic_core import CoreSchema

from tyrefem.cards import Card, Temperature, Text
from tyrefem.cards.plausible import (
    CONDUCTIVITY,
    DENSITY,
    EXPANSION,
    LOSS_TANGENT,
    PLY_SHEAR_MODULUS,
    SHEAR_MODULUS,
    SPECIFIC_HEAT,
    YOUNGS_MODULUS,
    Plausible,
)
from tyrefem.errors import InputError, InputWarning
from tyrefem.materials.elasticity import Cords, Elasticity
from tyrefem.materials.fatigue import Fatigue
from tyrefem.materials.law_of_card import LawOfCard, law_name
from tyrefem.materials.loss_frequency import LossFrequency, loss_over_frequency
from tyrefem.materials.loss_tangent import Loss
from tyrefem.materials.properties import PropertyTable, Softening, Sourced, columns
from tyrefem.materials.road_friction import FRICTION, FrictionOnRoad, RoadFriction
from tyrefem.materials.strain_dependence import StrainDependence
from tyrefem.materials.tan_delta_law import TanDeltaLaw
from tyrefem.materials.wear import Wear
from tyrefem.plugins import Kind
from tyrefem.quantity import Unit
from tyrefem.quantity.pattern import quantity_schema, row_schema

Array = NDArray[np.float64]
#: From absolute zero to the highest temperature allowed on a card, degC.
_RUBBER = (-273.15, 2000.0)


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


class ShearModulus(Sourced):
    """G of a compound, Pa."""

    value: Annotated[float, Unit("Pa", gt=0), SHEAR_MODULUS]


class YoungsModulus(Sourced):
    """E of bead wires or of a compound, Pa."""

    value: Annotated[float, Unit("Pa", gt=0), YOUNGS_MODULUS]


class LossTangent(TanDeltaLaw):
    """tan delta and its temperature law.

    ``exponential``: tan d = value exp(-rate (T - at))  (Clark & Dodge 1980, table 3, note 5, with
    rate = 0.0148 per kelvin); ``constant``; ``table``: rows ``[T, tan delta]``; ``frequency``: only the table or Prony
    series of ``frequency`` with its shift. With the other laws ``frequency`` converts tan delta from its reference
    frequency to others; without it tan delta is the same at all frequencies.
    """

    law: Literal["exponential", "constant", "table", "frequency"] = "exponential"
    value: Annotated[float, Unit("1", ge=0, le=10), LOSS_TANGENT] | None = None
    at: Temperature = 25.0
    rate: Annotated[float, Unit("1/delta_degC", ge=-0.1, le=0.2)] | None = None
    table: Annotated[list[list[Any]] | None, WithJsonSchema(row_schema("degC", "1"))] = None
    frequency: LossFrequency | None = None

    @model_validator(mode="after")
    def _complete(self) -> LossTangent:
        if self.law == "frequency":
            if self.frequency is None or self.frequency.law == "power":
                raise InputError("the law 'frequency' needs the table 'frequency' with the law 'table' or 'prony'")
        elif self.law == "table":
            if self.table is None:
                raise InputError("the law 'table' needs 'table'")
            _ = self._tabulated
        elif self.value is None:
            raise InputError(f"the law '{self.law}' needs 'value'")
        elif self.law == "exponential" and self.rate is None:
            raise InputError("the law 'exponential' needs 'rate', e.g. '0.0148 1/delta_degC'")
        if self.table is not None and self.law != "table":
            raise InputError(f"is only for the law 'table', not '{self.law}'", field="table")
        return self

    def warnings(self) -> tuple[InputWarning, ...]:
        """Unlikely numbers, including those of the table or master curve."""
        warnings = super().warnings()
        if self.law == "table":
            return warnings + self._tabulated.unlikely(LOSS_TANGENT)
        if self.law == "frequency":
            at_reference = LOSS_TANGENT.warning(float(self(self.at)), "frequency")
            return warnings + tuple(filter(None, [at_reference]))
        return warnings

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """The factor of the law; none for a Prony series, in which moduli and times give tan delta."""
        fields = {"table": "table", "frequency": "frequency.table"}
        return ((fields.get(self.law, "value"),),)

    @functools.cached_property
    def _tabulated(self) -> PropertyTable:
        return PropertyTable(*columns(self.table or [], ("degC", "1")))

    @functools.cached_property
    def over_frequency(self) -> Loss:
        """tan delta(f, T), a function of frequency, Hz, and temperatures, degC."""
        return loss_over_frequency(self, self.frequency, master=self.law == "frequency")

    @property
    def depends_on_frequency(self) -> bool:
        """True if the card gives tan delta over frequency."""
        return self.frequency is not None

    def tan_delta(self, temperature: Array, frequency: float) -> Array:
        """tan delta at temperatures, degC, and a frequency, Hz."""
        return self.over_frequency(frequency, temperature)

    def __call__(self, temperature: Array | float) -> Array:
        """tan delta at temperatures in degC, same shape; at the reference frequency, if it depends on frequency."""
        if self.law == "frequency":
            assert self.frequency is not None
            return self.over_frequency(self.frequency.reference, np.asarray(temperature, dtype=float))
        if self.law == "table":
            return self._tabulated(temperature)
        value = self.value or 0.0
        if self.law == "constant":
            return np.full_like(np.asarray(temperature, dtype=float), value)
        # Rejected trial steps may have extreme temperatures: beyond these bounds the law is not meaningful.
        bounded = np.minimum(np.maximum(temperature, _RUBBER[0]), _RUBBER[1])
        return np.asarray(value * np.exp(-(self.rate or 0.0) * (bounded - self.at)))


TAN_DELTA = TanDeltaLaw.plugin_kind = Kind(
    "tan delta law",
    "tan delta laws",
    'law: Literal["..."]',
    law_name,
    lambda: dict.fromkeys(get_args(LossTangent.model_fields["law"].annotation), LossTangent),
)


class Cord(Sourced):
    """Bias plies: crown angle to the circumference, and the in-plane shear modulus of the ply pair."""

    crown_angle: Annotated[float, Unit("rad", gt=0, le=1.5708)] | None = None
    ply_shear_modulus: Annotated[float, Unit("Pa", gt=0), PLY_SHEAR_MODULUS] | None = None
    softening: Softening | None = None

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """The modulus; an angle has no relative standard deviation."""
        return (("ply_shear_modulus",),)


class ThermalExpansion(Sourced):
    """Linear expansion of the compound, and of its cords along themselves, from the stress-free temperature."""

    coefficient: Annotated[float, Unit("1/delta_degC", ge=0, le=1e-3), EXPANSION]
    cords: Annotated[float, Unit("1/delta_degC", ge=-1e-4, le=1e-3)] = 0.0
    stress_free: Temperature = 25.0

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """Compound and cords expand independently."""
        return ("coefficient",), ("cords",)


class MaterialCard(Card):
    """One compound or composite. Read with `material`.

    ``softening`` applies to all moduli of the compound; cords have a table of softening too, or do not soften.
    ``strain_dependence`` applies to the compound's shear modulus and loss; cords do not depend on strain.
    ``loss_tangent``: tan delta, by a shipped law or your own. ``friction``: of the tread on the road, likewise.
    """

    kind: ClassVar[str] = "material"
    title: Text
    notes: str = ""
    conductivity: Conductivity
    density: Density
    specific_heat: SpecificHeat
    loss_tangent: Annotated[TanDeltaLaw, LawOfCard(TAN_DELTA, TanDeltaLaw, LossTangent)]
    shear_modulus: ShearModulus | None = None
    youngs_modulus: YoungsModulus | None = None
    cord: Cord | None = None
    elasticity: Elasticity | None = None
    cords: Cords | None = None
    softening: Softening | None = None
    strain_dependence: StrainDependence | None = None
    expansion: ThermalExpansion | None = None
    fatigue: Fatigue | None = None
    wear: Wear | None = None
    friction: Annotated[FrictionOnRoad, LawOfCard(FRICTION, FrictionOnRoad, RoadFriction)] | None = None

    @property
    def softens(self) -> bool:
        """True if a modulus depends on temperature."""
        return any(part is not None and part.softening is not None for part in (self, self.cord, self.cords))

    def warmed(self, temperature: float) -> MaterialCard:
        """The card with its moduli at a temperature, degC."""
        changes: dict[str, Any] = {}
        if self.softening is not None:
            factor = self.softening(temperature)
            for name in ("shear_modulus", "youngs_modulus"):
                if (modulus := getattr(self, name)) is not None:
                    changes[name] = modulus.model_copy(update={"value": factor * modulus.value})
            if self.elasticity is not None:
                changes["elasticity"] = self.elasticity.times(factor)
        if self.cord is not None and self.cord.softening is not None and self.cord.ply_shear_modulus is not None:
            softened = self.cord.softening(temperature) * self.cord.ply_shear_modulus
            changes["cord"] = self.cord.model_copy(update={"ply_shear_modulus": softened})
        if self.cords is not None and self.cords.softening is not None:
            changes["cords"] = self.cords.times(self.cords.softening(temperature))
        return self.model_copy(update=changes) if changes else self

    def at_amplitude(self, amplitude: float) -> MaterialCard:
        """The same compound with its shear modulus at another shear strain amplitude.

        A card without ``strain_dependence`` is returned as it is. The loss modulus at every amplitude stays the same.
        """
        law = self.strain_dependence
        if law is None:
            return self
        factor = float(law.stiffening(amplitude))
        changes: dict[str, Any] = {"strain_dependence": law.at_modulus_amplitude(amplitude)}
        if self.shear_modulus is not None:
            value = factor * self.shear_modulus.value
            changes["shear_modulus"] = self.shear_modulus.model_copy(update={"value": value})
        if self.elasticity is not None:
            changes["elasticity"] = self.elasticity.times(factor)
        return self.model_copy(update=changes)

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


def strain_laws(cards: Mapping[str, MaterialCard]) -> dict[str, StrainDependence]:
    """Region -> moduli over strain, of the cards that have them."""
    return {region: card.strain_dependence for region, card in cards.items() if card.strain_dependence is not None}
