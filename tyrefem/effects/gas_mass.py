"""The gas's mass at its real pressure."""

from __future__ import annotations

from typing import Annotated, ClassVar

from tyrefem.boundaries.contained_air import Gas
from tyrefem.effects.effect import Effect, Prior
from tyrefem.effects.signature import Signature
from tyrefem.effects.tyre import StudyOfTyre, Tyre


class GasMass(Effect):
    """C -> C (1 + fraction (C_gas / C - 1)), C_gas = p V c_v / (R T) of the real gas."""

    name: ClassVar[str] = "gas-mass"
    family: ClassVar[str] = "boundary"
    sentence: ClassVar[str] = "The contained air is denser than the report's 1 atm, so it warms more slowly."
    source: ClassVar[str] = (
        "Clark & Dodge 1980, appendix I: 0.0013 g/cm3 at any pressure; an ideal gas at 83 psi gauge has 6.6 times "
        "as much"
    )
    signature: ClassVar[Signature] = Signature(
        changes={"boundaries.contained_air": {"law": "report"}},
        words="with the report's air",
        signs={"contained-air": -1},
    )

    fraction: Annotated[
        float, Prior("1", "0: the report's air at 1 atm; 1: the gas at its pressure", 1.0, 0.0, 3.0)
    ] = 0.0

    def gas_capacity_factor(self, tyre: Tyre) -> float:
        """1 + fraction (C_gas / C_report - 1)."""
        air = tyre.study.card.boundaries.contained_air
        start = tyre.drive.initial if air.initial is None else air.initial
        state = (1.0, tyre.drive.phases[0].pressure.start, start)
        report, gas = air.heat_capacity(*state), Gas(law="gas").heat_capacity(*state)
        assert report is not None
        return 1 + self.fraction * (gas / report - 1)

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """Where the air is not the report's."""
        law = study.card.boundaries.contained_air.law
        return None if law == "report" else f"the contained air's law is '{law}', not 'report'"
