"""The rim under the bead: a fixed temperature, or a lumped body with a heat capacity."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

from tyrefem.boundaries import CAL, FILM, Law
from tyrefem.cards import FilmCoefficient, Temperature
from tyrefem.cards.plausible import CONTACT_FILM, CONTACT_RESISTANCE, SPECIFIC_HEAT, WHEEL_CONDUCTANCE, WHEEL_MASS
from tyrefem.plugins import Range, Trial, trial
from tyrefem.quantity import Unit


class RimLaw(Law):
    """Film between bead and flange, in series with a contact resistance: 1/h = 1/h_f + R_c.

    The report takes h_f = 0.5 cal/(cm2 s K) = 20920 W/m2/K and neglects the contact resistance as unknown.
    """

    side: ClassVar[str] = "rim"
    film: Annotated[FilmCoefficient, CONTACT_FILM] = 0.5 * CAL
    contact_resistance: Annotated[float, Unit("m**2*K/W", ge=0), CONTACT_RESISTANCE] = 0.0
    #: Rim temperature (initial, for a lumped rim) in phases whose `rim_temperature` is not given; by default `initial`.
    temperature: Temperature | None = None

    @property
    def total_film(self) -> float:
        """The film with the contact resistance in series, W/m2/K."""
        return 1 / (1 / self.film + self.contact_resistance) if self.film > 0 else 0.0

    def trials(self) -> Iterator[Trial]:
        """The film in series."""
        yield trial("total_film", lambda: self.total_film, FILM)


class FixedRim(RimLaw):
    """A rim of constant (or driven) temperature, as in the report."""

    law: Literal["fixed"]


class LumpedRim(RimLaw):
    """A rim of one temperature: C dT/dt = heat from the beads - UA (T - ambient) + heat from the contained air.

    ``mass`` and ``cooling`` are of the whole wheel. The report's aluminium: 962 J/kg/K.
    """

    law: Literal["lumped"]
    mass: Annotated[float, Unit("kg", gt=0), WHEEL_MASS]
    specific_heat: Annotated[float, Unit("J/kg/K", gt=0), SPECIFIC_HEAT] = 0.23 * 4184.0
    #: Conductance to the ambient.
    cooling: Annotated[float, Unit("W/K", ge=0), WHEEL_CONDUCTANCE]
    #: Conductance to the contained air through the rim's well.
    air: Annotated[float, Unit("W/K", ge=0), WHEEL_CONDUCTANCE] = 0.0

    @property
    def heat_capacity(self) -> float:
        """J/K of the whole wheel."""
        return self.mass * self.specific_heat

    def trials(self) -> Iterator[Trial]:
        """The film, and the heat capacity."""
        yield from super().trials()
        yield trial("heat_capacity", lambda: self.heat_capacity, Range("J/K", 1e-9))
