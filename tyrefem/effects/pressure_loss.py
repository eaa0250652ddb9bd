"""A slow leak."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects.effect import Array, Effect, Factor, Prior
from tyrefem.effects.leak import deflection_change, no_load, of_load_law
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import StudyOfTyre, Tyre


class PressureLoss(Effect):
    """q -> q (D(p - rate t) / D(p))^2, D the deflection at the load of the drive; not in tread and bead."""

    name: ClassVar[str] = "pressure-loss"
    family: ClassVar[str] = "heat"
    sentence: ClassVar[str] = "The tyre loses air during the run, deflects more and more, and heats up."
    source: ClassVar[str] = (
        "estimate: a slow leak loses up to 1 bar in an hour (28 Pa/s); strain energy goes with the square of the "
        "deflection; pressed by finite elements at 0.8 p, D of the 22x5.5 8PR grows by 16 %, by the load law by 19 %"
    )
    heat_of_temperature: ClassVar[bool] = False
    signature: ClassVar[Signature] = Signature(signs={"crown-inner": 1, "sidewall-inner": 1})

    rate: Annotated[
        float, Prior("Pa/s", "gauge pressure lost per time, from the start", 30.0, 0.0, 1000.0, written="kPa/min")
    ] = 0.0

    def heat_factor(self, tyre: Tyre, zone: str, x: Array, t: float, T: Array) -> Factor:
        """(D'/D)^2 at the lower pressure, of which a fifth is left at least."""
        if tyre.region(zone) in ("tread", "bead"):
            return 1.0
        pressure = tyre.schedule.mean(lambda case: case.pressure, t)
        return deflection_change(tyre, t, max(1 - self.rate * t / pressure, 0.2) if pressure > 0 else 1.0) ** 2

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """A drive at a given deflection does not feel the pressure."""
        return no_load(study)

    @classmethod
    def beside_pressing(cls, study: StudyOfTyre) -> str | None:
        """The deflection of the pressed tyre is not asked."""
        return of_load_law(study)
