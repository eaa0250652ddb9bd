"""Shoulder and sidewall of an under-inflated tyre flex more than the two arcs say."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects._shared import beyond_shoulder, deflection_ratio
from tyrefem.effects.effect import Array, Effect, Factor, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import Tyre


class UnderInflationFlexing(Effect):
    """q -> q (1 + gain w(s) max(D/D_rated - 1, 0)), w rising from 0 at the crown to 1 in the sidewall."""

    name: ClassVar[str] = "under-inflation-flexing"
    family: ClassVar[str] = "heat"
    sentence: ClassVar[str] = (
        "Beyond its rated deflection a tyre flexes more at shoulder and sidewall than the two arcs say."
    )
    source: ClassVar[str] = (
        "Clark & Dodge 1980, summary: a seriously under-inflated tyre warms more than the theory says; estimate: "
        "linear in the excess deflection, about twice the heat at twice the rated deflection"
    )
    heat_of_temperature: ClassVar[bool] = False
    signature: ClassVar[Signature] = Signature(
        changes={"drive.load": "4000 lbf"}, words="at 4000 lbf", signs={"shoulder-inner": 1, "sidewall-inner": 1}
    )

    gain: Annotated[
        float, Prior("1", "relative heat added in the sidewall at twice the rated deflection", 1.0, 0.0, 8.0)
    ] = 0.0

    def heat_factor(self, tyre: Tyre, zone: str, x: Array, t: float, T: Array) -> Factor:
        """1 + gain w(s) times the deflection in excess of the rated one."""
        excess = deflection_ratio(tyre, t) - 1
        if excess <= 0 or tyre.region(zone) == "bead":
            return 1.0
        return 1 + self.gain * excess * beyond_shoulder(tyre, x)
