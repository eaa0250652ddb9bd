"""A brake that puts heat into a lumped rim."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects._shared import needs_lumped_rim
from tyrefem.effects.effect import Effect, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import StudyOfTyre, Tyre


class BrakePower(Effect):
    """C dT_rim/dt -> C dT_rim/dt + power, while the wheel turns."""

    name: ClassVar[str] = "brake-power"
    family: ClassVar[str] = "boundary"
    of_drive: ClassVar[bool] = True
    sentence: ClassVar[str] = "The brake puts heat into the rim while the wheel turns."
    source: ClassVar[str] = (
        "estimate: a dragging brake of 0.1 % of 12 kN at 9 m/s makes 100 W; braking at 0.03 g some kW"
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

    power: Annotated[float, Prior("W", "heat into the whole wheel while it turns", 200.0, 0.0, 2e4)] = 0.0

    def rim_power(self, tyre: Tyre, t: float) -> float:
        """W into the rim."""
        return self.power if tyre.motion(t).rolling_speed > 0 else 0.0

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """Only a lumped rim takes up heat."""
        return needs_lumped_rim(study)
