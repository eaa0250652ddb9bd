"""Wind on the tyre."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects.effect import Effect, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import Tyre


class Wind(Effect):
    """h -> h + 1.674 air_speed of the outer surface, rolling and at rest (W/m2/K, m/s)."""

    name: ClassVar[str] = "wind"
    family: ClassVar[str] = "boundary"
    of_the_day: ClassVar[bool] = True
    of_drive: ClassVar[bool] = True
    sentence: ClassVar[str] = "Wind, or a fan, cools the tyre beyond the air of its own speed."
    source: ClassVar[str] = (
        "Clark & Dodge 1980, appendix I: 1.674 W/m2/K per m/s of air; estimate: a fresh breeze is 8 to 10 m/s, half of "
        "it reaches the tyre"
    )
    signature: ClassVar[Signature] = Signature(signs={"sidewall-outer": -1, "shoulder-outer": -1})

    #: Film of the outer surface per air speed, W s/m3/K (Clark & Dodge 1980, appendix I).
    PER_SPEED: ClassVar[float] = 1.674

    air_speed: Annotated[float, Prior("m/s", "air past the tyre beyond its own speed", 4.0, 0.0, 20.0)] = 0.0

    def film_addend(self, tyre: Tyre, film: str, t: float) -> float:
        """W/m2/K added to the outside film."""
        return self.PER_SPEED * self.air_speed if film == "outside_air" else 0.0
