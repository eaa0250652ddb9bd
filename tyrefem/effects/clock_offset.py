"""A logger whose clock is late."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects.effect import Effect, Prior
from tyrefem.effects.signature import Signature


class ClockOffset(Effect):
    """reading at t -> temperature at t + late, in every channel, contained air and rim too; held beyond the ends."""

    name: ClassVar[str] = "clock-offset"
    family: ClassVar[str] = "measurement"
    sentence: ClassVar[str] = "The logger's time zero is not the start of the drive."
    source: ClassVar[str] = "estimate: loggers started by hand are some ten seconds off"
    signature: ClassVar[Signature] = Signature(
        changes={"drive.phases.rolling.duration": "600 s"}, signs={"crown-inner": 1, "sidewall-outer": 1}
    )

    late: Annotated[float, Prior("s", "what the logger calls t was measured at t + late", 20.0, -300.0, 300.0)] = 0.0

    def clock(self) -> float:
        """s by which the logger's clock is late."""
        return self.late
