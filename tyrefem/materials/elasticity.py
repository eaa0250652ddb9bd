"""Stiffness on a material card: the rubber's strain-energy law, and the cords of cord-rubber layers."""

from __future__ import annotations

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from tyrefem.cards import Card, PositiveLength, Text
from tyrefem.cards.plausible import CORD_DIAMETER, CORD_ENDS, CORD_MODULUS, LOSS_TANGENT, SHEAR_MODULUS
from tyrefem.errors import InputError, InputWarning
from tyrefem.materials.properties import Softening
from tyrefem.quantity import Unit

Modulus = Annotated[float, Unit("Pa", gt=0, le=1e12)]
Constant = Annotated[float, Unit("Pa", ge=-1e9, le=1e9)]
#: Largest volume fraction of round cords side by side in layers (pi / (2 sqrt 3)).
DENSEST = math.pi / (2 * math.sqrt(3))
#: Default of bulk modulus over shear modulus.
BULK_RATIO = 100.0
#: Smallest angle to the circumference of cords that are lifted, rad.
FLATTEST = 1e-6
#: Constants of the strain-energy laws proportional to the shear modulus.
SHEAR_CONSTANTS = ("shear_modulus", "c10", "c01", "c20", "c30")


class RubberLaw(Card):
    """Common part of strain-energy laws; subclasses add the constants. Default of the bulk modulus: 100 G."""

    bulk_modulus: Modulus | None = None
    source: Text
    relative_sd: Annotated[float, Unit("1", ge=0, lt=1)] | None = None

    @property
    def initial_shear_modulus(self) -> float:
        """G at small strain [Pa]."""
        raise AttributeError("a law without constants has no shear modulus")

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """Fields of ``relative_sd``: all shear constants have one factor; a given bulk modulus does not change."""
        return (SHEAR_CONSTANTS,)

    @property
    def bulk(self) -> float:
        """kappa [Pa]: the card's, or 100 times the shear modulus."""
        return self.bulk_modulus or BULK_RATIO * self.initial_shear_modulus

    def warnings(self) -> tuple[InputWarning, ...]:
        """An unlikely shear modulus, computed from the constants."""
        field = "shear_modulus" if hasattr(self, "shear_modulus") else "c10"
        return super().warnings() + tuple(filter(None, [SHEAR_MODULUS.warning(self.initial_shear_modulus, field)]))

    def times(self, factor: float) -> Self:
        """The law with all shear constants times a factor; a given bulk modulus does not change."""
        names = [name for name in SHEAR_CONSTANTS if hasattr(self, name)]
        return self.model_copy(update={name: factor * getattr(self, name) for name in names})

    @model_validator(mode="after")
    def _check_bulk_modulus(self) -> Self:
        if self.bulk_modulus is not None and self.bulk_modulus < 10 * self.initial_shear_modulus:
            raise InputError(
                f"must be 10 times the shear modulus ({self.initial_shear_modulus:.3g} Pa) or more: rubber is nearly"
                " incompressible",
                field="bulk_modulus",
            )
        return self


class NeoHookean(RubberLaw):
    """W = G/2 (I1 - 3): one number, the ``shear_modulus`` G [Pa].

    >>> rubber = NeoHookean.check({"law": "neo-hookean", "shear_modulus": "1.5 MPa", "source": "estimate: example"})
    >>> rubber.initial_shear_modulus, rubber.bulk
    (1500000.0, 150000000.0)
    """

    law: Literal["neo-hookean"]
    shear_modulus: Modulus

    @property
    def initial_shear_modulus(self) -> float:
        """G at small strain [Pa]."""
        return self.shear_modulus


class MooneyRivlin(RubberLaw):
    """W = C10 (I1 - 3) + C01 (I2 - 3), constants in Pa; G = 2 (C10 + C01)."""

    law: Literal["mooney-rivlin"]
    c10: Constant
    c01: Constant

    @model_validator(mode="after")
    def _stable(self) -> Self:
        if self.c10 + self.c01 <= 0:
            raise InputError("c10 + c01 must be positive: it is half the shear modulus", field="c10")
        return self

    @property
    def initial_shear_modulus(self) -> float:
        """G at small strain [Pa]."""
        return 2 * (self.c10 + self.c01)


class Yeoh(RubberLaw):
    """W = C10 (I1 - 3) + C20 (I1 - 3)^2 + C30 (I1 - 3)^3, constants in Pa; G = 2 C10."""

    law: Literal["yeoh"]
    c10: Modulus
    c20: Constant = 0.0
    c30: Constant = 0.0

    @model_validator(mode="after")
    def _stable(self) -> Self:
        # dW/dI1 = c10 + 2 c20 x + 3 c30 x^2 must be positive for all x = I1 - 3 >= 0.
        if self.c30 < 0 or (self.c20 < 0 and self.c20**2 >= 3 * self.c10 * self.c30):
            raise InputError(
                "the rubber loses its stiffness when stretched: c30 >= 0, and for c20 < 0 c20^2 < 3 c10 c30, is needed",
                field="c30" if self.c30 < 0 else "c20",
            )
        return self

    @property
    def initial_shear_modulus(self) -> float:
        """G at small strain [Pa]."""
        return 2 * self.c10


Elasticity = Annotated[NeoHookean | MooneyRivlin | Yeoh, Field(discriminator="law")]


class Cords(Card):
    """The cords of a cord-rubber layer; bead wires are cords at 0 deg without lift.

    Volume fraction v_c = ends pi d^2 / (4 h), h the thickness of the region's leg. A region of neighbouring layers has
    one leg; a fabric round the bead, with other regions between its inner and outer part, has two. With ``lift`` the
    angle a to the circumference follows cos a / r = constant from ``angle`` at ``angle_radius``, as a green tyre is
    shaped over its drum.

    Parameters
    ----------
    modulus : of a cord in tension [Pa]; ``compression_modulus``: in compression, by default the same.
    diameter : of one cord [m].
    ends : cords per metre across them, at ``angle_radius``, all plies of one leg together [1/m].
    plies : number of cord layers in one leg, for these ends.
    angle : to the circumference [rad], 0 to 90 deg. angle_radius : where angle and ends are given [m].
    pairs : half of the cords at +angle, half at -angle; False at 0 and 90 deg only, where it means nothing.
    thickness_share : share of the layer's thickness that contains the cords.
    loss_tangent : of the cords; by default they lose no energy.
    softening : of the cords with temperature; by default their modulus is constant.

    Raises
    ------
    InputError : an angle beyond 0 to 90 deg, or of one sign; touching cords; a lifted angle without its radius, or of
        cords along the circumference.

    >>> belt = Cords.check({"modulus": "110 GPa", "diameter": "0.6 mm", "ends": "862 1/m", "angle": "22 deg",
    ...                     "angle_radius": "303 mm", "source": "estimate: example"})
    >>> round(belt.volume_fraction(1.25e-3), 3)
    0.195
    """

    modulus: Annotated[Modulus, CORD_MODULUS]
    compression_modulus: Annotated[float, Unit("Pa", ge=0, le=1e12)] | None = None
    diameter: Annotated[float, Unit("m", gt=0, le=0.02), CORD_DIAMETER]
    ends: Annotated[float, Unit("1/m", gt=0), CORD_ENDS]
    plies: Annotated[int, Field(ge=1, le=100)] = 1
    angle: Annotated[float, Unit("rad")]
    angle_radius: PositiveLength | None = None
    lift: bool = True
    pairs: bool = True
    thickness_share: Annotated[float, Unit("1", gt=0, le=1)] = 1.0
    loss_tangent: Annotated[float, Unit("1", ge=0, le=2), LOSS_TANGENT] | None = None
    softening: Softening | None = None
    source: Text
    relative_sd: Annotated[float, Unit("1", ge=0, lt=1)] | None = None

    @model_validator(mode="after")
    def _possible(self) -> Cords:
        if not 0 <= self.angle <= math.pi / 2 + 1e-9:
            raise InputError(
                f"{math.degrees(self.angle):.4g} deg is out of range: 0 deg (circumferential) to 90 deg (radial);"
                " 'pairs' lays the other half of the cords at the opposite angle",
                field="angle",
            )
        if not self.pairs and 1e-9 < self.angle < math.pi / 2 - 1e-9:
            raise InputError(
                "false with an angle between 0 and 90 deg: such a layer twists when it is stretched, which is left out;"
                " leave it out: half of the cords then lie at the opposite angle",
                field="pairs",
            )
        if self.ends / self.plies * self.diameter > 1:
            raise InputError(
                f"{self.ends:.4g} cords per metre of {self.diameter * 1e3:.3g} mm do not fit side by side in"
                f" {self.plies} {'ply' if self.plies == 1 else 'plies'}: ends x diameter / plies is"
                f" {self.ends / self.plies * self.diameter:.3g}, at most 1 is possible",
                field="ends",
            )
        if self.compression_modulus is not None and self.compression_modulus > self.modulus:
            raise InputError(
                f"{self.compression_modulus:.4g} Pa must be at most the modulus in tension, {self.modulus:.4g} Pa:"
                " compressed cords buckle",
                field="compression_modulus",
            )
        if self.lift and self.angle_radius is None:
            raise InputError("missing; the lift law needs the radius where the angle is given", field="angle_radius")
        if self.lift and self.angle < FLATTEST:
            raise InputError(
                "true with cords along the circumference: below angle_radius the lift law would turn all of them, and"
                " leave none; such cords need lift = false",
                field="lift",
            )
        return self

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """Fields of ``relative_sd``: the moduli in tension and compression have one factor."""
        return (("modulus", "compression_modulus"),)

    @property
    def in_compression(self) -> float:
        """Modulus in compression [Pa]."""
        return self.modulus if self.compression_modulus is None else self.compression_modulus

    def times(self, factor: float) -> Cords:
        """The cords with their moduli times a factor."""
        weaker = None if self.compression_modulus is None else factor * self.compression_modulus
        return self.model_copy(update={"modulus": factor * self.modulus, "compression_modulus": weaker})

    def volume_fraction(self, thickness: float) -> float:
        """v_c = ends pi d^2 / (4 h) of a layer ``thickness`` h [m] thick.

        Raises
        ------
        InputError : the cords are thicker than the layer, or denser than round cords can be.
        """
        room = thickness * self.thickness_share
        if room < self.diameter * (1 - 1e-9):
            raise InputError(
                f"cords of {self.diameter * 1e3:.3g} mm do not fit into the layer, which leaves them"
                f" {room * 1e3:.3g} mm",
                field="diameter",
            )
        fraction = self.ends * math.pi * self.diameter**2 / 4 / thickness
        if fraction / self.thickness_share > DENSEST:
            raise InputError(
                f"the cords would take {fraction / self.thickness_share:.0%} of the layer, which is"
                f" {thickness * 1e3:.3g} mm thick; round cords can take {DENSEST:.0%} at most",
                field="ends",
            )
        return fraction
