"""An outside film with another speed law."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects._shared import speed_ratio
from tyrefem.effects.effect import Effect, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import Tyre


class OutsideFilmSpeed(Effect):
    """h -> h_0 + (h - h_0) (v / v_ref)^exponent while rolling, h_0 = 5.44 W/m2/K of still air, v_ref = 10 m/s.

    h is the study's law; what `wind` adds to it is not multiplied.
    """

    name: ClassVar[str] = "outside-film-speed"
    family: ClassVar[str] = "boundary"
    of_drive: ClassVar[bool] = True
    sentence: ClassVar[str] = "The outside film follows another power of speed than the study says."
    source: ClassVar[str] = (
        "Clark & Dodge 1980, appendix I: 5.44 + 1.674 v; estimate: turbulent flow over a plate goes with v^0.8, a "
        "wheel in a well less: -0.2 beside the linear law, 0.8 beside a constant film"
    )
    signature: ClassVar[Signature] = Signature(
        changes={"drive.phases.rolling.speed": "30 m/s"}, words="at 30 m/s", signs={"sidewall-outer": -1}
    )

    #: Film of still air, W/m2/K (Clark & Dodge 1980, appendix I): what speed has no part in.
    STILL: ClassVar[float] = 5.44

    exponent: Annotated[float, Prior("1", "added to the exponent of speed of the forced part", 0.3, -0.9, 1.5)] = 0.0

    def film_addend(self, tyre: Tyre, film: str, t: float) -> float:
        """W/m2/K added to the forced part of the law, by (v / v_ref)^exponent - 1; nothing at rest."""
        if film != "outside_air" or tyre.speed(t) == 0:
            return 0.0
        forced = max(tyre.study.card.boundaries.outside_air.film(tyre.speed(t)) - self.STILL, 0.0)
        return float(forced * (speed_ratio(tyre, t) ** self.exponent - 1))
