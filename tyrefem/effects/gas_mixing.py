"""Contained air that rolling stirs."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects._shared import REFERENCE_SPEED
from tyrefem.effects.effect import Effect, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import Tyre


class GasMixing(Effect):
    """h_gas -> h_gas (1 + gain v / v_ref), v_ref = 10 m/s."""

    name: ClassVar[str] = "gas-mixing"
    family: ClassVar[str] = "boundary"
    of_drive: ClassVar[bool] = True
    sentence: ClassVar[str] = "Rolling stirs the contained air, which then takes up heat more quickly."
    source: ClassVar[str] = (
        "Clark & Dodge 1980, appendix I: 4.18 W/m2/K at any speed; estimate: forced convection in a cavity of this "
        "size reaches 10 to 30 W/m2/K at 10 m/s"
    )
    signature: ClassVar[Signature] = Signature(signs={"contained-air": 1, "crown-inner": -1})

    gain: Annotated[float, Prior("1", "relative rise of the film at 10 m/s", 2.0, 0.0, 20.0)] = 0.0

    def film_factor(self, tyre: Tyre, film: str, t: float) -> float:
        """1 + gain v / v_ref on the contained air's film."""
        return 1 + self.gain * tyre.motion(t).rolling_speed / REFERENCE_SPEED if film == "contained_air" else 1.0
