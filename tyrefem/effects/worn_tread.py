"""A tread that is worn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, ClassVar

from tyrefem.effects.effect import Effect, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import StudyOfTyre

if TYPE_CHECKING:
    from tyrefem.geometry import Section


class WornTread(Effect):
    """thickness of the tread -> thickness (1 - fraction); the meridian and the carcass stay where they are."""

    name: ClassVar[str] = "worn-tread"
    family: ClassVar[str] = "section"
    sentence: ClassVar[str] = "The tread is thinner than the section says."
    source: ClassVar[str] = (
        "estimate: tyres are tested new to worn to the base of the grooves, about half of the tread layer"
    )
    free_rolling: ClassVar[bool] = False
    signature: ClassVar[Signature] = Signature(
        changes={
            "sensors.surface": {"s": "0.30 in", "depth": "0.55 in"},
            "sensors.shoulder-edge": {"s": "1.80 in", "depth": "0.40 in"},
        },
        words="with two more thermocouples in the tread",
        signs={"shoulder-outer": -1, "shoulder-edge": -1},
    )

    fraction: Annotated[float, Prior("1", "part of the tread layer's thickness that is gone", 0.25, 0.0, 0.8)] = 0.0

    def worn(self, section: Section) -> Section:
        """The section with its tread thinner."""
        return section.worn("tread", self.fraction)

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """A mesh that the user gave does not follow the section."""
        return None if study.card.mesh.file is None else "the study's mesh comes from a file and does not wear"
