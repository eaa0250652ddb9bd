"""Sunshine on the tyre."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects.effect import Array, Effect, Factor, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import Tyre


class Sun(Effect):
    """Flux ``absorbed`` through tread and outer sidewall, mean over the turning surface."""

    name: ClassVar[str] = "sun"
    family: ClassVar[str] = "boundary"
    of_the_day: ClassVar[bool] = True
    sentence: ClassVar[str] = "The sun shines on the tyre."
    source: ClassVar[str] = (
        "estimate: up to 1000 W/m2 at the ground, 0.93 absorbed by black rubber, a sixth of the outer surface in "
        "the sun"
    )
    signature: ClassVar[Signature] = Signature(signs={"sidewall-outer": 1, "shoulder-outer": 1})

    surfaces: ClassVar[tuple[str, ...]] = ("road", "outside_air")

    absorbed: Annotated[
        float, Prior("W/m**2", "absorbed by the outer surface, mean over the revolution", 100.0, 0.0, 600.0)
    ] = 0.0

    def flux(self, tyre: Tyre, surface: str, x: Array, t: float) -> Factor:
        """W/m2 into the tyre, from the start to the end."""
        return self.absorbed
