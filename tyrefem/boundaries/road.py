"""The road under the tread, averaged over the revolution."""

from __future__ import annotations

import functools
from abc import abstractmethod
from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

from tyrefem.boundaries import CAL, FILM, SPEEDS, Contact, Law
from tyrefem.boundaries.road_film import effusivity, half_space_film, triangular_film
from tyrefem.cards import FilmCoefficient, Temperature
from tyrefem.cards.plausible import CONDUCTIVITY, CONTACT_FILM, ROAD_CONDUCTIVITY, SOLID_CAPACITY
from tyrefem.plugins import Trial, trial
from tyrefem.quantity import Unit


class RoadLaw(Law):
    """Film between tread and road during contact.

    On a cross-section the road acts for the share f = L / (2 pi r_r) of the revolution: f H_c to the road temperature
    and (1 - f) h_air to the ambient (Cattani et al. 2023; Clark & Dodge 1980, appendix I). At standstill no point of
    the tread represents the whole ring, and no heat goes to the road.
    """

    side: ClassVar[str] = "road"
    #: Road temperature in phases whose `road_temperature` is not given; by default the ambient.
    temperature: Temperature | None = None
    #: Fraction of the revolution on the road, in place of the footprint's.
    fraction: Annotated[float, Unit("1", ge=0, le=1)] | None = None

    @abstractmethod
    def film(self, contact: Contact) -> float:
        """H_c during contact, W/m2/K."""

    def trials(self) -> Iterator[Trial]:
        """The film of a usual footprint at rest and at speeds, and of a tyre without contact."""
        for speed, length in [*((speed, 0.15) for speed in SPEEDS), (10.0, 0.0)]:
            contact = Contact(speed, length, 0.25, 2e6)
            words = f"film(contact of {length:g} m at {speed:g} m/s)"
            yield trial(words, functools.partial(self.film, contact), FILM)


class ConstantRoadFilm(RoadLaw):
    """One film at every speed: the report's 0.25 cal/(cm2 s K) = 10460 W/m2/K."""

    law: Literal["constant"]
    coefficient: Annotated[FilmCoefficient, CONTACT_FILM] = 0.25 * CAL

    def film(self, contact: Contact) -> float:
        """H_c during contact, W/m2/K."""
        return self.coefficient


class OfTread(RoadLaw):
    """A film computed from the tread's lambda and C: by default those of the tread card at 25 degC."""

    conductivity: Annotated[float, Unit("W/m/K", gt=0), CONDUCTIVITY] | None = None
    heat_capacity: Annotated[float, Unit("J/m**3/K", gt=0), SOLID_CAPACITY] | None = None

    def _tread(self, contact: Contact) -> tuple[float, float]:
        return self.conductivity or contact.conductivity, self.heat_capacity or contact.heat_capacity


class Cattani(OfTread):
    """H_c = sqrt(lambda C v / L): mean over the contact of a triangular profile (Cattani et al. 2023, eq 12)."""

    law: Literal["cattani"]

    def film(self, contact: Contact) -> float:
        """H_c during contact, W/m2/K."""
        if contact.footprint_length <= 0:
            return 0.0
        return triangular_film(contact.speed, contact.footprint_length, *self._tread(contact))


class HalfSpace(OfTread):
    """Two half-spaces suddenly in contact, H_c = (2/sqrt(pi)) sqrt(lambda C v / L) b_road / (b_road + b_tyre).

    The defaults are estimates for dense asphalt: handbooks give 0.8 to 2 W/m/K and 1.8e6 to 2.4e6 J/m3/K, and for dry
    concrete nearly the same (1.7 W/m/K, 2.1e6 J/m3/K). A wet, cracked or porous road differs: give its values.
    """

    law: Literal["half-space"]
    road_conductivity: Annotated[float, Unit("W/m/K", gt=0), ROAD_CONDUCTIVITY] = 1.5
    road_heat_capacity: Annotated[float, Unit("J/m**3/K", gt=0), SOLID_CAPACITY] = 2.0e6

    def film(self, contact: Contact) -> float:
        """H_c during contact, W/m2/K."""
        if contact.footprint_length <= 0:
            return 0.0
        road = effusivity(self.road_conductivity, self.road_heat_capacity)
        return half_space_film(contact.speed, contact.footprint_length, *self._tread(contact), road)
