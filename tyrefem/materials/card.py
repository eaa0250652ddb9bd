"""Material cards: conductivity, heat capacity, stiffness and loss tangent, each with unit and source."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar

from tyrefem.cards import Card, Temperature, Text
from tyrefem.cards.plausible import EXPANSION, PLY_SHEAR_MODULUS, SHEAR_MODULUS, YOUNGS_MODULUS
from tyrefem.materials.elasticity import Cords, Elasticity
from tyrefem.materials.fatigue import Fatigue
from tyrefem.materials.law_of_card import LawOfCard
from tyrefem.materials.properties import Softening, Sourced
from tyrefem.materials.road_friction import FRICTION, FrictionOnRoad, RoadFriction
from tyrefem.materials.strain_dependence import StrainDependence
from tyrefem.materials.tan_delta_card import TAN_DELTA, LossTangent
from tyrefem.materials.tan_delta_law import TanDeltaLaw
from tyrefem.materials.thermal_properties import Conductivity, Density, SpecificHeat
from tyrefem.materials.wear import Wear
from tyrefem.quantity import Unit


class ShearModulus(Sourced):
    """G of a compound, Pa."""

    value: Annotated[float, Unit("Pa", gt=0), SHEAR_MODULUS]


class YoungsModulus(Sourced):
    """E of bead wires or of a compound, Pa."""

    value: Annotated[float, Unit("Pa", gt=0), YOUNGS_MODULUS]


class Cord(Sourced):
    """Bias plies: crown angle to the circumference, and the in-plane shear modulus of the ply pair."""

    crown_angle: Annotated[float, Unit("rad", gt=0, le=1.5708)] | None = None
    ply_shear_modulus: Annotated[float, Unit("Pa", gt=0), PLY_SHEAR_MODULUS] | None = None
    softening: Softening | None = None

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """The modulus; an angle has no relative standard deviation."""
        return (("ply_shear_modulus",),)


class ThermalExpansion(Sourced):
    """Linear expansion of the compound, and of its cords along themselves, from the stress-free temperature."""

    coefficient: Annotated[float, Unit("1/delta_degC", ge=0, le=1e-3), EXPANSION]
    cords: Annotated[float, Unit("1/delta_degC", ge=-1e-4, le=1e-3)] = 0.0
    stress_free: Temperature = 25.0

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """Compound and cords expand independently."""
        return ("coefficient",), ("cords",)


class MaterialCard(Card):
    """One compound or composite. Read with `material`.

    ``softening`` applies to all moduli of the compound; cords have a table of softening too, or do not soften.
    ``strain_dependence`` applies to the compound's shear modulus and loss; cords do not depend on strain.
    ``loss_tangent``: tan delta, by a shipped law or your own. ``friction``: of the tread on the road, likewise.
    """

    kind: ClassVar[str] = "material"
    title: Text
    notes: str = ""
    conductivity: Conductivity
    density: Density
    specific_heat: SpecificHeat
    loss_tangent: Annotated[TanDeltaLaw, LawOfCard(TAN_DELTA, TanDeltaLaw, LossTangent)]
    shear_modulus: ShearModulus | None = None
    youngs_modulus: YoungsModulus | None = None
    cord: Cord | None = None
    elasticity: Elasticity | None = None
    cords: Cords | None = None
    softening: Softening | None = None
    strain_dependence: StrainDependence | None = None
    expansion: ThermalExpansion | None = None
    fatigue: Fatigue | None = None
    wear: Wear | None = None
    friction: Annotated[FrictionOnRoad, LawOfCard(FRICTION, FrictionOnRoad, RoadFriction)] | None = None

    @property
    def softens(self) -> bool:
        """True if a modulus depends on temperature."""
        return any(part is not None and part.softening is not None for part in (self, self.cord, self.cords))

    def warmed(self, temperature: float) -> MaterialCard:
        """The card with its moduli at a temperature, degC."""
        changes: dict[str, Any] = {}
        if self.softening is not None:
            factor = self.softening(temperature)
            for name in ("shear_modulus", "youngs_modulus"):
                if (modulus := getattr(self, name)) is not None:
                    changes[name] = modulus.model_copy(update={"value": factor * modulus.value})
            if self.elasticity is not None:
                changes["elasticity"] = self.elasticity.times(factor)
        if self.cord is not None and self.cord.softening is not None and self.cord.ply_shear_modulus is not None:
            softened = self.cord.softening(temperature) * self.cord.ply_shear_modulus
            changes["cord"] = self.cord.model_copy(update={"ply_shear_modulus": softened})
        if self.cords is not None and self.cords.softening is not None:
            changes["cords"] = self.cords.times(self.cords.softening(temperature))
        return self.model_copy(update=changes) if changes else self

    def at_amplitude(self, amplitude: float) -> MaterialCard:
        """The same compound with its shear modulus at another shear strain amplitude.

        A card without ``strain_dependence`` is returned as it is. The loss modulus at every amplitude stays the same.
        """
        law = self.strain_dependence
        if law is None:
            return self
        factor = float(law.stiffening(amplitude))
        changes: dict[str, Any] = {"strain_dependence": law.at_modulus_amplitude(amplitude)}
        if self.shear_modulus is not None:
            value = factor * self.shear_modulus.value
            changes["shear_modulus"] = self.shear_modulus.model_copy(update={"value": value})
        if self.elasticity is not None:
            changes["elasticity"] = self.elasticity.times(factor)
        return self.model_copy(update=changes)

    def heat_capacity(self) -> Any:
        """Volumetric heat capacity rho c, J/m3/K: a number or a function of temperature."""
        density, specific = self.density.law(), self.specific_heat.law()
        if not callable(density) and not callable(specific):
            return density * specific
        return lambda temperature: (
            (density(temperature) if callable(density) else density)
            * (specific(temperature) if callable(specific) else specific)
        )


def material(reference: object, near: Path | None = None) -> MaterialCard:
    """The material card of a name, path or ``{base = NAME, ...}``.

    >>> float(material("nasa-tread").loss_tangent(25.0))
    0.2
    """
    from tyrefem import library

    data, path, _ = library.load("material", reference, near)
    return MaterialCard.check(data, path)


def strain_laws(cards: Mapping[str, MaterialCard]) -> dict[str, StrainDependence]:
    """Region -> moduli over strain, of the cards that have them."""
    return {region: card.strain_dependence for region, card in cards.items() if card.strain_dependence is not None}
