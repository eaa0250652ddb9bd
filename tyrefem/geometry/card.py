"""The validated card of a section file, ``geometry/NAME.toml``."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from tyrefem.cards import Card, PositiveLength, Text
from tyrefem.errors import InputError, nearest
from tyrefem.quantity import Unit, parse
from tyrefem.quantity.pattern import NAMES, quantity_schema, row_schema

MARKS = ("shoulder", "bead_start", "rim_start")


def _lengths(value: Any) -> tuple[float, ...]:
    """``["0 in", "0.3 in"]``, or ``{unit = "in", values = [0, 0.3]}``."""
    unit = ""
    if isinstance(value, dict):
        if set(value) != {"unit", "values"} or not isinstance(value["unit"], str):
            raise InputError("a table of numbers needs the two keys 'unit' and 'values'")
        unit, value = " " + value["unit"], value["values"]
        if isinstance(value, list | tuple) and not all(_is_number(item) for item in value):
            raise InputError("'values' must be a list of numbers, with their unit in 'unit'")
    if not isinstance(value, list | tuple) or not value:
        raise InputError("must be a list like ['0 in', '0.3 in'] or { unit = 'in', values = [0, 0.3] }")
    return tuple(parse(f"{item!r}{unit}" if unit else item, "m") for item in value)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _points(value: Any) -> tuple[tuple[float, float], ...]:
    """``{unit = "mm", values = [[r, z], ...]}`` or ``[["280 mm", "0 mm"], ...]``."""
    pairs = value.get("values") if isinstance(value, dict) else value
    if not isinstance(pairs, list | tuple) or not all(isinstance(p, list | tuple) and len(p) == 2 for p in pairs):
        raise InputError("must be pairs [r, z]: { unit = 'mm', values = [[280, 0], [278, 20], ...] }")
    flat = [number for pair in pairs for number in pair]
    numbers = _lengths({**value, "values": flat} if isinstance(value, dict) else flat)
    return tuple(zip(numbers[::2], numbers[1::2], strict=True))


def _end(value: Any) -> float | str:
    """A mark's name, or a length along the meridian; a negative length is measured from the bead."""
    if isinstance(value, str) and value.replace("_", "").isalpha():
        if value not in MARKS:
            raise InputError(f"no mark '{value}'{nearest(value, MARKS)}; or a length like '2.2 in'")
        return value
    length = Unit("m")(value)
    if length == 0:
        raise InputError(f"{value!r} is the crown: a part ends behind it, or (negative) before the bead")
    return length


def _in_a_unit(values: dict[str, Any]) -> dict[str, Any]:
    """JSON schema of numbers with their unit beside them."""
    unit = {"type": "string", "enum": NAMES["length"].split(), "description": "Unit of all the numbers."}
    numbers = {"type": "array", "items": values, "minItems": 1, "description": "The numbers, without their unit."}
    return {
        "type": "object",
        "properties": {"unit": unit, "values": numbers},
        "required": ["unit", "values"],
        "additionalProperties": False,
    }


_PAIR = {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}
_LENGTHS = {"anyOf": [_in_a_unit({"type": "number"}), {"type": "array", "items": quantity_schema("m"), "minItems": 1}]}
_POINTS = {"anyOf": [_in_a_unit(_PAIR), row_schema("m", "m")]}
_ENDS = {"anyOf": [{"type": "string", "enum": list(MARKS)}, quantity_schema("m")]}
Lengths = Annotated[tuple[float, ...], BeforeValidator(_lengths), WithJsonSchema(_LENGTHS)]
Points = Annotated[tuple[tuple[float, float], ...], BeforeValidator(_points), WithJsonSchema(_POINTS)]
End = Annotated[float | str, BeforeValidator(_end), WithJsonSchema(_ENDS)]
Fraction = Annotated[float, Unit("1", gt=0, lt=2)]
Scale = Annotated[float, Unit("1", gt=0)]


class PartCard(Card):
    """A named part of the meridian, from the end of the previous part to ``to``; the last part has no ``to``.

    ``to`` is a mark, a length from the crown, or a negative length, measured from the bead.
    """

    name: Text
    to: End | None = None


class LineCard(Card):
    """Form of the meridian, and its position within the thickness."""

    form: Annotated[Literal["two-arcs", "points"], Field(alias="kind")]
    reference: Text
    points: Points | None = None
    source: Text


class LayerCard(Card):
    """A layer's thickness at stations along the meridian, and its regions.

    With ``stretch`` the table's last station is the end of a meridian, and the table scales with ``meridian_length``.
    """

    name: Text
    s: Lengths
    thickness: Lengths
    interpolation: Literal["linear", "pchip"] = "linear"
    stretch: bool = False
    regions: Annotated[tuple[PartCard, ...], Field(min_length=1)]
    source: Text


class ParametersCard(Card):
    """The named dimensions of a section, which a design study changes."""

    nominal_width: PositiveLength
    outer_diameter: PositiveLength | None = None
    crown_midline_radius: PositiveLength | None = None
    overall_width: PositiveLength | None = None
    shoulder_fraction: Fraction | None = None
    shoulder_s: PositiveLength | None = None
    crown_radius: PositiveLength | None = None
    sidewall_radius: PositiveLength | None = None
    meridian_length: PositiveLength | None = None
    bead_length: PositiveLength | None = None
    rim_length: PositiveLength | None = None
    flange_radius: PositiveLength | None = None
    flange_r: PositiveLength | None = None
    flange_z: PositiveLength | None = None
    inner_volume: Annotated[float, Unit("m**3", gt=0)] | None = None
    thickness_scale: dict[str, Scale] = {}  # noqa: RUF012
    source: Text


class GroovesCard(Card):
    """Circumferential grooves in the outermost layer: middles ``at`` along the meridian, all of the same ``width``.

    ``boundary`` is the boundary of their walls and bottoms. A width of 0 gives a smooth tread.
    """

    at: Lengths
    width: Annotated[float, Unit("m", ge=0)]
    boundary: Text = "outside_air"
    source: Text


class PatternCard(Card):
    """Transverse grooves and sipes through the outermost layer, smeared: they soften it for finite elements.

    ``void`` is the share of the circumference that grooves take, ``block_length`` the rubber between two cuts (groove
    or sipe) along the circumference.
    """

    void: Annotated[float, Unit("1", ge=0, le=0.6)] = 0.0
    block_length: PositiveLength
    source: Text


class WrapCard(Card):
    """The ``region`` in which plies leave the inner layer, cross the other layers and continue in the turn-up."""

    region: Text
    source: Text


class RatingCard(Card):
    """Rated load and pressure, nominal size, cords and bead wire."""

    width: PositiveLength
    diameter: PositiveLength
    load: Annotated[float, Unit("N", gt=0)]
    pressure: Annotated[float, Unit("Pa", gt=0)]
    cord_angle: Annotated[float, Unit("rad", gt=0, le=1.5708)]
    bead_wire_area: Annotated[float, Unit("m**2", gt=0)]
    bead_bundles: Annotated[int, Field(ge=1, le=20)]
    source: Text


class SectionCard(Card):
    """A section file: line, dimensions, layers from the inside to the outside, boundaries, rating.

    >>> from tyrefem.library import load
    >>> card = SectionCard.check(load("section", "nasa-22x5.5-8pr")[0])
    >>> [layer.name for layer in card.layers], round(card.parameters.crown_radius / 0.0254, 3)
    (['carcass', 'rubber'], 3.482)
    """

    kind: ClassVar[str] = "section"

    title: Text
    line: LineCard
    parameters: ParametersCard
    layers: Annotated[tuple[LayerCard, ...], Field(min_length=1)]
    boundaries: Annotated[tuple[PartCard, ...], Field(min_length=1)]
    grooves: GroovesCard | None = None
    pattern: PatternCard | None = None
    wrap: WrapCard | None = None
    rating: RatingCard | None = None

    @model_validator(mode="after")
    def _check_dimensions(self) -> SectionCard:
        """Check that every dimension is given once, and that the line's kind has its dimensions."""
        given = {name for name, value in self.parameters if value is not None}
        needs, refuses = _BY_KIND[self.line.form]
        for name in sorted(needs - given):
            raise InputError(f"missing; a '{self.line.form}' line needs it", field=f"parameters.{name}")
        for name in sorted(refuses & given):
            raise InputError(f"a '{self.line.form}' line does not take it", field=f"parameters.{name}")
        if self.line.form == "points" and self.line.points is None:
            raise InputError("missing; a 'points' line needs it", field="line.points")
        if self.line.form == "two-arcs":
            if self.line.points is not None:
                raise InputError("a 'two-arcs' line does not take it", field="line.points")
            if not given & {"outer_diameter", "crown_midline_radius"}:
                raise InputError("missing; give it or crown_midline_radius", field="parameters.outer_diameter")
            if not given & {"shoulder_fraction", "overall_width"}:
                raise InputError("missing; give it or overall_width", field="parameters.shoulder_fraction")
        for name, other in (("flange_r", "flange_z"), ("flange_z", "flange_r")):
            if name in given and other not in given:
                raise InputError(
                    f"missing; the flange's centre needs both {name} and {other}", field=f"parameters.{other}"
                )
        regions = {part.name for layer in self.layers for part in layer.regions}
        for name in self.parameters.thickness_scale:
            if name not in regions:
                message = f"no region '{name}'{nearest(name, regions)}"
                raise InputError(message, field="parameters.thickness_scale")
        return self


_BY_KIND = {
    "two-arcs": ({"crown_radius", "sidewall_radius", "meridian_length"}, {"shoulder_s"}),
    "points": (
        {"shoulder_s"},
        {"crown_radius", "sidewall_radius", "meridian_length", "crown_midline_radius", "shoulder_fraction"}
        | {"overall_width"},
    ),
}
