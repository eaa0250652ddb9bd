"""Length of the footprint from the deflection: one class per law of ``[mechanics] footprint``."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal

from tyrefem.cards import Card
from tyrefem.quantity import Unit
from tyrefem.road_contact import hedekel_length


class TrR64Footprint(Card):
    """NASA TR R-64: 1.7 d sqrt(D/d - (D/d)^2), quoted from memory of the report."""

    law: Literal["tr-r-64"] = "tr-r-64"
    #: Whether a drum shortens what the law gives.
    shorter_on_drum: ClassVar[bool] = True

    def on_flat_road(self, deflection: float, outer_radius: float) -> float:
        """Length, m, from metres."""
        d = 2 * outer_radius
        x = deflection / d
        return 1.7 * d * math.sqrt(max(x - x * x, 0.0))


class HedekelFootprint(Card):
    """The chord c 2 sqrt(D (2 r_0 - D)) (Cattani et al. 2023, eq 13); ``correction`` c is a measured factor."""

    law: Literal["hedekel"]
    correction: Annotated[float, Unit("1", gt=0, le=2)] = 1.0
    shorter_on_drum: ClassVar[bool] = True

    def on_flat_road(self, deflection: float, outer_radius: float) -> float:
        """Length, m, from metres."""
        return hedekel_length(deflection, outer_radius, self.correction)


class GivenFootprint(Card):
    """A measured length, at every load and on any drum; none where the tyre does not touch the road."""

    law: Literal["given"]
    length: Annotated[float, Unit("m", gt=0, le=4)]
    shorter_on_drum: ClassVar[bool] = False

    def on_flat_road(self, deflection: float, outer_radius: float) -> float:
        """Length, m, from metres."""
        return self.length if deflection > 0 else 0.0


FootprintLaw = TrR64Footprint | HedekelFootprint | GivenFootprint
TR_R_64 = TrR64Footprint()
