"""Load case of a tyre: deflection from load and pressure, footprint length, fraction of a revolution on the road.

Laws of ``[mechanics] footprint`` and ``[mechanics] load_law``, a class each.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, Protocol

from tyrefem.boundaries.road_film import hedekel_length
from tyrefem.cards import Card, Text
from tyrefem.cards.plausible import FOOTPRINT, STIFFNESS
from tyrefem.errors import InputError
from tyrefem.inputs.wheel_state import WheelState
from tyrefem.quantity import Unit


class TrR64Footprint(Card):
    """NASA TR R-64: 1.7 d sqrt(D/d - (D/d)^2), quoted from memory."""

    law: Literal["tr-r-64"] = "tr-r-64"
    #: True if a drum shortens the law's length.
    shorter_on_drum: ClassVar[bool] = True

    def on_flat_road(self, deflection: float, outer_radius: float) -> float:
        """Length, m, from metres."""
        d = 2 * outer_radius
        x = deflection / d
        return 1.7 * d * math.sqrt(max(x - x * x, 0.0))


class HedekelFootprint(Card):
    """Chord c 2 sqrt(D (2 r_0 - D)) (Cattani et al. 2023, eq 13); ``correction`` c is a measured factor."""

    law: Literal["hedekel"]
    correction: Annotated[float, Unit("1", gt=0, le=2)] = 1.0
    shorter_on_drum: ClassVar[bool] = True

    def on_flat_road(self, deflection: float, outer_radius: float) -> float:
        """Length, m, from metres."""
        return hedekel_length(deflection, outer_radius, self.correction)


class GivenFootprint(Card):
    """A measured length, at every load and on any drum; zero if the tyre does not touch the road."""

    law: Literal["given"]
    length: Annotated[float, Unit("m", gt=0, le=4), FOOTPRINT]
    shorter_on_drum: ClassVar[bool] = False

    def on_flat_road(self, deflection: float, outer_radius: float) -> float:
        """Length, m, from metres."""
        return self.length if deflection > 0 else 0.0


FootprintLaw = TrR64Footprint | HedekelFootprint | GivenFootprint
TR_R_64 = TrR64Footprint()


#: TR R-64, type VII tyres, static: C_z.
TYPE_VII = 0.02


class TrR64(Card):
    """Load-deflection law of NASA TR R-64 (Smiley & Horne 1958), quoted from memory.

    F / ((p + 0.08 p_rated) w sqrt(w d)) = 0.96 u + 0.216 u^2 / C_z    for u = D/w <= 10 C_z / 3,
                                         = 2.4 (u - C_z)               beyond.
    """

    law: Literal["tr-r-64"] = "tr-r-64"
    shape_factor: Annotated[float, Unit("1", gt=0, lt=0.2)] = TYPE_VII
    source: Text = "NASA TR R-64, static, type VII, C_z = 0.02 (quoted from memory)"

    def _scale(self, pressure: float, tyre: RatedTyre) -> float:
        return (pressure + 0.08 * tyre.pressure) * tyre.width * math.sqrt(tyre.width * tyre.diameter)

    def load(self, deflection: float, pressure: float, tyre: RatedTyre | None) -> float:
        """Vertical load, N."""
        tyre, c = _rated(tyre), self.shape_factor
        u = deflection / tyre.width
        shape = 0.96 * u + 0.216 * u * u / c if u <= 10 * c / 3 else 2.4 * (u - c)
        return shape * self._scale(pressure, tyre)

    def deflection(self, load: float, pressure: float, tyre: RatedTyre | None) -> float:
        """Deflection, m: the closed-form inverse of the two branches."""
        tyre, c = _rated(tyre), self.shape_factor
        f = load / self._scale(pressure, tyre)
        if f <= 2.4 * (10 * c / 3 - c):
            a = 0.216 / c
            return tyre.width * (-0.96 + math.sqrt(0.96**2 + 4 * a * f)) / (2 * a)
        return tyre.width * (f / 2.4 + c)


def _rated(tyre: RatedTyre | None) -> RatedTyre:
    if tyre is None:
        raise InputError("the load-deflection law 'tr-r-64' needs the section's [rating]", field="section.rating")
    return tyre


class VerticalStiffness(Card):
    """A measured vertical stiffness: D = F / k."""

    law: Literal["vertical-stiffness"]
    stiffness: Annotated[float, Unit("N/m", gt=0), STIFFNESS]
    source: Text

    def load(self, deflection: float, pressure: float, tyre: RatedTyre | None) -> float:
        """Vertical load, N."""
        return self.stiffness * deflection

    def deflection(self, load: float, pressure: float, tyre: RatedTyre | None) -> float:
        """Deflection, m."""
        return load / self.stiffness


class RatedTyre(Protocol):
    """Data of the tyre for a load-deflection law: nominal width and diameter, m, rated pressure, Pa."""

    @property
    def width(self) -> float:
        """w, m."""

    @property
    def diameter(self) -> float:
        """d, m."""

    @property
    def pressure(self) -> float:
        """p_rated, Pa."""


#: Smallest drum over the tyre's diameter: a smaller one is an obstacle, for which no contact law holds.
SMALLEST_DRUM = 0.1


def check_drum(drum_diameter: float, tyre_diameter: float) -> None:
    """Raise `InputError` for a drum, m, that is too small for a tyre of a diameter, m."""
    smallest = SMALLEST_DRUM * tyre_diameter
    if drum_diameter < smallest:
        raise InputError(
            f"a drum of {drum_diameter * 1e3:.4g} mm is too small: at least a tenth of the tyre, "
            f"{smallest * 1e3:.0f} mm",
            field="drum_diameter",
        )


@dataclass(frozen=True)
class PressedContact:
    """Contact of a tyre that a strain law presses on the road: lengths in m, area in m2."""

    length: float
    area: float
    rolling_radius: float


@dataclass(frozen=True)
class LoadCase:
    """One load on the tyre: all inputs of the strain cycle, in SI units.

    Parameters
    ----------
    drum_diameter : ``inf`` on a flat road.
    by_deflection : the drive gives the deflection, which determines the load; else the drive gives the load.
    contact : contact from a strain law that presses the tyre, with its load and deflection. None: the study's laws
        give load, deflection and contact.
    speed : of the tread through the footprint, m/s, where the strain cycle depends on it; else 0.
    wheel : slip or torque, slip angle and camber of a wheel that rolls with friction; None: without friction.
    """

    load: float
    deflection: float
    pressure: float
    outer_radius: float
    drum_diameter: float = math.inf
    footprint: FootprintLaw = TR_R_64
    by_deflection: bool = False
    contact: PressedContact | None = None
    speed: float = 0.0
    wheel: WheelState | None = None

    @property
    def rolling_radius(self) -> float:
        """Rolling radius of the contact, or r_r = r_0 - D/3 (Clark & Dodge 1980, eq 26), m."""
        return self.outer_radius - self.deflection / 3 if self.contact is None else self.contact.rolling_radius

    @property
    def footprint_area(self) -> float | None:
        """Area of rubber in contact, m2; None if no contact was solved."""
        return None if self.contact is None else self.contact.area

    @property
    def footprint_length(self) -> float:
        """Length of the contact, or of the footprint law times sqrt(1/(1 + d/d_drum)) on a drum unless measured, m.

        The drum's factor is the Hertz contact of two cylinders at equal deflection: an estimate.
        """
        if self.contact is not None:
            return self.contact.length
        length = self.footprint.on_flat_road(self.deflection, self.outer_radius)
        if not self.footprint.shorter_on_drum:
            return length
        return length / math.sqrt(1 + 2 * self.outer_radius / self.drum_diameter)

    @property
    def road_fraction(self) -> float:
        """Fraction of a revolution that a tread point spends on the road: L / (2 pi r_r)."""
        return self.footprint_length / (2 * math.pi * self.rolling_radius)

    def contact_time(self, speed: float) -> float:
        """Time of a tread point on the road, s, at a speed, m/s."""
        return self.footprint_length / speed if speed > 0 else math.inf


def load_case(
    law: TrR64 | VerticalStiffness | None,
    rating: RatedTyre | None,
    *,
    outer_radius: float,
    pressure: float,
    load: float | None = None,
    deflection: float | None = None,
    drum_diameter: float = math.inf,
    footprint: FootprintLaw = TR_R_64,
) -> LoadCase:
    """Make a load case from a load or a deflection; the law gives the other.

    Without a law the other is 0, and a strain law that presses the tyre computes it.

    Raises
    ------
    InputError : the law needs a rating; the deflection exceeds half the outer radius.
    """
    by_deflection = deflection is not None
    if deflection is None:
        load = load or 0.0
        deflection = law.deflection(load, pressure, rating) if law is not None and load > 0 else 0.0
    else:
        load = 0.0 if law is None else law.load(deflection, pressure, rating)
    if not 0 <= deflection < outer_radius / 2:
        raise InputError(
            f"{load:.4g} N at {pressure / 1e3:.4g} kPa deflects the tyre by {deflection * 1e3:.4g} mm; "
            f"allowed: 0 to {outer_radius * 500:.4g} mm (half its outer radius)",
            field="deflection" if by_deflection else "load",
        )
    return LoadCase(load, deflection, pressure, outer_radius, drum_diameter, footprint, by_deflection)
