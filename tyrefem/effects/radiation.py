"""Radiation of the outer surface."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.cards.plausible import EMISSIVITY
from tyrefem.conduction import Radiation
from tyrefem.effects.effect import Effect, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import Tyre


class RadiationToAmbient(Effect):
    """q = emissivity sigma (T_a^4 - T^4) on outer sidewall and tread, whose time on the road is neglected."""

    name: ClassVar[str] = "radiation"
    family: ClassVar[str] = "boundary"
    sentence: ClassVar[str] = "The outer surface radiates to the surroundings beside what the film takes."
    source: ClassVar[str] = (
        "Allouis et al. 2016: emissivity 0.95 of tread and liner. Clark & Dodge 1980 do not say whether their "
        "films include radiation"
    )
    signature: ClassVar[Signature] = Signature(signs={"sidewall-outer": -1, "shoulder-outer": -1})

    surfaces: ClassVar[tuple[str, ...]] = ("road", "outside_air")

    emissivity: Annotated[float, Prior("1", "emissivity of the outer surface", 0.6, 0.0, 1.0), EMISSIVITY] = 0.0

    def radiation(self, tyre: Tyre, surface: str) -> Radiation | None:
        """To the ambient."""
        return Radiation(self.emissivity, lambda x, t: tyre.ambient(t))
