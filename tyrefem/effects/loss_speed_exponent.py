"""tan delta that rises with frequency."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects._shared import speed_ratio
from tyrefem.effects.effect import Array, Effect, Factor, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import Tyre


class LossSpeedExponent(Effect):
    """q -> q (v / v_ref)^exponent, v_ref = 10 m/s."""

    name: ClassVar[str] = "loss-speed-exponent"
    family: ClassVar[str] = "heat"
    sentence: ClassVar[str] = "Hysteresis rises with the frequency of the strain cycle, and so with speed."
    source: ClassVar[str] = (
        "estimate: tan(delta) of filled rubber above its glass transition rises by 10 to 50 % per decade of "
        "frequency (exponent 0.04 to 0.18)"
    )
    heat_of_temperature: ClassVar[bool] = False
    signature: ClassVar[Signature] = Signature(
        changes={"drive.phases.rolling.speed": "30 m/s"},
        words="at 30 m/s",
        signs={"crown-inner": 1, "sidewall-inner": 1},
    )

    exponent: Annotated[float, Prior("1", "exponent of speed in the loss per revolution", 0.15, 0.0, 1.0)] = 0.0

    def heat_factor(self, tyre: Tyre, zone: str, x: Array, t: float, T: Array) -> Factor:
        """(v / v_ref)^exponent."""
        return float(speed_ratio(tyre, t) ** self.exponent)
