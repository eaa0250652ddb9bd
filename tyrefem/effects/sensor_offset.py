"""A thermocouple that shows too much or too little."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects._shared import OfSensor
from tyrefem.effects.effect import Prior
from tyrefem.effects.signature import Signature


class SensorOffset(OfSensor):
    """reading of one sensor -> reading + too_high."""

    name: ClassVar[str] = "sensor-offset"
    family: ClassVar[str] = "measurement"
    sentence: ClassVar[str] = "One thermocouple shows too much, or too little, at any temperature."
    source: ClassVar[str] = (
        "estimate: class 1 type K is good to 1.5 K (IEC 60584-1); a bad cold junction adds some kelvins"
    )
    signature: ClassVar[Signature] = Signature(choice={"sensor": "crown-inner"}, signs={"crown-inner": 1})

    too_high: Annotated[float, Prior("delta_degC", "what the sensor shows too much", 4.0, -30.0, 30.0)] = 0.0

    def offset(self, sensor: str) -> float:
        """K that the sensor shows too much."""
        return self.too_high if sensor == self.sensor else 0.0
