"""A thermocouple that lags more than its card says."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects._shared import OfSensor
from tyrefem.effects.effect import Prior
from tyrefem.effects.signature import Signature


class SensorLag(OfSensor):
    """lag of one sensor -> lag + slower_by."""

    name: ClassVar[str] = "sensor-lag"
    family: ClassVar[str] = "measurement"
    sentence: ClassVar[str] = "One thermocouple follows the rubber more slowly than stated."
    source: ClassVar[str] = (
        "estimate: 1 to 5 s for a bare junction in rubber, up to a minute for a sheathed one or a badly filled hole"
    )
    signature: ClassVar[Signature] = Signature(choice={"sensor": "crown-inner"}, signs={"crown-inner": -1})

    slower_by: Annotated[float, Prior("s", "added to the sensor's time constant", 15.0, 0.0, 300.0)] = 0.0

    def lag_addend(self, sensor: str) -> float:
        """s added to the sensor's lag."""
        return self.slower_by if sensor == self.sensor else 0.0
