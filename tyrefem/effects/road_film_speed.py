"""A road film that rises with speed where the study has it constant."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects._shared import speed_ratio
from tyrefem.effects.effect import Effect, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import StudyOfTyre, Tyre


class RoadFilmSpeed(Effect):
    """H_c -> H_c (v / v_ref)^exponent, v_ref = 10 m/s."""

    name: ClassVar[str] = "road-film-speed"
    family: ClassVar[str] = "boundary"
    of_drive: ClassVar[bool] = True
    sentence: ClassVar[str] = "The film between tread and road rises with speed, as each contact is shorter."
    source: ClassVar[str] = (
        "Cattani et al. 2023, eq 12: H_c = sqrt(lambda C v / FL), an exponent of 0.5; Clark & Dodge 1980 have one "
        "film for all speeds"
    )
    signature: ClassVar[Signature] = Signature(
        changes={
            "drive.phases.rolling.speed": "30 m/s",
            "boundaries.road": {"law": "constant", "coefficient": "500 W/m**2/K"},
        },
        words="at 30 m/s with a constant road film of 500 W/m²/K",
        signs={"surface": -1},
    )

    exponent: Annotated[float, Prior("1", "exponent of speed in the road film", 0.5, 0.0, 1.5)] = 0.0

    def film_factor(self, tyre: Tyre, film: str, t: float) -> float:
        """(v / v_ref)^exponent on the road film."""
        return float(speed_ratio(tyre, t) ** self.exponent) if film == "road" else 1.0

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """A law that has the speed in it already."""
        law = study.card.boundaries.road.law
        return None if law == "constant" else f"the road's law '{law}' has the speed in it already"
