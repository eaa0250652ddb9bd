"""``[loss_tangent.frequency]`` of a material card: tan delta over frequency, by power law, table or Prony series."""

from __future__ import annotations

import functools
from typing import Annotated, Any, Literal

from pydantic import Field, WithJsonSchema, model_validator

from tyrefem.cards import Card, Temperature, Text
from tyrefem.cards.plausible import LOSS_TANGENT
from tyrefem.errors import InputError, InputWarning
from tyrefem.materials.loss_tangent import FrequencyTable, Loss, OfTemperature, PowerLaw, Prony, Relative, Shift
from tyrefem.materials.properties import columns
from tyrefem.quantity import Unit
from tyrefem.quantity.pattern import row_schema

Frequency = Annotated[float, Unit("Hz", gt=0, le=1e12)]
#: Largest tan delta accepted.
LARGEST = 10.0


class ShiftCard(Card):
    """Williams, Landel and Ferry: log10 a_T = -c1 (T - reference) / (c2 + T - reference)."""

    c1: Annotated[float, Unit("1", gt=0, le=100)]
    c2: Annotated[float, Unit("delta_degC", gt=0, le=1000)]
    reference: Temperature

    def law(self) -> Shift:
        """a_T of temperatures in degC."""
        return Shift(self.c1, self.c2, self.reference)


class OfFrequency(Card):
    """Common part of all laws: the ``reference`` frequency, for which the card's temperature law is valid; a source."""

    reference: Frequency = 10.0
    source: Text

    def master_curve(self) -> Loss | None:
        """tan delta without the card's temperature law; None for a law that only scales it."""
        return None

    def scaled_by(self, law: Any) -> Loss:
        """tan delta = law(T) m(f, T) / m(reference, T)."""
        master = self.master_curve()
        assert master is not None
        return Relative(law, master, self.reference)


class Power(OfFrequency):
    """m = (f / reference)^exponent."""

    law: Literal["power"]
    exponent: Annotated[float, Unit("1", ge=-0.9, le=1)]

    def scaled_by(self, law: Any) -> Loss:
        """tan delta = law(T) (f / reference)^exponent."""
        return PowerLaw(law, self.exponent, self.reference)


class LossFrequencyTable(OfFrequency):
    """m tabulated: rows ``[f, tan delta]``, linear in log f and constant beyond; ``shift`` multiplies f by a_T."""

    law: Literal["table"]
    table: Annotated[list[list[Any]], WithJsonSchema(row_schema("Hz", "1"))]
    shift: ShiftCard | None = None

    @model_validator(mode="after")
    def _rising(self) -> LossFrequencyTable:
        _ = self._tabulated
        return self

    def warnings(self) -> tuple[InputWarning, ...]:
        """The first unlikely tan delta of the table."""
        rows = (LOSS_TANGENT.warning(value, f"table.{number}") for number, value in enumerate(self._tabulated.values))
        return super().warnings() + tuple(filter(None, rows))[:1]

    @functools.cached_property
    def _tabulated(self) -> FrequencyTable:
        frequencies, values = columns(self.table, ("Hz", "1"), LARGEST)
        return FrequencyTable(frequencies, values, self.shift.law() if self.shift else None)

    def master_curve(self) -> Loss:
        """The table."""
        return self._tabulated


class PronySeries(OfFrequency):
    """A generalised Maxwell solid: ``equilibrium`` modulus and rows ``[modulus, relaxation time]``."""

    law: Literal["prony"]
    equilibrium: Annotated[float, Unit("Pa", gt=0)]
    series: Annotated[list[list[Any]], WithJsonSchema(row_schema("Pa", "s", least=1))] = Field(min_length=1)
    shift: ShiftCard | None = None

    @model_validator(mode="after")
    def _pairs(self) -> PronySeries:
        _ = self._prony
        return self

    @functools.cached_property
    def _prony(self) -> Prony:
        pairs = []
        for number, row in enumerate(self.series):
            if not isinstance(row, list | tuple) or len(row) != 2:
                raise InputError("row must be [modulus, time], e.g. ['0.4 MPa', '1 ms']", field=f"series.{number}")
            try:
                pairs.append((Unit("Pa", gt=0)(row[0]), Unit("s", gt=0)(row[1])))
            except InputError as error:
                raise error.within(field=f"series.{number}") from None
        moduli, times = zip(*pairs, strict=True)
        return Prony(self.equilibrium, moduli, times, self.shift.law() if self.shift else None)

    def master_curve(self) -> Loss:
        """The series."""
        return self._prony


LossFrequency = Annotated[Power | LossFrequencyTable | PronySeries, Field(discriminator="law")]


def loss_over_frequency(law: Any, frequency: OfFrequency | None, *, master: bool) -> Loss:
    """tan delta(f, T) of a card with the temperature law ``law``; ``master``: the frequency law replaces it."""
    if frequency is None:
        return OfTemperature(law)
    master_curve = frequency.master_curve() if master else None
    return frequency.scaled_by(law) if master_curve is None else master_curve
