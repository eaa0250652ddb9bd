"""A wheel that leans."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar

import numpy as np

from tyrefem.effects._shared import half_width, needs_full
from tyrefem.effects.effect import Array, Effect, Factor, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import StudyOfTyre, Tyre


class Camber(Effect):
    """q -> q (1 + z_s tan(angle) / D)^2, z_s = z within the shoulders; not in the bead."""

    name: ClassVar[str] = "camber"
    family: ClassVar[str] = "asymmetry"
    sentence: ClassVar[str] = "The wheel leans, so that one shoulder deflects more than the other."
    source: ClassVar[str] = (
        "estimate: each side deflects by D + z_s tan(angle), strain energy goes with its square; alignment is good "
        "to a degree or two; beside rolling with friction the belt's edges are within 30 % to 4 degrees "
        "(docs/evidence/rolling-friction.md)"
    )
    heat_of_temperature: ClassVar[bool] = False
    free_rolling: ClassVar[bool] = False
    signature: ClassVar[Signature] = Signature(
        changes={"mesh.section": "full", "sensors.shoulder-left": {"s": "-2.00 in", "depth": "0.07 in"}},
        words="on the full section, with a thermocouple in both shoulders",
        signs={"shoulder-inner": 1, "sidewall-inner": 1, "shoulder-left": -1},
    )

    angle: Annotated[
        float,
        Prior(
            "rad",
            "camber; positive presses the side z > 0",
            math.radians(2),
            -0.25,
            0.25,
            written="deg",
        ),
    ] = 0.0

    def heat_factor(self, tyre: Tyre, zone: str, x: Array, t: float, T: Array) -> Factor:
        """The square of the local deflection over the mean one."""
        deflection = tyre.schedule.mean(lambda case: case.deflection, t)
        if deflection <= 0 or tyre.region(zone) == "bead":
            return 1.0
        lateral = np.clip(x[1], *half_width(tyre))
        return np.asarray(np.maximum(1 + lateral * math.tan(self.angle) / deflection, 0.0) ** 2)

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """A half section has one side only."""
        return needs_full(study)
