"""Heat of unknown origin through a surface, about one station of the meridian or everywhere."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from tyrefem.effects._shared import beyond_meridian
from tyrefem.effects.effect import Effect, Factor, Prior
from tyrefem.effects.part_of_drive import Begins, Ends, check_order, is_outside, stated_times, times_in_words
from tyrefem.effects.tyre import StudyOfTyre, Tyre
from tyrefem.quantity import Unit

Array = NDArray[np.float64]
#: Surface -> its boundaries in the heat balance.
BOUNDARIES = {
    "outer": ("road", "outside_air"),
    "tread": ("road",),
    "sidewall": ("outside_air",),
    "inner": ("contained_air",),
    "rim": ("rim",),
}


class MissingFlux(Effect):
    """A flux exp(-((|s| - station)/width)^2 / 2) into a surface, by default the outer one, rolling or not.

    Without ``station`` and ``width`` it is the same on the whole surface. ``begins`` and ``ends`` limit it to a part of
    the drive.
    """

    name: ClassVar[str] = "missing-flux"
    family: ClassVar[str] = "calibration"
    calibration: ClassVar[bool] = True
    sentence: ClassVar[str] = "Heat of unknown origin into a surface, in W/m2, at all times."
    source: ClassVar[str] = "none: what a diagnosis finds when nothing in the catalogue explains a gap"

    station: Annotated[
        float | None, Unit("m", ge=0), Field(description="distance from the crown on the meridian", examples=["60 mm"])
    ] = None
    width: Annotated[
        float | None, Unit("m", gt=0), Field(description="standard deviation about the station", examples=["10 mm"])
    ] = None
    surface: Annotated[
        Literal["outer", "tread", "sidewall", "inner", "rim"],
        Field(description="the surface; tread is the part that meets the road", examples=["outer", "tread", "inner"]),
    ] = "outer"
    begins: Begins = None
    ends: Ends = None
    into: Annotated[float, Prior("W/m**2", "flux, at the station if there is one", 200.0, -1e5, 1e5)] = 0.0

    @model_validator(mode="after")
    def _about_a_station_or_everywhere(self) -> Self:
        if (self.station is None) != (self.width is None):
            raise ValueError("state both station and width, or neither for the whole surface")
        check_order(self.begins, self.ends)
        return self

    @property
    def choice(self) -> dict[str, str]:
        """Where."""
        about = {"station": self.station, "width": self.width}
        where = {key: f"{value!r} m" for key, value in about.items() if value is not None}
        surface = {} if self.surface == "outer" else {"surface": self.surface}
        return where | surface | times_in_words(self.begins, self.ends)

    @property
    def jumps(self) -> tuple[float, ...]:  # type: ignore[override]
        """Begin and end."""
        return stated_times(self.begins, self.ends)

    @property
    def surfaces(self) -> tuple[str, ...]:  # type: ignore[override]
        """The boundaries of the surface."""
        return BOUNDARIES[self.surface]

    def flux(self, tyre: Tyre, surface: str, x: Array, t: float) -> Factor:
        """W/m2 at points x (2, n)."""
        if is_outside(t, self.begins, self.ends):
            return 0.0
        if self.station is None or self.width is None:
            return self.into
        s, _ = tyre.places(x)
        return np.asarray(self.into * np.exp(-(((s - self.station) / self.width) ** 2) / 2))

    def problem(self, study: StudyOfTyre) -> str | None:
        """A station beyond the meridian."""
        return beyond_meridian(study, self.station, self.width)
