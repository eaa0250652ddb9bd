"""A wheel that runs at a slip angle."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from tyrefem.effects._shared import half_width, needs_full, sliding_flux
from tyrefem.effects.effect import Array, Effect, Factor, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import StudyOfTyre, Tyre


class Yaw(Effect):
    """Flux into the tread as of `tread-slip`, times 1 + z_s / z_shoulder towards the loaded side.

    ``right`` is the side z > 0, as a section is drawn; seen along the way it is the wheel's left (`tyrefem roll`).
    """

    name: ClassVar[str] = "yaw"
    family: ClassVar[str] = "asymmetry"
    sentence: ClassVar[str] = "The wheel runs at a slip angle: the tread scrubs sideways, most on the loaded side."
    source: ClassVar[str] = (
        "Roberts as for tread-slip; estimate: friction rises linearly from shoulder to shoulder; full sliding at 1 "
        "degree is 1.7 % of the speed; beside rolling with friction its heat is 2.7 times too large at 1 degree, right "
        "near 3 and 0.6 of it at 6, and the hysteresis of cornering is missing (docs/evidence/rolling-friction.md)"
    )
    free_rolling: ClassVar[bool] = False
    signature: ClassVar[Signature] = Signature(
        changes={"mesh.section": "full", "sensors.shoulder-left": {"s": "-2.00 in", "depth": "0.07 in"}},
        words="on the full section, with a thermocouple in both shoulders",
        choice={"side": "right"},
        signs={"shoulder-edge": 1},
    )

    surfaces: ClassVar[tuple[str, ...]] = ("road",)

    side: Annotated[Literal["left", "right"], Field(description="loaded side as drawn: right is z > 0")] = "right"
    slip: Annotated[float, Prior("1", "sideways sliding speed over the tyre's speed", 0.01, 0.0, 0.2)] = 0.0

    def flux(self, tyre: Tyre, surface: str, x: Array, t: float) -> Factor:
        """W/m2 into the tread; ``right`` is z > 0."""
        low, high = half_width(tyre)
        lateral = np.clip(x[1], low, high) / high * (1 if self.side == "right" else -1)
        return np.asarray(self.slip * sliding_flux(tyre, t) * (1 + lateral))

    @property
    def choice(self) -> dict[str, str]:
        """The loaded side."""
        return {"side": self.side}

    @classmethod
    def variants(cls, study: StudyOfTyre) -> tuple[Mapping[str, str], ...]:
        """Either side."""
        return {"side": "left"}, {"side": "right"}

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """A half section has one side only."""
        return needs_full(study)
