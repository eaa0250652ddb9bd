"""A brake disc that stores heat and gives it to a lumped rim, also when the wheel stands."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar

from tyrefem.effects._shared import needs_lumped_rim
from tyrefem.effects.effect import Effect, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.state import EffectState, TemperaturesOfTyre, Values
from tyrefem.effects.tyre import StudyOfTyre, Tyre


class BrakeDisc(Effect):
    """m c dT_d/dt = power - (G + UA) T_d;  rim: C dT_rim/dt -> C dT_rim/dt + G T_d.

    T_d: what braking warms the disc by, above rim and air, whose own warming is neglected beside it.
    """

    name: ClassVar[str] = "brake-disc"
    family: ClassVar[str] = "boundary"
    sentence: ClassVar[str] = "The brake disc stores heat and warms the rim long after the wheel has stopped."
    source: ClassVar[str] = (
        "Limpert, Brake Design and Safety, 2nd ed., 1999, chapter 3: a disc of one temperature; estimate: 8 kg of "
        "cast iron, 0.2 m2 at 25 W/m2/K, half as much into the rim"
    )
    free_rolling: ClassVar[bool] = False
    signature: ClassVar[Signature] = Signature(
        changes={
            "sensors.bead": {"s": "5.6 in", "depth": "0.3 in"},
            "boundaries.rim": {"law": "lumped", "mass": "9 kg", "cooling": "2 W/K", "air": "0.5 W/K"},
        },
        words="with a bead thermocouple and a lumped rim of 9 kg",
        signs={"rim": 1, "bead": 1},
    )
    states: ClassVar[Mapping[str, EffectState]] = {
        "disc": EffectState("delta_degC", "what braking warms the disc by"),
    }

    #: Specific heat of cast iron, J/kg/K, and conductance of the disc to the air, W/K.
    SPECIFIC_HEAT: ClassVar[float] = 460.0
    TO_AIR: ClassVar[float] = 5.0

    power: Annotated[float, Prior("W", "heat of braking while the wheel turns", 500.0, 0.0, 1e5)] = 0.0
    mass: Annotated[float, Prior("kg", "mass of the disc", 4.0, 1.0, 100.0, start=8.0, amplitude=False)] = 8.0
    to_rim: Annotated[
        float, Prior("W/K", "conductance from disc to rim", 1.5, 0.2, 50.0, start=2.5, amplitude=False)
    ] = 2.5

    def state_rates(self, tyre: Tyre, t: float, state: Values, temperatures: TemperaturesOfTyre) -> Values:
        """K/s: braking less what goes to rim and air."""
        braking = self.power if tyre.motion(t).rolling_speed > 0 else 0.0
        lost = (self.to_rim + self.TO_AIR) * state["disc"]
        return {"disc": (braking - lost) / (self.mass * self.SPECIFIC_HEAT)}

    def rim_power(self, tyre: Tyre, t: float) -> float:
        """W from the disc into the rim."""
        return self.to_rim * float(tyre.state(self, "disc", t))

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """Only a lumped rim takes up heat."""
        return needs_lumped_rim(study)
