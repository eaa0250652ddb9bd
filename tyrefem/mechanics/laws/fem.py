"""``mechanics.strain = "fem"``: the footprint by finite elements."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, ClassVar

from tyrefem.inputs.loading import LoadCase
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.strain_laws import StrainLaw

if TYPE_CHECKING:
    from tyrefem.mechanics.finite_elements import FiniteElements


class FootprintByElements(StrainLaw):
    """The tyre inflated in large displacement, and pressed on the road by Fourier harmonics."""

    name: ClassVar[str] = "fem"
    title: ClassVar[str] = "footprint FEM"
    by_elements: ClassVar[bool] = True
    presses: ClassVar[bool] = True
    assumption: ClassVar[tuple[str, str]] = (
        "A footprint without friction",
        "The section is inflated and pressed on the road by Fourier harmonics in large motion: without friction and "
        "inertia. The contact and the strains of a revolution are computed, not assumed.",
    )

    def assumption_of(self, study: StudyData) -> tuple[str, str]:
        """Large motion, or the linear one with what it leaves out."""
        if study.card.boundaries.sliding.rolls:
            large = study.card.mechanics.motion == "large"
            state = "its footprint in large motion" if large else "the inflated tyre"
            return (
                "A footprint with friction",
                f"The section is inflated and rolls with stick and slip, by Fourier harmonics. The forces of friction "
                f"move it in small motion from {state}.",
            )
        if study.card.mechanics.rolling:
            return (
                "A footprint that turns without friction",
                "The section is inflated, spun and pressed on the road by Fourier harmonics with inertia, without "
                "friction. In linear motion the strains lag by their loss.",
            )
        if study.card.mechanics.motion == "large":
            return self.assumption
        return (
            "A small deflection about the inflated tyre",
            "The section is inflated in large displacement and pressed on the road by Fourier harmonics of small "
            "motion about that state, without friction. Rotations under the footprint are not small: the tyre is too "
            'stiff and its strains too large. mechanics.motion = "large" computes them.',
        )

    def provider(self, study: StudyData) -> Callable[[LoadCase], FiniteElements]:
        """As `tyrefem.mechanics.finite_elements.provider`."""
        from tyrefem.mechanics.finite_elements import provider

        return provider(study)
