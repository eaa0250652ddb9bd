"""Heat capacity that rises with temperature."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects._shared import above_25
from tyrefem.effects.effect import Array, Effect, Factor, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import Tyre


class HeatCapacityTemperature(Effect):
    """C -> C (1 + slope (T - 25 degC)) in every region."""

    name: ClassVar[str] = "heat-capacity-temperature"
    family: ClassVar[str] = "conduction"
    sentence: ClassVar[str] = "The heat capacity of the rubber rises with temperature."
    source: ClassVar[str] = (
        "estimate: specific heat of rubbers above their glass transition rises by 0.15 to 0.35 % per kelvin"
    )
    signature: ClassVar[Signature] = Signature(signs={"crown-inner": -1, "shoulder-inner": -1})

    slope: Annotated[float, Prior("1/delta_degC", "relative rise of rho c per kelvin", 2.5e-3, 0.0, 8e-3)] = 0.0

    def capacity_factor(self, tyre: Tyre, region: str, T: Array) -> Factor:
        """1 + slope (T - 25)."""
        return 1 + self.slope * above_25(T)
