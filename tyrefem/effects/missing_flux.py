"""Heat of unknown origin through the outer surface about one station of the meridian."""

from __future__ import annotations

from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from tyrefem.effects.effect import Effect, Factor, Prior
from tyrefem.effects.tyre import Tyre
from tyrefem.quantity import Unit

Array = NDArray[np.float64]


class MissingFlux(Effect):
    """A flux exp(-((|s| - station)/width)^2 / 2) into the outer surface, rolling or not."""

    name: ClassVar[str] = "missing-flux"
    family: ClassVar[str] = "calibration"
    calibration: ClassVar[bool] = True
    sentence: ClassVar[str] = "Heat of unknown origin into the outer surface about one station, in W/m2, at all times."
    source: ClassVar[str] = "none: what a diagnosis finds when nothing in the catalogue explains a gap"
    surfaces: ClassVar[tuple[str, ...]] = ("road", "outside_air")

    station: Annotated[
        float, Unit("m", ge=0), Field(description="distance from the crown on the meridian", examples=["60 mm"])
    ]
    width: Annotated[
        float, Unit("m", gt=0), Field(description="standard deviation about the station", examples=["10 mm"])
    ]
    into: Annotated[float, Prior("W/m**2", "flux at the station", 200.0, -1e5, 1e5)] = 0.0

    @property
    def choice(self) -> dict[str, str]:
        """Where."""
        return {"station": f"{self.station!r} m", "width": f"{self.width!r} m"}

    def flux(self, tyre: Tyre, surface: str, x: Array, t: float) -> Factor:
        """W/m2 at points x (2, n)."""
        s, _ = tyre.places(x)
        return np.asarray(self.into * np.exp(-(((s - self.station) / self.width) ** 2) / 2))
