"""Inflation pressure that rises as the contained air warms."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar

from tyrefem.effects.effect import Array, Effect, Factor, Prior
from tyrefem.effects.leak import deflection_change, no_load, of_load_law
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import StudyOfTyre, Tyre


class PressureRise(Effect):
    """q -> q (D(p + p rise (1 - exp(-t/lag))) / D(p))^2, D at the drive's load; not in tread and bead."""

    name: ClassVar[str] = "pressure-rise"
    family: ClassVar[str] = "heat"
    sentence: ClassVar[str] = (
        "The contained air warms, its pressure rises and the tyre deflects less than the drive says."
    )
    source: ClassVar[str] = (
        "estimate: at constant volume 45 K of warming raise the absolute pressure by 15 %; strain energy goes with "
        "the square of the deflection; pressed by finite elements at 1.15 p, D of the 22x5.5 8PR falls by 8 %, by the "
        "load law by 10 %"
    )
    heat_of_temperature: ClassVar[bool] = False
    signature: ClassVar[Signature] = Signature(signs={"crown-inner": -1, "sidewall-inner": -1})

    rise: Annotated[float, Prior("1", "rise of the gauge pressure over the drive's, in the end", 0.15, 0.0, 0.8)] = 0.0
    lag: Annotated[float, Prior("s", "time in which it rises", 300.0, 30.0, 3600.0, start=400.0, amplitude=False)] = (
        400.0
    )

    def heat_factor(self, tyre: Tyre, zone: str, x: Array, t: float, T: Array) -> Factor:
        """(D'/D)^2 at the risen pressure."""
        if tyre.region(zone) in ("tread", "bead"):
            return 1.0
        return deflection_change(tyre, t, 1 + self.rise * -math.expm1(-t / self.lag)) ** 2

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """A drive at a given deflection does not feel the pressure; feedback raises it already."""
        feedback = study.card.mechanics.feedback
        if feedback is not None and feedback.pressure:
            return "the pressure rises with the contained air already: mechanics.feedback.pressure"
        return no_load(study)

    @classmethod
    def beside_pressing(cls, study: StudyOfTyre) -> str | None:
        """The deflection of the pressed tyre is not asked."""
        return of_load_law(study)
