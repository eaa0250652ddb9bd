"""Heat of unknown origin about one station of the meridian."""

from __future__ import annotations

from typing import Annotated, ClassVar, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from tyrefem.effects._shared import beyond_meridian, no_region
from tyrefem.effects.effect import Effect, Factor, Prior
from tyrefem.effects.part_of_drive import Begins, Ends, check_order, is_outside, stated_times, times_in_words
from tyrefem.effects.tyre import StudyOfTyre, Tyre
from tyrefem.quantity import Unit

Array = NDArray[np.float64]


class MissingHeat(Effect):
    """q -> q + heat exp(-((|s| - station)/width)^2 / 2) through the whole thickness, while the tyre rolls.

    With a ``region`` the heat is in this region only. ``begins`` and ``ends`` limit it to a part of the drive.
    """

    name: ClassVar[str] = "missing-heat"
    family: ClassVar[str] = "calibration"
    calibration: ClassVar[bool] = True
    sentence: ClassVar[str] = "Heat of unknown origin about one station of the meridian, in W/m3, while the tyre rolls."
    source: ClassVar[str] = "none: what a diagnosis finds when nothing in the catalogue explains a gap"
    heat_of_temperature: ClassVar[bool] = False

    station: Annotated[
        float, Unit("m", ge=0), Field(description="distance from the crown on the meridian", examples=["60 mm"])
    ]
    width: Annotated[
        float, Unit("m", gt=0), Field(description="standard deviation about the station", examples=["10 mm"])
    ]
    region: Annotated[
        str | None, Field(description="the only region that is heated; default: all", examples=["ply"])
    ] = None
    begins: Begins = None
    ends: Ends = None
    heat: Annotated[float, Prior("W/m**3", "heat at the station", 5e4, -1e7, 1e7)] = 0.0

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        check_order(self.begins, self.ends)
        return self

    @property
    def choice(self) -> dict[str, str]:
        """Where."""
        where = {"station": f"{self.station!r} m", "width": f"{self.width!r} m"}
        region = {} if self.region is None else {"region": self.region}
        return where | region | times_in_words(self.begins, self.ends)

    @property
    def jumps(self) -> tuple[float, ...]:  # type: ignore[override]
        """Begin and end."""
        return stated_times(self.begins, self.ends)

    def heat_addend(self, tyre: Tyre, zone: str, x: Array, t: float, T: Array) -> Factor:
        """W/m3 at points x (2, n)."""
        outside = is_outside(t, self.begins, self.ends)
        if outside or tyre.motion(t).rolling_speed == 0 or self.region not in (None, tyre.region(zone)):
            return 0.0
        s, _ = tyre.places(x)
        return np.asarray(self.heat * np.exp(-(((s - self.station) / self.width) ** 2) / 2))

    def problem(self, study: StudyOfTyre) -> str | None:
        """A region that the section does not have, or a station beyond its meridian."""
        return no_region(study, self.region) or beyond_meridian(study, self.station, self.width)
