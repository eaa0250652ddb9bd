"""tan delta with another temperature law."""

from __future__ import annotations

from typing import Annotated, ClassVar

import numpy as np

from tyrefem.effects._shared import above_25
from tyrefem.effects.effect import Array, Effect, Factor, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import Tyre


class LossTemperatureLaw(Effect):
    """q -> q exp(-rate (T - 25 degC))."""

    name: ClassVar[str] = "loss-temperature-law"
    family: ClassVar[str] = "heat"
    sentence: ClassVar[str] = "tan delta falls with temperature faster (or slower) than the card says."
    source: ClassVar[str] = (
        "Clark & Dodge 1980, table 3, note 5: 0.0148 1/K for all compounds; estimate: compounds differ by a third "
        "of that"
    )
    signature: ClassVar[Signature] = Signature(signs={"crown-inner": -1, "shoulder-inner": -1})

    rate: Annotated[float, Prior("1/delta_degC", "added to the rate at which tan delta falls", 0.005, -0.02, 0.03)] = (
        0.0
    )

    def heat_factor(self, tyre: Tyre, zone: str, x: Array, t: float, T: Array) -> Factor:
        """exp(-rate (T - 25))."""
        return np.asarray(np.exp(-self.rate * above_25(T)))
