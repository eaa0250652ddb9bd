"""The rig card: layers with priors, laser, phases, surroundings, sensors, runs."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, GetJsonSchemaHandler, model_validator
from pydantic_core import CoreSchema

from tyrefem.cards import Card, PositiveLength, Temperature, Text
from tyrefem.cards.file_names import check_file_name
from tyrefem.cards.plausible import CONDUCTIVITY, DENSITY, EMISSIVITY, SPECIFIC_HEAT, Plausible
from tyrefem.errors import InputError, InputWarning
from tyrefem.quantity import Unit

Share = Annotated[float, Unit("1", gt=0, le=1)]
Relative = Annotated[float, Unit("1", ge=0, lt=1)]


class Guess(Card):
    """Prior value of a property with its relative standard deviation, constant or linear in temperature.

    ``slope``: per kelvin, about the card's reference temperature. ``source``: reference of the value.
    """

    UNIT: ClassVar[str] = "1"
    LIKELY: ClassVar[Plausible]
    value: Any
    relative_sd: Annotated[float, Unit("1", gt=0, le=2)] = 0.5
    slope: Annotated[float, Unit("1/delta_degC", ge=-0.02, le=0.02)] = 0.0
    source: Text

    @classmethod
    def __get_pydantic_json_schema__(cls, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        table = handler.resolve_ref_schema(handler(core))
        likely = {"low": cls.LIKELY.low, "high": cls.LIKELY.high, "source": cls.LIKELY.source}
        table["properties"]["value"] |= {**Unit(cls.UNIT, gt=0).schema(), "x-likely": likely}
        return table

    @model_validator(mode="before")
    @classmethod
    def _in_its_unit(cls, data: Any) -> Any:
        if isinstance(data, dict) and "value" in data:
            try:
                return {**data, "value": Unit(cls.UNIT, gt=0)(data["value"])}
            except InputError as error:
                raise error.within(field="value") from None
        return data

    def warnings(self) -> tuple[InputWarning, ...]:
        """A warning of an unusual value."""
        return super().warnings() + tuple(filter(None, [self.LIKELY.warning(self.value, "value")]))


class ConductivityGuess(Guess):
    """W/m/K."""

    UNIT: ClassVar[str] = "W/m/K"
    LIKELY: ClassVar[Plausible] = CONDUCTIVITY


class SpecificHeatGuess(Guess):
    """J/kg/K."""

    UNIT: ClassVar[str] = "J/kg/K"
    LIKELY: ClassVar[Plausible] = SPECIFIC_HEAT


class KnownDensity(Card):
    """Density from weighing, kg/m3: a heating test measures only density times specific heat."""

    value: Annotated[float, Unit("kg/m**3", gt=0), DENSITY]
    source: Text


class RigLayerCard(Card):
    """A layer: ``thickness`` with the standard deviation of its measurement, and properties.

    ``reference_temperature``: temperature of its properties, preferably that of the layer during the tests.
    """

    name: Text
    thickness: Annotated[float, Unit("m", gt=0, le=0.2)]
    thickness_sd: Annotated[float, Unit("m", ge=0, le=0.01)] = 0.0
    density: KnownDensity
    conductivity: ConductivityGuess
    specific_heat: SpecificHeatGuess
    reference_temperature: Temperature = 40.0


class Laser(Card):
    """The beam: ``spot_diameter`` of a uniform disc, or of a Gaussian beam at 1/e2 of its peak intensity.

    ``absorptance``: absorbed share of the beam's power. ``placing_sd``: standard deviation of each coordinate of the
    spot's centre relative to the sensors' aiming point.
    """

    spot_diameter: Annotated[float, Unit("m", gt=0)]
    profile: Literal["uniform", "gaussian"] = "uniform"
    absorptance: Share = 0.95
    absorptance_sd: Annotated[float, Unit("1", ge=0, lt=0.5)] = 0.02
    placing_sd: Annotated[float, Unit("m", ge=0, le=0.01)] = 1e-3
    power_range: tuple[Annotated[float, Unit("W", gt=0)], Annotated[float, Unit("W", gt=0)]] = (0.5, 2.0)


class PatchCard(Card):
    """The computed patch, and the crown's radii of curvature (none: flat)."""

    radius: PositiveLength
    circumferential_radius: PositiveLength | None = None
    lateral_radius: PositiveLength | None = None

    @property
    def curvature(self) -> float:
        """Mean curvature of the outer face, 1/m."""
        return sum(0.5 / r for r in self._radii.values())

    @property
    def _radii(self) -> dict[str, float]:
        names = ("circumferential_radius", "lateral_radius")
        return {name: getattr(self, name) for name in names if getattr(self, name) is not None}

    @property
    def most_curved(self) -> str:
        """Field of the smaller radius of curvature."""
        return min(self._radii, key=self._radii.__getitem__, default="radius")

    def along_face(self, distance: float) -> float:
        """Distance along the curved face of points at a distance from the beam's axis, m; infinite: the face ends."""
        if not self.curvature:
            return distance
        sine = self.curvature * distance
        return math.asin(sine) / self.curvature if sine < 1 else math.inf


class HeatingPhases(Card):
    """Laser off, on, off. ``clock_sd``: standard deviation of a table's clock against the laser's switch, per run."""

    idle: Annotated[float, Unit("s", ge=0, le=1e5)]
    heating: Annotated[float, Unit("s", gt=0, le=1e5)]
    cooling: Annotated[float, Unit("s", ge=0, le=1e5)]
    clock_sd: Annotated[float, Unit("s", ge=0, le=600)] = 0.0

    @property
    def end(self) -> float:
        """s."""
        return self.idle + self.heating + self.cooling


class SurroundingsCard(Card):
    """Air and walls. Both faces have the film of a vertical plate of the ``characteristic_length``, times a factor of 1
    with the relative standard deviation ``convection_sd``. The paper leaves out ``radiation``."""

    ambient: Temperature
    characteristic_length: PositiveLength
    convection_sd: Annotated[float, Unit("1", ge=0, le=1)] = 0.15
    radiation: bool = True
    emissivity: Annotated[Share, EMISSIVITY] = 0.95
    emissivity_sd: Annotated[float, Unit("1", ge=0, lt=0.5)] = 0.01


class SensorCard(Card):
    """``camera``: the mean over a disc of the outer or inner ``face``; ``thermocouple``: a point at a ``depth``.

    ``aside``: distance along the face from the rig's mark. Standard deviations: ``noise`` of a reading, ``offset_sd``
    of a constant error, ``gain_sd`` of a relative error of the rise over the start, such as by a camera's emissivity.
    Only thermocouples have ``depth_sd`` and ``lag`` (first order, with relative ``lag_sd``).
    """

    instrument: Literal["camera", "thermocouple"]
    face: Literal["outer", "inner"] | None = None
    window: Annotated[float, Unit("m", ge=0, le=0.1)] = 4e-3
    depth: Annotated[float, Unit("m", gt=0)] | None = None
    depth_sd: Annotated[float, Unit("m", ge=0, le=0.01)] = 0.0
    aside: Annotated[float, Unit("m", ge=0)] = 0.0
    lag: Annotated[float, Unit("s", ge=0, le=600)] = 0.0
    lag_sd: Relative = 0.0
    noise: Annotated[float, Unit("delta_degC", gt=0, le=50)]
    offset_sd: Annotated[float, Unit("delta_degC", ge=0, le=50)] = 0.0
    gain_sd: Annotated[float, Unit("1", ge=0, lt=0.5)] = 0.0

    @model_validator(mode="after")
    def _complete(self) -> SensorCard:
        if self.instrument == "camera":
            if self.face is None:
                raise InputError("a camera needs 'face', outer or inner", field="face")
            if self.depth is not None or self.depth_sd:
                field = "depth_sd" if self.depth is None else "depth"
                raise InputError("a camera measures a face and has no depth", field=field)
            if self.lag or self.lag_sd:
                raise InputError("a camera has no lag", field="lag" if self.lag else "lag_sd")
        elif self.depth is None:
            raise InputError("a thermocouple needs 'depth' below the outer face", field="depth")
        elif self.face is not None:
            raise InputError("a thermocouple is inside and has no face", field="face")
        return self


class RunCard(Card):
    """A test: the laser's power, and the ambient temperature if it differs."""

    power: Annotated[float, Unit("W", gt=0)]
    ambient: Temperature | None = None


class RigCard(Card):
    """A rig.toml; refuses impossible rigs."""

    kind: ClassVar[str] = "rig"
    title: Text
    notes: str = ""
    laser: Laser
    patch: PatchCard
    phases: HeatingPhases
    surroundings: SurroundingsCard
    layers: Annotated[tuple[RigLayerCard, ...], Field(min_length=1, max_length=8)]
    sensors: Annotated[dict[str, SensorCard], Field(min_length=1)]
    runs: Annotated[dict[str, RunCard], Field(min_length=1)]
    slope_sd: Annotated[float, Unit("1/delta_degC", gt=0, le=0.02)] = 2e-3
    #: Smallest model error, relative to the rise: mesh, spherical shells for a doubly curved crown.
    model_error: Annotated[float, Unit("1", ge=0, lt=0.1)] = 1e-3

    @property
    def thickness(self) -> float:
        """Thickness of all layers, m."""
        return sum(layer.thickness for layer in self.layers)

    @model_validator(mode="after")
    def _possible(self) -> RigCard:
        self._patch()
        names = [layer.name for layer in self.layers]
        for number, name in enumerate(names):
            check_file_name(name, "layer", f"layers.{number}.name", names[:number])
            if name in names[:number]:
                raise InputError(f"two layers are named '{name}'", field=f"layers.{number}.name")
        for name, sensor in self.sensors.items():
            self._sensor(name, sensor)
        low, high = self.laser.power_range
        if low > high:
            raise InputError("the first power must not be larger than the second", field="laser.power_range")
        for name, run in self.runs.items():
            check_file_name(name, "run", "runs", self.runs)
            if not low <= run.power <= high:
                words = f"{run.power:g} W is outside the laser's range, {low:g} to {high:g} W (laser.power_range)"
                raise InputError(words, field=f"runs.{name}.power")
        return self

    def _patch(self) -> None:
        spot, radius = self.laser.spot_diameter / 2, self.patch.radius
        if self.patch.along_face(spot) >= radius:
            words = f"the spot, {2e3 * spot:g} mm wide, does not fit on the patch, {2e3 * radius:g} mm wide"
            raise InputError(words + (" along its curved face" if spot < radius else ""), field="laser.spot_diameter")
        curvature = self.patch.curvature
        if curvature * max(self.thickness, radius / 1.5) >= 1:
            words = (
                f"a patch of {1e3 * radius:g} mm and {1e3 * self.thickness:g} mm thickness cannot have this curvature"
            )
            raise InputError(words, field=f"patch.{self.patch.most_curved}")

    def _sensor(self, name: str, sensor: SensorCard) -> None:
        field = f"sensors.{name}"
        if name.lower() in ("time", "run", "t") or not name.strip():
            raise InputError(f"'{name}' is a reserved name of the tables", field="sensors")
        if name != name.strip() or len(name.splitlines()) != 1:
            words = f"{name!r} is no name of a column: it begins or ends with a space, or has a line break"
            raise InputError(words, field="sensors")
        if sensor.depth is not None and sensor.depth >= self.thickness:
            words = f"{1e3 * sensor.depth:g} mm is outside the tyre, which is {1e3 * self.thickness:g} mm thick"
            raise InputError(words, field=f"{field}.depth")
        reach = sensor.aside + (sensor.window / 2 if sensor.instrument == "camera" else 0.0)
        if reach >= self.patch.radius:
            words = f"{1e3 * reach:g} mm from the mark is outside the patch of {1e3 * self.patch.radius:g} mm radius"
            raise InputError(words, field=f"{field}.aside")
