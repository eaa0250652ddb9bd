"""Friction of the tread on the road, and the temperature limit of rubber."""

from __future__ import annotations

import functools
from abc import abstractmethod
from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

from tyrefem.boundaries import Law
from tyrefem.boundaries.road import HalfSpace, RoadLaw
from tyrefem.boundaries.road_film import effusivity
from tyrefem.cards import Temperature
from tyrefem.cards.plausible import CONTACT_PRESSURE, DECOMPOSITION, ROAD_CONDUCTIVITY, SOLID_CAPACITY
from tyrefem.plugins import Range, Trial, trial
from tyrefem.quantity import Unit

Friction = Annotated[float, Unit("1", ge=0, le=5)]


class SlidingLaw(Law):
    """Friction heat of a contact, W/m2, in phases of the drive with slip.

    The road's values are given here, or those of the road law, or its defaults (`HalfSpace`). Friction decreases where
    it would heat the contact's exit edge above ``decomposition_temperature`` (Roberts, eq 13). 350 degC is an estimate,
    as are all defaults here.
    """

    side: ClassVar[str] = "sliding"
    #: True: steady rolling with friction gives the heat, ring by ring, in every phase that moves.
    rolls: ClassVar[bool] = False
    road_conductivity: Annotated[float, Unit("W/m/K", gt=0), ROAD_CONDUCTIVITY] | None = None
    road_heat_capacity: Annotated[float, Unit("J/m**3/K", gt=0), SOLID_CAPACITY] | None = None
    decomposition_temperature: Annotated[Temperature, DECOMPOSITION] = 350.0

    def road_effusivity(self, road: RoadLaw) -> float:
        """b of the road, J/m2/K/s^0.5: given here, or that of the road law, or its default."""
        named = road if isinstance(road, HalfSpace) else HalfSpace(law="half-space")
        return effusivity(
            self.road_conductivity or named.road_conductivity, self.road_heat_capacity or named.road_heat_capacity
        )

    def trials(self) -> Iterator[Trial]:
        """A law that does not roll has `UniformSliding.friction`."""
        must = "extends UniformSliding, with the method friction(self, sliding_speed, rolling_speed)"
        yield Trial(must, None if self.rolls else f"it must be a law that {must}")


class UniformSliding(SlidingLaw):
    """Friction heat mu p v_s of the whole footprint at one sliding speed v_s; zero in phases without slip.

    The default of ``pressure`` is the load over the modelled footprint, so that the total friction heat is mu F_z v_s.
    """

    pressure: Annotated[float, Unit("Pa", gt=0), CONTACT_PRESSURE] | None = None

    @abstractmethod
    def friction(self, sliding_speed: float, rolling_speed: float) -> float:
        """Friction force over load, without the limit of decomposition; speeds of the tread over the road and through
        the footprint, m/s."""

    def trials(self) -> Iterator[Trial]:
        """The friction from little slip to a locked wheel."""
        for sliding, rolling in ((0.01, 10.0), (1.0, 10.0), (10.0, 10.0), (30.0, 0.0)):
            words = f"friction({sliding:g} m/s sliding, {rolling:g} m/s rolling)"
            yield trial(words, functools.partial(self.friction, sliding, rolling), Range("1", 0.0, 5.0))


class ConstantFriction(UniformSliding):
    """The same coefficient at every slip: used force over load. At small slip 0.8 is an upper bound."""

    law: Literal["constant"]
    coefficient: Friction = 0.8

    def friction(self, sliding_speed: float, rolling_speed: float) -> float:
        """Friction force over load."""
        return self.coefficient


class Brush(UniformSliding):
    """mu (1 - (1 - x)^3), x = v_s/(w r)/``full_slip`` up to 1: bristles stick at the front and slide at the rear.

    The brush of uniform bristles under a parabolic pressure (Pacejka, *Tire and Vehicle Dynamics*, ch. 3); force times
    sliding speed is the heat. At ``full_slip`` the whole footprint slides: 0.15 (estimate).
    """

    law: Literal["brush"]
    coefficient: Friction = 0.8
    full_slip: Annotated[float, Unit("1", gt=0, le=2)] = 0.15

    def friction(self, sliding_speed: float, rolling_speed: float) -> float:
        """Friction force over load."""
        full = self.full_slip * rolling_speed
        x = sliding_speed / full if full > sliding_speed else 1.0
        return self.coefficient * (1.0 - (1.0 - x) ** 3)


class RollingFriction(SlidingLaw):
    """Friction of the tyre that rolls, leans and corners, with the coefficient of the tread's card.

    `tyrefem.mechanics.rolling` gives the friction power of every ring of the tread and the strain cycle.
    """

    law: Literal["rolling"]
    rolls: ClassVar[bool] = True
