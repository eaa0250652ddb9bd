"""``[fatigue]`` of a material card: growth of a small crack in the compound."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import model_validator

from tyrefem.cards import Temperature
from tyrefem.cards.plausible import CRACK, GROWTH_RATE, TEARING_ENERGY
from tyrefem.errors import InputError
from tyrefem.materials.properties import Sourced
from tyrefem.quantity import Unit


class Fatigue(Sourced):
    """Crack growth of a compound by Thomas' law, dc/dN = r_c (T/T_c)^F exp(b (temperature - reference)).

    Parameters
    ----------
    tearing_energy : T_c, at which the compound tears, J/m2. growth_rate : r_c, growth per cycle at T_c, m.
    exponent : F. flaw, crack : c_0 and c_1, m; growth from one to the other is the life.
    threshold : T_0, J/m2; a flaw with less does not grow. 0: the law goes on to any small T, and lives are too short.
    temperature_rate : b, 1/K. reference : temperature of r_c, degC.
    crystallising : True where the stretched rubber crystallises (natural rubber). A cycle that does not return to zero,
        R = T_min/T_max > 0, then has the exponent F exp(ratio_rate R) (Mars & Fatemi 2003). Other rubber has
        T = T_max - T_min in place of T_max.

    Raises
    ------
    InputError : a number out of range; a crack that is not longer than the flaw; ``ratio_rate`` without crystallising.

    >>> Fatigue.check({"tearing_energy": "10 kJ/m**2", "growth_rate": "10 um", "exponent": 2,
    ...     "source": "estimate: example"}).tearing_energy
    10000.0
    """

    tearing_energy: Annotated[float, Unit("J/m**2", gt=0, le=1e7), TEARING_ENERGY]
    growth_rate: Annotated[float, Unit("m", gt=0, le=1.0), GROWTH_RATE]
    exponent: Annotated[float, Unit("1", gt=0, le=20)]
    flaw: Annotated[float, Unit("m", gt=0, le=0.1), CRACK] = 30e-6
    crack: Annotated[float, Unit("m", gt=0, le=1.0), CRACK] = 1e-3
    threshold: Annotated[float, Unit("J/m**2", ge=0, le=1e6)] = 0.0
    temperature_rate: Annotated[float, Unit("1/delta_degC", ge=0, le=0.5)] = 0.0
    reference: Temperature = 23.0
    crystallising: bool = False
    ratio_rate: Annotated[float, Unit("1", ge=0, le=20)] = 0.0

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.crack <= self.flaw:
            raise InputError(
                f"must be longer than the flaw ({self.flaw * 1e6:.4g} um), not {self.crack * 1e6:.4g} um", field="crack"
            )
        if self.ratio_rate and not self.crystallising:
            raise InputError("is only for rubber with crystallising = true", field="ratio_rate")
        return self

    @model_validator(mode="after")
    def _growing(self) -> Self:
        if self.threshold >= self.tearing_energy:
            raise InputError(
                f"must be less than the tearing energy ({self.tearing_energy:.4g} J/m2), not {self.threshold:.4g} J/m2",
                field="threshold",
            )
        return self

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """None: temperatures do not depend on the table."""
        return ()
