"""The `[plan]` table of a study: limits of the next runs, places of further sensors, costs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from tyrefem.cards import Card
from tyrefem.errors import InputError, nearest
from tyrefem.quantity import Unit, parse
from tyrefem.quantity.pattern import quantity_schema

#: Quantity of a drive that a plan may vary -> its unit.
UNITS = {
    "duration": "s",
    "speed": "m/s",
    "load": "N",
    "deflection": "m",
    "pressure": "Pa",
    "ambient": "degC",
    "road_temperature": "degC",
    "rim_temperature": "degC",
    "slip_ratio": "1",
    "slip_speed": "m/s",
    "slip_angle": "rad",
    "torque": "N*m",
    "camber": "rad",
}
Limits = dict[str, tuple[str, str]]


def limit_unit(key: str) -> str:
    """SI unit of a limited quantity, by its dotted name.

    >>> limit_unit("drive.phases.rolling.speed")
    'm/s'
    """
    return UNITS[key.rpartition(".")[2]]


def _limits(value: Any) -> Limits:
    """Check ``{"drive.speed": ["10 mph", "40 mph"]}``: dotted names in the drive, each with a lower and upper limit."""
    if not isinstance(value, Mapping):
        raise InputError("must be a table such as { \"drive.speed\" = ['10 mph', '40 mph'] }")
    limits: Limits = {}
    for key, pair in value.items():
        if isinstance(pair, Mapping):
            raise InputError("write the dotted name in quotes: \"drive.speed\" = ['10 mph', '40 mph']", field=str(key))
        table, _, rest = str(key).partition(".")
        name = rest.rpartition(".")[2]
        if table != "drive" or name not in UNITS:
            allowed = [f"drive.{each}" for each in UNITS]
            raise InputError(f"'{key}' is no quantity of the drive that can be limited{nearest(str(key), allowed)}")
        if not isinstance(pair, list | tuple) or len(pair) != 2:
            raise InputError(f"must be a lower and an upper limit, not {pair!r:.60}", field=str(key))
        try:
            low, high = (parse(each, UNITS[name]) for each in pair)
        except InputError as error:
            raise error.within(field=str(key)) from None
        if not low < high:
            raise InputError(f"the lower limit {pair[0]} is not below the upper limit {pair[1]}", field=str(key))
        limits[str(key)] = (str(pair[0]), str(pair[1]))
    return limits


def _limits_schema() -> dict[str, Any]:
    """JSON schema of a table of limits: every quantity of the drive, or of a phase by its name."""
    pairs = {}
    for name, unit in UNITS.items():
        pair = {"type": "array", "items": quantity_schema(unit), "minItems": 2, "maxItems": 2}
        pairs[rf"^drive\.(.+\.)?{name}$"] = pair
    return {"type": "object", "patternProperties": pairs, "additionalProperties": False}


class PlaceChoice(Card):
    """Place of a further thermocouple: ``s`` along the meridian from the crown, ``depth`` from the inner surface.

    ``below_surface``, instead of ``depth``: from the outer surface.
    """

    s: Annotated[float, Unit("m", ge=0)]
    depth: Annotated[float, Unit("m", ge=0)] | None = None
    below_surface: Annotated[float, Unit("m", ge=0)] | None = None

    @model_validator(mode="after")
    def _one_depth(self) -> PlaceChoice:
        if (self.depth is None) == (self.below_surface is None):
            missing = "missing" if self.depth is None else "is given beside 'below_surface'"
            raise InputError(f"{missing}; give either 'depth' or 'below_surface'", field="depth")
        return self


class PlanChoice(Card):
    """Limits and costs of the next runs and sensors; every default is an estimate.

    ``limits``: dotted name of a quantity of the drive -> lower and upper limit; without any, half to 1.5 times the
    study's speed, 0.75 to 1.25 times its load, 0.8 to 1.2 times its pressure. ``sensors``: places of further
    thermocouples; without any, even stations at three depths.
    ``run_cost``, ``sensor_cost``, ``hour_cost``: of a run, of a further sensor, and of an hour of a run, in one unit of
    the user's choice. ``runs_most``, ``sensors_most``: largest numbers in a plan. ``drives``: number of drives tried.
    """

    limits: Annotated[Limits, BeforeValidator(_limits), WithJsonSchema(_limits_schema())] = Field(default_factory=dict)
    sensors: dict[str, PlaceChoice] = Field(default_factory=dict)
    run_cost: Annotated[float, Unit("1", gt=0)] = 1.0
    sensor_cost: Annotated[float, Unit("1", gt=0)] = 0.5
    hour_cost: Annotated[float, Unit("1", ge=0)] = 0.0
    runs_most: Annotated[int, Field(ge=1, le=20)] = 3
    sensors_most: Annotated[int, Field(ge=0, le=20)] = 2
    drives: Annotated[int, Field(ge=1, le=200)] = 12
