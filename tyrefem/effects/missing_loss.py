"""Heat of unknown origin in proportion to the model's own hysteresis."""

from __future__ import annotations

from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from tyrefem.effects._shared import no_region
from tyrefem.effects.effect import Effect, Factor, Prior
from tyrefem.effects.tyre import StudyOfTyre, Tyre

Array = NDArray[np.float64]


class MissingLoss(Effect):
    """q -> q (1 + gain) in one region, or in all."""

    name: ClassVar[str] = "missing-loss"
    family: ClassVar[str] = "calibration"
    calibration: ClassVar[bool] = True
    sentence: ClassVar[str] = "Heat of unknown origin in proportion to the model's own hysteresis."
    source: ClassVar[str] = "none: what a diagnosis tries when nothing in the catalogue explains a gap"
    heat_of_temperature: ClassVar[bool] = False

    region: Annotated[
        str | None, Field(description="the only region whose loss changes; default: all", examples=["tread"])
    ] = None
    gain: Annotated[float, Prior("1", "share of the model's heat that is missing", 0.1, -0.95, 20.0)] = 0.0

    @property
    def choice(self) -> dict[str, str]:
        """Where."""
        return {} if self.region is None else {"region": self.region}

    def heat_factor(self, tyre: Tyre, zone: str, x: Array, t: float, T: Array) -> Factor:
        """1 + gain in the region."""
        return 1.0 + self.gain if self.region in (None, tyre.region(zone)) else 1.0

    def problem(self, study: StudyOfTyre) -> str | None:
        """A region that the section does not have."""
        return no_region(study, self.region)
