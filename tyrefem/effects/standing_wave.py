"""A standing wave behind the footprint above a critical speed."""

from __future__ import annotations

from typing import Annotated, ClassVar

import numpy as np

from tyrefem.effects.effect import Array, Effect, Factor, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import StudyOfTyre, Tyre


class StandingWave(Effect):
    """q -> q (1 + gain z log(1 + exp(u/z))), u = v/v_c - 1, z = 0.1: a smooth onset; not in the bead."""

    name: ClassVar[str] = "standing-wave"
    family: ClassVar[str] = "heat"
    sentence: ClassVar[str] = (
        "Above a critical speed a standing wave behind the footprint flexes the tyre again and again."
    )
    source: ClassVar[str] = (
        "estimate, computed by tyrefem press --critical-speed --rise: 55 m/s and gain 2.7 come nearest in the 22x5.5 "
        "at 83 psi, 41 m/s and gain 4.9 in a passenger tyre, the factor within 0.11; the onset is where the heat bends "
        "up, not the speed of the belt's wave (84, 143 m/s); heat that rises slowly below the onset is left out"
    )
    heat_of_temperature: ClassVar[bool] = False
    signature: ClassVar[Signature] = Signature(
        changes={"drive.phases.rolling.speed": "55 m/s"},
        words="at 55 m/s",
        signs={"crown-inner": 1, "shoulder-inner": 1},
    )

    #: Width of the onset over the critical speed.
    ONSET: ClassVar[float] = 0.1

    gain: Annotated[float, Prior("1", "relative heat added at twice the critical speed", 4.0, 0.0, 40.0)] = 0.0
    critical_speed: Annotated[
        float, Prior("m/s", "speed of the onset", 15.0, 15.0, 150.0, start=50.0, amplitude=False)
    ] = 50.0

    def heat_factor(self, tyre: Tyre, zone: str, x: Array, t: float, T: Array) -> Factor:
        """1 + gain times the smooth positive part of v/v_c - 1."""
        if tyre.region(zone) == "bead":
            return 1.0
        u = (tyre.speed(t) / self.critical_speed - 1) / self.ONSET
        return 1 + self.gain * self.ONSET * float(np.logaddexp(0.0, u))

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """Strain cycles of the rolling tyre rise towards the critical speed themselves."""
        if study.card.mechanics.rolling:
            return "the strain cycles have the rolling tyre's inertia already: mechanics.rolling"
        return None
