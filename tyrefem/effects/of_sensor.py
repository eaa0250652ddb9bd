"""What effects on a single thermocouple have in common."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field

from tyrefem.cards import Text
from tyrefem.effects.effect import Effect
from tyrefem.effects.tyre import StudyOfTyre
from tyrefem.errors import nearest


class OfSensor(Effect):
    """An effect on the thermocouple that ``sensor`` names."""

    sensor: Annotated[Text, Field(description="name of the sensor", examples=["crown-inner"])]

    @property
    def choice(self) -> dict[str, str]:
        """The sensor's name."""
        return {"sensor": self.sensor}

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """A study without sensors."""
        return None if study.sensors else "the study has no sensors"

    def problem(self, study: StudyOfTyre) -> str | None:
        """A sensor that the study does not have."""
        if self.refusal(study) is None and self.sensor not in study.sensors:
            return f"the study has no sensor '{self.sensor}'{nearest(self.sensor, study.sensors)}"
        return self.refusal(study)

    @classmethod
    def variants(cls, study: StudyOfTyre) -> tuple[Mapping[str, str], ...]:
        """One for every sensor."""
        return tuple({"sensor": name} for name in study.sensors)
