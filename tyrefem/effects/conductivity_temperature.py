"""Conductivity that varies with temperature."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects._shared import above_25
from tyrefem.effects.effect import Array, Effect, Factor, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import Tyre


class ConductivityTemperature(Effect):
    """k -> k (1 + slope (T - 25 degC)) in every region."""

    name: ClassVar[str] = "conductivity-temperature"
    family: ClassVar[str] = "conduction"
    sentence: ClassVar[str] = "The conductivity of the rubber changes with temperature."
    source: ClassVar[str] = "estimate: filled rubbers change by -0.1 to +0.2 % per kelvin between 20 and 120 degC"
    signature: ClassVar[Signature] = Signature(
        changes={"drive.initial": "100 degC"}, words="from 100 °C on", signs={"crown-inner": -1}
    )

    slope: Annotated[float, Prior("1/delta_degC", "relative change of k per kelvin", 1.5e-3, -3e-3, 6e-3)] = 0.0

    def conductivity_factor(self, tyre: Tyre, region: str, T: Array) -> tuple[Factor, Factor]:
        """1 + slope (T - 25), the same along and across the plies."""
        factor = 1 + self.slope * above_25(T)
        return factor, factor
