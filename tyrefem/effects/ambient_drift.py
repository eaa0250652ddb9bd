"""Ambient air that warms or cools during the run."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects.effect import Effect, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import Tyre


class AmbientDrift(Effect):
    """T_a -> T_a + rate t; the road too, where the study gives it no temperature of its own."""

    name: ClassVar[str] = "ambient-drift"
    family: ClassVar[str] = "boundary"
    of_the_day: ClassVar[bool] = True
    sentence: ClassVar[str] = "The ambient temperature drifts during the run."
    source: ClassVar[str] = "estimate: a test hall or a summer morning drifts by some kelvins per hour"
    signature: ClassVar[Signature] = Signature(signs={"sidewall-outer": 1, "shoulder-outer": 1, "contained-air": 1})

    rate: Annotated[
        float,
        Prior(
            "delta_degC/s",
            "change per time, from the start",
            8 / 3600,
            -40 / 3600,
            40 / 3600,
            written="delta_degC/hour",
        ),
    ] = 0.0

    def sink_addend(self, tyre: Tyre, sink: str, t: float) -> float:
        """K added to the ambient."""
        return self.rate * t if sink == "outside_air" else 0.0
