"""Water on the road."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.effects.effect import Effect, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import Tyre


class WetRoad(Effect):
    """H_c -> H_c (1 + film_gain);  h of the rolling tread between two contacts -> h (1 + 2.8 film_gain)."""

    name: ClassVar[str] = "wet-road"
    family: ClassVar[str] = "boundary"
    of_the_day: ClassVar[bool] = True
    of_drive: ClassVar[bool] = True
    sentence: ClassVar[str] = (
        "Water improves the contact with the road and wets the tread, which evaporation then cools."
    )
    source: ClassVar[str] = (
        "estimate: water in the road texture about doubles H_c (film_gain 1); evaporation adds 2.8 times the dry "
        "film, by the Lewis relation L/c_p dw/dT with 1.2e-3 1/K at 25 degC"
    )
    signature: ClassVar[Signature] = Signature(
        changes={"boundaries.road": {"law": "constant", "coefficient": "500 W/m**2/K"}},
        words="with a constant road film of 500 W/m²/K",
        signs={"surface": -1},
    )

    #: Evaporation over convection, per kelvin of a wet surface: 2.45e6/1005 J/kg over J/kg/K times dw/dT = 1.16e-3 1/K.
    EVAPORATION: ClassVar[float] = 2.8

    film_gain: Annotated[float, Prior("1", "relative rise of the road film; 1 for a wet road", 1.0, 0.0, 8.0)] = 0.0

    def film_factor(self, tyre: Tyre, film: str, t: float) -> float:
        """1 + film_gain on the road, 1 + 2.8 film_gain on the tread between two contacts; at rest the tread dries."""
        if tyre.speed(t) == 0:
            return 1.0
        return 1 + self.film_gain * {"road": 1.0, "tread_air": self.EVAPORATION}.get(film, 0.0)
