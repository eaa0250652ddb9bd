"""``mechanics.strain = "given"``: strain energy given in the study by region."""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

from tyrefem.errors import InputError
from tyrefem.inputs.loading import LoadCase
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.given import Given
from tyrefem.mechanics.strain_laws import StrainLaw


class GivenEnergies(StrainLaw):
    """Energies of the table ``[mechanics.energy]``, in proportion to the deflection squared."""

    name: ClassVar[str] = "given"
    title: ClassVar[str] = "given"
    compared: ClassVar[bool] = False

    def provider(self, study: StudyData) -> Callable[[LoadCase], Given]:
        """Raises `InputError` where the section has no rating."""
        section, energy = study.section, study.card.mechanics.energy
        assert energy is not None
        if section.rating is None:
            raise InputError("the strain law 'given' needs the section's [rating]", field="section.rating")
        deflection = study.card.mechanics.load_law.deflection(energy.load, energy.pressure, section.rating)
        softened = _softened(study, energy.temperature)
        return lambda case: Given(section, energy.regions, deflection, case, softened)


def _softened(study: StudyData, given: float | None) -> dict[str, float]:
    """Region -> modulus of its compound over that at the temperature where its energy was given."""
    warm = study.temperatures
    if warm is None or given is None:
        return {}
    laws = {region: card.softening for region, card in study.materials.items()}
    return {region: law(warm[region]) / law(given) for region, law in laws.items() if law is not None}
