"""A road warmer (or colder) than the study says."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects.effect import Effect, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import Tyre


class HotRoad(Effect):
    """T_road -> T_road + warmer_by."""

    name: ClassVar[str] = "hot-road"
    family: ClassVar[str] = "boundary"
    of_the_day: ClassVar[bool] = True
    of_drive: ClassVar[bool] = True
    sentence: ClassVar[str] = "The road is warmer than stated, as asphalt in the sun is."
    opposite: ClassVar[str] = "The road is colder than stated."
    source: ClassVar[str] = "estimate: summer asphalt is 20 to 30 K above the air (handbook range)"
    signature: ClassVar[Signature] = Signature(signs={"shoulder-outer": 1, "crown-middle": 1})

    warmer_by: Annotated[float, Prior("delta_degC", "road above its stated temperature", 10.0, -30.0, 60.0)] = 0.0

    def sink_addend(self, tyre: Tyre, sink: str, t: float) -> float:
        """K added to the road's temperature."""
        return self.warmer_by if sink == "road" else 0.0
