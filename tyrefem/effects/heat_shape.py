"""Another strain energy along the meridian: a smooth factor on the heat of all layers."""

from __future__ import annotations

from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from tyrefem.effects.effect import Effect, Factor, Prior
from tyrefem.effects.tyre import Tyre

Array = NDArray[np.float64]


class HeatShape(Effect):
    """q -> q exp(log_factor cos(pi half_waves |s| / L)), s from the crown along the meridian of length L.

    The factors of several entries multiply, so any smooth factor along the meridian is a sum of half waves.
    """

    name: ClassVar[str] = "heat-shape"
    family: ClassVar[str] = "calibration"
    calibration: ClassVar[bool] = True
    of_place: ClassVar[bool] = True
    sentence: ClassVar[str] = "The strain energy differs along the meridian, by a smooth factor."
    source: ClassVar[str] = "none: what a diagnosis allows for where the strain law may be wrong"
    heat_of_temperature: ClassVar[bool] = False

    half_waves: Annotated[
        int, Field(description="half waves between crown and bead; 0: the same everywhere", ge=0, le=20, examples=[2])
    ]
    log_factor: Annotated[float, Prior("1", "natural logarithm of the factor at the crown", 0.25, -3.0, 3.0)] = 0.0

    @property
    def choice(self) -> dict[str, str]:
        """Which course along the meridian."""
        return {"half_waves": str(self.half_waves)}

    def heat_factor(self, tyre: Tyre, zone: str, x: Array, t: float, T: Array) -> Factor:
        """Factor at points x (2, n)."""
        s, _ = tyre.places(x)
        course = np.cos(np.pi * self.half_waves * np.abs(s) / tyre.study.section.line.length)
        return np.asarray(np.exp(self.log_factor * course))
