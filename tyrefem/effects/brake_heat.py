"""A brake that warms the rim."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar

from tyrefem.effects.effect import Effect, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import StudyOfTyre, Tyre


class BrakeHeat(Effect):
    """T_rim -> T_rim + warmer_by (1 - exp(-(t - begins)/lag)),  t > begins."""

    name: ClassVar[str] = "brake-heat"
    family: ClassVar[str] = "boundary"
    sentence: ClassVar[str] = "The brake warms the rim, and the rim the bead."
    source: ClassVar[str] = "estimate: the wheels of braked runs get 20 to 100 K hotter than ambient within minutes"
    free_rolling: ClassVar[bool] = False
    signature: ClassVar[Signature] = Signature(
        changes={"sensors.bead": {"s": "5.6 in", "depth": "0.3 in"}},
        words="with a bead thermocouple",
        signs={"bead": 1},
    )

    warmer_by: Annotated[float, Prior("delta_degC", "warming of the rim in the end", 30.0, 0.0, 300.0)] = 0.0
    lag: Annotated[float, Prior("s", "time in which it warms", 200.0, 30.0, 3600.0, start=300.0, amplitude=False)] = (
        300.0
    )
    begins: Annotated[
        float, Prior("s", "time at which the brake begins to warm it", 300.0, 0.0, 36000.0, start=0.0, amplitude=False)
    ] = 0.0

    def sink_addend(self, tyre: Tyre, sink: str, t: float) -> float:
        """K added to the rim's temperature."""
        if sink != "rim" or t <= self.begins:
            return 0.0
        return self.warmer_by * -math.expm1(-(t - self.begins) / self.lag)

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """A lumped rim finds its own temperature."""
        lumped = study.card.boundaries.rim.law == "lumped"
        return "the rim is lumped and finds its own temperature; use 'brake-power'" if lumped else None
