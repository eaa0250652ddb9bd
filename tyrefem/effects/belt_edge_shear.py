"""Shear between the plies, or at the belt edges, where tread and carcass meet at the shoulder."""

from __future__ import annotations

from typing import Annotated, ClassVar

import numpy as np

from tyrefem.cache import Cache, Content
from tyrefem.effects._shared import deflection_ratio, no_carcass
from tyrefem.effects.effect import Array, Effect, Factor, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import StudyOfTyre, Tyre

#: Extents by section and points: a simulation asks for the same few at every step.
_EXTENTS: Cache[Array] = Cache(size=64)


class BeltEdgeShear(Effect):
    """q -> q + loss (v / 2 pi r_r) (D/D_rated)^2 exp(-((s - s_0)/8 mm)^2/2 - (y/2.5 mm)^2/2).

    s_0 is 0.95 of the shoulder's station, y the distance from the border between carcass and rubber.
    """

    name: ClassVar[str] = "belt-edge-shear"
    family: ClassVar[str] = "heat"
    sentence: ClassVar[str] = "Plies or belt edges shear against each other under the shoulder."
    source: ClassVar[str] = (
        "estimate, as is the extent: 2e4 J/m3 per revolution = pi G gamma^2 tan(delta) with G = 2.3 MPa, "
        "tan(delta) = 0.1, interply shear strain gamma = 0.17 (textbooks: 0.1 to 0.2)"
    )
    heat_of_temperature: ClassVar[bool] = False
    signature: ClassVar[Signature] = Signature(signs={"shoulder-inner": 1, "shoulder-outer": 1})

    #: Extent (standard deviations) along the meridian and across the plies, m; centre over the shoulder's station.
    ALONG: ClassVar[float] = 8e-3
    ACROSS: ClassVar[float] = 2.5e-3
    CENTRE: ClassVar[float] = 0.95

    loss: Annotated[
        float,
        Prior(
            "J/m**3",
            "energy lost per revolution at the rated deflection, at the centre",
            2e4,
            0.0,
            4e5,
            written="kJ/m**3",
        ),
    ] = 0.0

    def heat_addend(self, tyre: Tyre, zone: str, x: Array, t: float, T: Array) -> Factor:
        """Loss per revolution times revolutions per second, around the end of the tread-carcass border."""
        if tyre.region(zone) == "bead":
            return 0.0
        here = _EXTENTS.get((tyre.study.section, Content.of(x)), lambda: self._extent(tyre, x))
        lost = self.loss * tyre.motion(t).revolutions_per_second
        return np.asarray(lost * deflection_ratio(tyre, t) ** 2 * here)

    def _extent(self, tyre: Tyre, x: Array) -> Array:
        """(n,) share of the loss at points x (2, n): a Gaussian about the end of the tread-carcass border."""
        section, (s, depth) = tyre.study.section, tyre.places(x)
        along = (s - self.CENTRE * section.line.shoulder_s) / self.ALONG
        across = (section.midline_offset(s, depth) - section.thickness("carcass", s) / 2) / self.ACROSS
        return np.asarray(np.exp(-(along**2 + across**2) / 2))

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """The place is measured from the region 'carcass'."""
        return no_carcass(study)
