"""``mechanics.strain = "barrel"``: all meridians have the same deflection, by finite elements."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

from tyrefem.inputs.loading import LoadCase
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.strain_cycle import StrainCycle
from tyrefem.mechanics.strain_laws import StrainLaw


class BarrelByElements(StrainLaw):
    """The inflated tyre pressed inside a rigid cylinder, as the report assumes."""

    name: ClassVar[str] = "barrel"
    title: ClassVar[str] = "barrel FEM"
    by_elements: ClassVar[bool] = True
    assumption: ClassVar[tuple[str, str]] = (
        "The same deflection of all meridians, by finite elements",
        "The section is inflated in large displacement and the whole tyre pressed inside a rigid cylinder, as the "
        "report assumes: each hoop is shortened, none is bent flat. Nothing of it is compared with a measured tyre.",
    )

    def provider(self, study: StudyData) -> Callable[[LoadCase], StrainCycle]:
        """As `tyrefem.mechanics.barrel.provider`."""
        from tyrefem.mechanics.barrel import provider

        return provider(study)
