"""Friction of a tread that slides on the road, braked or driven."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects._shared import sliding_flux
from tyrefem.effects.effect import Array, Effect, Factor, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import Tyre


class TreadSlip(Effect):
    """Flux into the tread  mu p |slip| v f b_tyre / (b_tyre + b_road), averaged over the revolution."""

    name: ClassVar[str] = "tread-slip"
    family: ClassVar[str] = "heat"
    sentence: ClassVar[str] = "The tread slides on the road, braked, driven or scrubbed, and friction heats it."
    source: ClassVar[str] = (
        "Roberts, Temperature rise when rubber slides, eqs 2 and 5; estimate: mu = 0.8, contact pressure = "
        "inflation pressure, dense asphalt (1732 J/m2/K/s^0.5); free rolling scrubs by 0.1 to 1 %; "
        "beside rolling with friction its heat is 2.7 times too large at a slip of 1 %, right near 3 % and 0.6 of it "
        "at 10 %, and the hysteresis of braking is missing (docs/evidence/rolling-friction.md)"
    )
    free_rolling: ClassVar[bool] = False
    signature: ClassVar[Signature] = Signature(signs={"surface": 1, "shoulder-outer": 1})

    slip: Annotated[float, Prior("1", "sliding speed over the tyre's speed", 0.01, 0.0, 0.2)] = 0.0

    surfaces: ClassVar[tuple[str, ...]] = ("road",)

    def flux(self, tyre: Tyre, surface: str, x: Array, t: float) -> Factor:
        """W/m2 into the tread, the same over its width."""
        return self.slip * sliding_flux(tyre, t)
