"""Heat of unknown origin through a surface about one station of the meridian."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from tyrefem.effects.effect import Effect, Factor, Prior
from tyrefem.effects.tyre import Tyre
from tyrefem.quantity import Unit

Array = NDArray[np.float64]
#: Surface -> its boundaries in the heat balance.
BOUNDARIES = {"outer": ("road", "outside_air"), "inner": ("contained_air",), "rim": ("rim",)}


class MissingFlux(Effect):
    """A flux exp(-((|s| - station)/width)^2 / 2) into a surface, by default the outer one, rolling or not.

    ``begins`` and ``ends`` limit it to a part of the drive.
    """

    name: ClassVar[str] = "missing-flux"
    family: ClassVar[str] = "calibration"
    calibration: ClassVar[bool] = True
    sentence: ClassVar[str] = "Heat of unknown origin into a surface about one station, in W/m2, at all times."
    source: ClassVar[str] = "none: what a diagnosis finds when nothing in the catalogue explains a gap"

    station: Annotated[
        float, Unit("m", ge=0), Field(description="distance from the crown on the meridian", examples=["60 mm"])
    ]
    width: Annotated[
        float, Unit("m", gt=0), Field(description="standard deviation about the station", examples=["10 mm"])
    ]
    surface: Annotated[
        Literal["outer", "inner", "rim"], Field(description="the surface", examples=["outer", "inner", "rim"])
    ] = "outer"
    begins: Annotated[
        float | None, Unit("s", ge=0), Field(description="begins at this time of the drive", examples=["300 s"])
    ] = None
    ends: Annotated[
        float | None, Unit("s", ge=0), Field(description="ends at this time of the drive", examples=["600 s"])
    ] = None
    into: Annotated[float, Prior("W/m**2", "flux at the station", 200.0, -1e5, 1e5)] = 0.0

    @property
    def choice(self) -> dict[str, str]:
        """Where."""
        where = {"station": f"{self.station!r} m", "width": f"{self.width!r} m"}
        when = {"begins": self.begins, "ends": self.ends}
        surface = {} if self.surface == "outer" else {"surface": self.surface}
        return where | surface | {key: f"{time!r} s" for key, time in when.items() if time is not None}

    @property
    def jumps(self) -> tuple[float, ...]:  # type: ignore[override]
        """Begin and end."""
        return tuple(time for time in (self.begins, self.ends) if time is not None)

    @property
    def surfaces(self) -> tuple[str, ...]:  # type: ignore[override]
        """The boundaries of the surface."""
        return BOUNDARIES[self.surface]

    def flux(self, tyre: Tyre, surface: str, x: Array, t: float) -> Factor:
        """W/m2 at points x (2, n)."""
        if (self.begins is not None and t < self.begins) or (self.ends is not None and t > self.ends):
            return 0.0
        s, _ = tyre.places(x)
        return np.asarray(self.into * np.exp(-(((s - self.station) / self.width) ** 2) / 2))
