"""``mechanics.strain = "arcs"``: the NASA report's two arcs."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

from tyrefem.errors import InputError
from tyrefem.inputs.loading import LoadCase
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.arc_stiffness import arc_stiffness
from tyrefem.mechanics.arcs import Arcs
from tyrefem.mechanics.strain_laws import StrainLaw


class TwoArcStrains(StrainLaw):
    """The bias tyre of Clark & Dodge (1980): barrel deformation of two arcs."""

    name: ClassVar[str] = "arcs"
    title: ClassVar[str] = "arcs"

    def provider(self, study: StudyData) -> Callable[[LoadCase], Arcs]:
        """Raises `InputError` for a card without a modulus; its result, for a load that the arcs cannot take."""
        moduli = arc_stiffness(study)

        def cycle(case: LoadCase) -> Arcs:
            arcs = Arcs(study.section, moduli, case)
            try:
                _ = arcs.deflected if case.deflection > 0 else None
            except InputError as error:
                given = f"{case.load:.4g} N at {case.pressure / 1e3:.4g} kPa: {error.message}"
                raise InputError(given, field=error.field) from None
            return arcs

        return cycle
