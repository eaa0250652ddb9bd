"""Effects that are in no catalogue, for blind tests of the verdict "unexplained"."""

from __future__ import annotations

from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from tyrefem.effects.effect import Effect, Factor, Prior
from tyrefem.effects.tyre import Tyre
from tyrefem.quantity import Unit

Array = NDArray[np.float64]


class HotRing(Effect):
    """A ring of the wall heats itself between two stations, as with a delamination that rubs: q += heat (v/v_0)^n."""

    name: ClassVar[str] = "stranger-hot-ring"
    family: ClassVar[str] = "heat"
    sentence: ClassVar[str] = "A delaminated ring rubs and heats itself."
    source: ClassVar[str] = "estimate: made up for blind tests"

    start: Annotated[float, Unit("m", ge=0)]
    end: Annotated[float, Unit("m", gt=0)]
    outer: bool
    exponent: float
    heat: Annotated[float, Prior("W/m**3", "heat at 10 m/s", 1e5, 0.0, 1e7)] = 0.0

    def heat_addend(self, tyre: Tyre, zone: str, x: Array, t: float, T: Array) -> Factor:
        """W/m3 in one half of the thickness, between the stations."""
        s, depth = tyre.places(x)
        middle = np.asarray(tyre.study.section.total_thickness(s)) / 2
        inside = (s > self.start) & (s < self.end) & ((depth > middle) == self.outer)
        return np.asarray(self.heat * (tyre.speed(t) / 10.0) ** self.exponent * inside)


class Lamp(Effect):
    """Something hot stands beside the tyre for a while and shines on a stretch of the outer wall."""

    name: ClassVar[str] = "stranger-lamp"
    family: ClassVar[str] = "boundary"
    sentence: ClassVar[str] = "A hot body beside the tyre, an exhaust say, shines on a stretch of the wall."
    source: ClassVar[str] = "estimate: made up for blind tests"
    surfaces: ClassVar[tuple[str, ...]] = ("road", "outside_air")

    start: Annotated[float, Unit("m", ge=0)]
    end: Annotated[float, Unit("m", gt=0)]
    until: Annotated[float, Unit("s", gt=0)]
    shine: Annotated[float, Prior("W/m**2", "flux", 500.0, 0.0, 1e5)] = 0.0

    def flux(self, tyre: Tyre, surface: str, x: Array, t: float) -> Factor:
        """W/m2 between the stations, until it goes."""
        s, _ = tyre.places(x.reshape(2, -1))
        return np.asarray(self.shine * ((s > self.start) & (s < self.end)) * (t < self.until))
