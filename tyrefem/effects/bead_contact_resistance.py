"""A thermal resistance between bead and rim."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects.effect import Effect, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import Tyre


class BeadContactResistance(Effect):
    """1/h -> 1/h + resistance at the rim."""

    name: ClassVar[str] = "bead-contact-resistance"
    family: ClassVar[str] = "boundary"
    of_drive: ClassVar[bool] = True
    sentence: ClassVar[str] = "Heat has to cross a thin gap between bead and rim."
    source: ClassVar[str] = (
        "Clark & Dodge 1980, appendix I: unknown and neglected; estimate: 1e-4 to 1e-3 m2 K/W for rubber pressed "
        "on metal, 0.04 for 1 mm of still air"
    )
    signature: ClassVar[Signature] = Signature(
        changes={"sensors.bead": {"s": "5.6 in", "depth": "0.3 in"}, "drive.rim_temperature": "90 degC"},
        words="with a bead thermocouple and the rim at 90 °C",
        signs={"bead": -1},
    )

    resistance: Annotated[float, Prior("m**2*K/W", "thermal resistance between bead and rim", 1e-3, 0.0, 0.1)] = 0.0

    def film_resistance(self, tyre: Tyre, film: str, t: float) -> float:
        """m2 K/W in series with the rim's film."""
        return self.resistance if film == "rim" else 0.0
