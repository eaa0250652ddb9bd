"""Two thermocouples recorded under each other's name."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Annotated, ClassVar

from pydantic import Field

from tyrefem.cards import Text
from tyrefem.effects.effect import Effect
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import StudyOfTyre
from tyrefem.errors import nearest


class SwappedChannels(Effect):
    """The column ``sensor`` holds what ``other`` measured, and the reverse. There or not: it has no amplitude."""

    name: ClassVar[str] = "swapped-channels"
    family: ClassVar[str] = "measurement"
    sentence: ClassVar[str] = "Two thermocouples are plugged into each other's channels."
    source: ClassVar[str] = "estimate: the commonest mistake at a patch panel with many thermocouples"
    signature: ClassVar[Signature] = Signature(
        choice={"sensor": "crown-inner", "other": "sidewall-inner"}, signs={"crown-inner": -1, "sidewall-inner": 1}
    )

    sensor: Annotated[Text, Field(description="name of the sensor", examples=["crown-inner"])]
    other: Annotated[Text, Field(description="name of the other sensor", examples=["crown-middle"])]

    def channel(self, sensor: str) -> str:
        """The sensor whose temperature is recorded under a sensor's name."""
        return {self.sensor: self.other, self.other: self.sensor}.get(sensor, sensor)

    @property
    def choice(self) -> dict[str, str]:
        """The two sensors' names."""
        return {"sensor": self.sensor, "other": self.other}

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """Fewer than two sensors."""
        return None if len(study.sensors) > 1 else "needs two sensors in the study"

    def problem(self, study: StudyOfTyre) -> str | None:
        """A sensor that the study does not have, one swapped with itself, or one swapped twice."""
        for name in (self.sensor, self.other):
            if len(study.sensors) > 1 and name not in study.sensors:
                return f"the study has no sensor '{name}'{nearest(name, study.sensors)}"
        if self.sensor == self.other:
            return f"'{self.sensor}' is swapped with itself; name two sensors"
        taken = _swapped(study, self.runs)
        twice = [name for name in (self.sensor, self.other) if taken.count(name) > 1]
        return f"'{twice[0]}' is swapped twice" if twice else self.refusal(study)

    @classmethod
    def variants(cls, study: StudyOfTyre) -> tuple[Mapping[str, str], ...]:
        """Every pair of the sensors that the study does not swap already."""
        taken = _swapped(study)
        free = [sensor for sensor in study.sensors if sensor not in taken]
        return tuple({"sensor": sensor, "other": other} for sensor, other in itertools.combinations(free, 2))


def _swapped(study: StudyOfTyre, runs: tuple[str, ...] | None = None) -> list[str]:
    """The sensors of all swaps in a study that act in some of these runs; None: in any."""
    every = [swap for swap in study.card.effects if isinstance(swap, SwappedChannels)]
    swaps = [swap for swap in every if runs is None or swap.runs is None or set(runs) & set(swap.runs)]
    return [name for swap in swaps for name in (swap.sensor, swap.other)]
