"""A thermocouple that is not where it should be."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects._shared import OfSensor
from tyrefem.effects.effect import Prior
from tyrefem.effects.signature import Signature


class SensorMisplaced(OfSensor):
    """place of one sensor -> place + (along, deeper), kept inside the rubber.

    ``along`` counts as s does: away from the crown on the side s > 0, towards it on the side s < 0 of a full section.
    """

    name: ClassVar[str] = "sensor-misplaced"
    family: ClassVar[str] = "measurement"
    sentence: ClassVar[str] = "One thermocouple sits millimetres from its stated place."
    source: ClassVar[str] = (
        "estimate: a drilled hole ends within 1 mm of its mark; a slipped thermocouple is 3 to 5 mm off"
    )
    signature: ClassVar[Signature] = Signature(choice={"sensor": "crown-inner"}, signs={"crown-inner": -1})

    along: Annotated[float, Prior("m", "along the meridian, towards larger s", 4e-3, -0.02, 0.02, written="mm")] = 0.0
    deeper: Annotated[float, Prior("m", "away from the inner surface", 2.5e-3, -0.01, 0.01, written="mm")] = 0.0

    def displacement(self, sensor: str) -> tuple[float, float]:
        """m along the meridian and in depth."""
        return (self.along, self.deeper) if sensor == self.sensor else (0.0, 0.0)
