"""Conduction along the cords of the carcass."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects._shared import no_carcass
from tyrefem.effects.effect import Array, Effect, Factor, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import StudyOfTyre, Tyre


class CordConduction(Effect):
    """k_along -> k_along (1 + gain) in the carcass."""

    name: ClassVar[str] = "cord-conduction"
    family: ClassVar[str] = "conduction"
    sentence: ClassVar[str] = "Cords conduct better than rubber, so heat flows more easily along the plies."
    source: ClassVar[str] = (
        "estimate: rubber 0.2 W/m/K; along the fibre nylon and polyester 0.2 to 1 (gain below 1), aramid 3 to 4, "
        "steel about 50 (gain 5 to 30 at 2 to 10 % by volume)"
    )
    signature: ClassVar[Signature] = Signature(signs={"crown-inner": -1, "shoulder-inner": -1})

    gain: Annotated[float, Prior("1", "relative rise of the conductivity along the plies", 1.0, 0.0, 40.0)] = 0.0

    def conductivity_factor(self, tyre: Tyre, region: str, T: Array) -> tuple[Factor, Factor]:
        """1 + gain along the plies of the carcass."""
        return (1 + self.gain, 1.0) if region == "carcass" else (1.0, 1.0)

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """A section of plies and belts has no region 'carcass': its cards give the conductivity along the cords."""
        return no_carcass(study)
