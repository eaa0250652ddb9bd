"""A film coefficient other than its law says: a correction of the base model, no missing effect."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from tyrefem.effects.effect import Effect, Prior
from tyrefem.effects.tyre import Tyre


class FilmScale(Effect):
    """h -> exp(log_factor) h of one film."""

    name: ClassVar[str] = "film-scale"
    family: ClassVar[str] = "calibration"
    of_drive: ClassVar[bool] = True
    calibration: ClassVar[bool] = True
    sentence: ClassVar[str] = "A film coefficient is larger or smaller than its law says, at every speed alike."
    source: ClassVar[str] = "estimate: correlations of forced convection scatter by 20 to 30 % (handbook values)"

    film: Annotated[
        Literal["road", "outside_air", "tread_air", "contained_air", "rim"],
        Field(
            description="which film: road, outside_air, contained_air, rim, or tread_air (tread between two contacts)",
            examples=["outside_air"],
        ),
    ]
    log_factor: Annotated[float, Prior("1", "natural logarithm of the factor", 0.2, -2.0, 2.0)] = 0.0

    @property
    def choice(self) -> dict[str, str]:
        """Which film."""
        return {"film": self.film}

    def film_factor(self, tyre: Tyre, film: str, t: float) -> float:
        """The factor, on its own film only."""
        return float(np.exp(self.log_factor)) if film == self.film else 1.0
