"""The shipped laws of tan delta, as a material card states them."""

from __future__ import annotations

import functools
from typing import Annotated, Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray
from pydantic import WithJsonSchema, model_validator

from tyrefem.cards import Temperature
from tyrefem.cards.plausible import LOSS_TANGENT
from tyrefem.errors import InputError, InputWarning
from tyrefem.materials.law_of_card import law_name
from tyrefem.materials.loss_frequency import LARGEST, LossFrequency, loss_over_frequency
from tyrefem.materials.loss_tangent import Loss
from tyrefem.materials.properties import PropertyTable, columns
from tyrefem.materials.tan_delta_law import TanDeltaLaw
from tyrefem.plugins import Kind
from tyrefem.quantity import Unit
from tyrefem.quantity.pattern import row_schema

Array = NDArray[np.float64]
#: From absolute zero to the highest temperature allowed on a card, degC.
_RUBBER = (-273.15, 2000.0)
#: Temperatures of a warming tyre, degC, at which an exponential law is held against the likely range.
WARMING = (25.0, 100.0)


class LossTangent(TanDeltaLaw):
    """tan delta and its temperature law.

    ``exponential``: tan d = value exp(-rate (T - at))  (Clark & Dodge 1980, table 3, note 5, with
    rate = 0.0148 per kelvin); ``constant``; ``table``: rows ``[T, tan delta]``; ``frequency``: only the table or Prony
    series of ``frequency`` with its shift. With the other laws ``frequency`` converts tan delta from its reference
    frequency to others; without it tan delta is the same at all frequencies.
    """

    law: Literal["exponential", "constant", "table", "frequency"] = "exponential"
    value: Annotated[float, Unit("1", ge=0, le=LARGEST), LOSS_TANGENT] | None = None
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
        if self.law == "exponential" and self.value and not any(warning.field == "value" for warning in warnings):
            return warnings + self._unlikely_later()
        return warnings

    def _unlikely_later(self) -> tuple[InputWarning, ...]:
        """An unlikely tan delta of an exponential law at the first of `WARMING` with one: by its rate or ``at``."""
        for temperature in WARMING:
            unlikely = LOSS_TANGENT.warning(float(self(temperature)), "rate")
            if unlikely is not None:
                return (InputWarning(f"at {temperature:g} degC tan delta {unlikely.message}", field="rate"),)
        return ()

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """The factor of the law; none for a Prony series, in which moduli and times give tan delta."""
        fields = {"table": "table", "frequency": "frequency.table"}
        return ((fields.get(self.law, "value"),),)

    @functools.cached_property
    def _tabulated(self) -> PropertyTable:
        return PropertyTable(*columns(self.table or [], ("degC", "1"), LARGEST))

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
