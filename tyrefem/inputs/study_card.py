"""The study file, as `tyrefem.study` validates it. Every key can be changed by its dotted name."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field, WithJsonSchema, field_validator, model_validator

from tyrefem.boundaries import LawOf
from tyrefem.boundaries.contained_air import ContainedAirLaw
from tyrefem.boundaries.outside_air import OutsideAirLaw
from tyrefem.boundaries.rim import RimLaw
from tyrefem.boundaries.road import RoadLaw
from tyrefem.boundaries.sliding import SlidingLaw
from tyrefem.cards import Card, PositiveLength, Temperature, Text
from tyrefem.cards.plausible import ENERGY_DENSITY, PLACING, THERMOCOUPLE_ERROR, THERMOCOUPLE_LAG
from tyrefem.effects import Effect, EffectOf
from tyrefem.errors import InputError, InputWarning, nearest
from tyrefem.estimates.work import check_readings, smallest_tolerance
from tyrefem.geometry.named_places import PlaceName
from tyrefem.inputs.deviations import Deviation
from tyrefem.inputs.drive import Drive
from tyrefem.inputs.explore_choice import ExploreChoice
from tyrefem.inputs.loading import TR_R_64, FootprintLaw, TrR64, VerticalStiffness
from tyrefem.inputs.plan_choice import PlanChoice
from tyrefem.inputs.published import Published
from tyrefem.quantity import Unit
from tyrefem.quantity.pattern import quantity_schema, row_schema

if TYPE_CHECKING:
    from tyrefem.geometry import Section

#: Keys of a sensor that say where it is.
PLACE_KEYS = ("place", "s", "depth", "below_surface", "at")
Rows = tuple[tuple[float, float], ...]
#: Names that tables, exported models and pages use beside those of the sensors.
OUTPUTS = (
    *("time_s", "contained-air", "rim", "hottest", "gas_pressure", "generated", "stored"),
    *("rolling_resistance", "rolling_resistance_coefficient"),
)


def _rows(value: Any) -> Rows:
    """Parse ``"12 kJ/m**3"``, or rows ``[["0 mm", "12 kJ/m**3"], ...]`` along the meridian with increasing s."""
    if not isinstance(value, list | tuple):
        return ((0.0, Unit("J/m**3", ge=0)(value)),)
    if not value or not all(isinstance(row, list | tuple) and len(row) == 2 for row in value):
        raise InputError("must be like '12 kJ/m**3' or rows [['0 mm', '12 kJ/m**3'], ['70 mm', '20 kJ/m**3']]")
    rows = tuple((Unit("m", ge=0)(s), Unit("J/m**3", ge=0)(energy)) for s, energy in value)
    if any(after <= before for (before, _), (after, _) in pairwise(rows)):
        raise InputError("the distances from the crown must rise from row to row")
    return rows


#: Rows in a file.
_ROWS_SCHEMA = {"anyOf": [quantity_schema("J/m**3", {"ge": 0.0}), row_schema("m", "J/m**3", least=1)]}


class GivenEnergy(Card):
    """Strain energy per cycle U, J/m3, of every region at one load and pressure.

    ``regions``: a number, or rows of distance from the crown and energy, linear between them and constant outside.
    ``temperature``: temperature of the energies, degC; if given, they follow the modulus (with
    ``mechanics.feedback``).
    """

    load: Annotated[float, Unit("N", gt=0)]
    pressure: Annotated[float, Unit("Pa", gt=0)]
    temperature: Temperature | None = None
    regions: dict[str, Annotated[Rows, BeforeValidator(_rows), WithJsonSchema(_ROWS_SCHEMA)]] = Field(min_length=1)
    source: Text

    def check_regions(self, section: Section) -> None:
        """Raise `InputError` unless exactly the section's regions are given."""
        for region in self.regions:
            if region not in section.regions:
                message = f"section '{section.name}' has no region '{region}'{nearest(region, section.regions)}"
                raise InputError(message, field="regions")
        for region in section.regions:
            if region not in self.regions:
                raise InputError(f"no strain energy for region '{region}' (it may be '0 J/m**3')", field="regions")

    def warnings(self) -> tuple[InputWarning, ...]:
        """The first unlikely energy of every region."""
        unlikely = [
            next(filter(None, (ENERGY_DENSITY.warning(energy, f"regions.{region}") for _, energy in rows)), None)
            for region, rows in self.regions.items()
        ]
        return (*super().warnings(), *filter(None, unlikely))

    def without_effect(self, section: Section) -> tuple[InputWarning, ...]:
        """Warnings of rows so far outside their region that they have no effect."""
        warnings = []
        for region, rows in self.regions.items():
            pieces = [piece for piece in section.pieces if piece.region == region]
            if len(rows) < 2 or not pieces:
                continue
            start, end = min(piece.start for piece in pieces), max(piece.end for piece in pieces)
            idle = [s for s, following in pairwise([s for s, _ in rows]) if following <= start + 1e-9]
            idle += [s for before, s in pairwise([s for s, _ in rows]) if before >= end - 1e-9]
            if idle:
                places = ", ".join(f"{s * 1e3:.4g}" for s in idle)
                words = f"rows at {places} mm have no effect: it runs from {start * 1e3:.4g} to {end * 1e3:.4g} mm"
                warnings.append(InputWarning(words, field=f"regions.{region}"))
        return tuple(warnings)


class MeshChoice(Card):
    """How the section is meshed.

    ``through``: least number of elements through every layer; 1 is enough for the thin plies of a radial. ``cell``:
    by default quadrilaterals for the mapped mesher, triangles for gmsh. ``file``: a user's mesh with named groups,
    instead of a mesher. ``names`` maps the file's names to the section's, ``axes`` names its coordinates (r, z), and
    ``unit`` is their unit.
    """

    mesher: Literal["mapped", "gmsh"] = "mapped"
    size: Annotated[float, Unit("m", gt=1e-4, lt=0.5)] = 3e-3
    cell: Literal["quad", "tri"] | None = None
    element: Literal["P1", "P2"] = "P2"
    through: Annotated[int, Field(ge=1, le=50)] = 3
    section: Literal["half", "full"] = "half"
    file: str | None = None
    names: dict[str, str] = Field(default_factory=dict)
    axes: str = "rz"
    unit: str = "m"


#: Motion of a footprint by finite elements.
FootprintMotion = Literal["large", "linear"]


class Feedback(Card):
    """Feedback of temperature on the strain cycle: `tyrefem.simulation.feedback`.

    ``pressure``: the gauge pressure follows the contained air's temperature, so warming reduces the deflection at
    given load. ``modulus``: moduli follow the ``softening`` of the cards at each region's mean temperature.
    ``friction``: the coefficient of a tyre that rolls with friction follows the mean temperature of the tread.
    ``knots``: number of strain cycles in every phase of constant load. ``tolerance``: largest difference between the
    temperatures of strain cycles and run. ``iterations``: largest number of runs.
    """

    pressure: bool = True
    modulus: bool = True
    friction: bool = True
    knots: Annotated[int, Field(ge=2, le=200)] = 9
    tolerance: Annotated[float, Unit("delta_degC", gt=0, le=20)] = 0.1
    iterations: Annotated[int, Field(ge=1, le=200)] = 20


class Mechanics(Card):
    """Settings of the strain cycle.

    ``loss_convention``: ``nasa``, W = pi U tan d (eq 25, where U stands for E' e0^2), or ``sinusoid``,
    W = 2 pi U tan d with U = E' e0^2 / 2. ``poisson_term`` is c_a = 1 - nu_pt nu_tp (eq 7a); 0.75 is an estimate.
    ``strain``: ``arcs``, the NASA report's bias tyre; ``barrel``, its deformation by finite elements; ``fem``, the
    footprint by finite elements; or ``given``, the energies of the table ``energy`` (which only this law reads).
    ``motion``: footprint by finite elements in ``large`` motion, or ``linear`` about the inflated tyre: the quick look.
    ``moduli``: for ``fem``, the cards' moduli, or ``secant``, those at each region's strain amplitude under load
    (`footprint.secant_moduli`), where cards give ``strain_dependence``.
    ``rolling``: for ``fem``, the tyre turns while it is pressed: centrifugal growth, inertia and, in linear motion, lag
    of the strains by their loss.
    ``revolution``: for ``fem``, all harmonics with their frequencies, or one cycle as in the report. ``feedback``:
    feedback of temperature on the strain cycle; none without this table.
    """

    strain: Text = "arcs"
    energy: GivenEnergy | None = None
    load_law: Annotated[TrR64 | VerticalStiffness, Field(discriminator="law")] = TrR64()
    footprint: Annotated[FootprintLaw, Field(discriminator="law")] = TR_R_64
    loss_convention: Literal["nasa", "sinusoid"] = "nasa"
    poisson_term: Annotated[float, Unit("1", ge=0, le=1)] = 0.75
    membrane_shear: bool = True
    motion: FootprintMotion = "large"
    moduli: Literal["card", "secant"] = "card"
    rolling: bool = False
    revolution: Literal["harmonics", "one-cycle"] = "harmonics"
    feedback: Feedback | None = None

    @model_validator(mode="after")
    def _energy_where_given(self) -> Mechanics:
        if self.strain == "given" and self.energy is None:
            raise InputError('strain = "given" needs the table [mechanics.energy]', field="strain")
        if self.rolling and self.strain != "fem":
            raise InputError('needs strain = "fem": the other strain laws do not turn', field="rolling")
        return self


class Boundaries(Card):
    """Boundary laws, one per side, and the law of sliding heat in phases with slip."""

    road: Annotated[RoadLaw, LawOf("road", "constant")] = Field(default_factory=lambda: LawOf("road", "constant")({}))
    outside_air: Annotated[OutsideAirLaw, LawOf("outside_air", "nasa")] = Field(
        default_factory=lambda: LawOf("outside_air", "nasa")({})
    )
    contained_air: Annotated[ContainedAirLaw, LawOf("contained_air", "gas")] = Field(
        default_factory=lambda: LawOf("contained_air", "gas")({})
    )
    rim: Annotated[RimLaw, LawOf("rim", "fixed")] = Field(default_factory=lambda: LawOf("rim", "fixed")({}))
    sliding: Annotated[SlidingLaw, LawOf("sliding", "constant")] = Field(
        default_factory=lambda: LawOf("sliding", "constant")({})
    )


class Sensor(Card):
    """A thermocouple: ``s`` along the meridian from the crown and ``depth`` from the inner surface, or ``at = [r, z]``.

    ``below_surface``, instead of ``depth``: from the outer surface of the new tyre, in a groove from its bottom.
    ``place``, instead of ``s``: a place that every section has (`named_place`); with a depth only its ``s``.
    ``lag``: first-order time constant. Standard deviations: ``noise`` of a reading, ``accuracy`` of the calibration,
    ``position_sd`` of the place, ``lag_sd`` of the lag (defaults: estimates for a hand-drilled thermocouple).
    """

    place: PlaceName | None = None
    s: Annotated[float, Unit("m")] | None = None
    depth: Annotated[float, Unit("m", ge=0)] | None = None
    below_surface: Annotated[float, Unit("m", ge=0)] | None = None
    at: tuple[PositiveLength, Annotated[float, Unit("m", ge=-20, le=20)]] | None = None
    position_sd: Annotated[float, Unit("m", ge=0), PLACING] = 1e-3
    lag: Annotated[float, Unit("s", ge=0), THERMOCOUPLE_LAG] = 0.0
    noise: Annotated[float, Unit("delta_degC", ge=0), THERMOCOUPLE_ERROR] = 0.5
    accuracy: Annotated[float, Unit("delta_degC", ge=0), THERMOCOUPLE_ERROR] = 1.0
    lag_sd: Annotated[float, Unit("s", ge=0), THERMOCOUPLE_LAG] = 2.0

    @model_validator(mode="after")
    def _one_place(self) -> Sensor:
        through = (self.depth is not None) + (self.below_surface is not None)
        along = (self.s is not None) + (self.place is not None) + (self.at is not None)
        allowed = (0,) if self.at is not None else (0, 1) if self.place is not None else (1,)
        if along != 1 or through not in allowed:
            raise InputError(
                "give either 's' and 'depth', 's' and 'below_surface', 'at = [r, z]', or 'place', alone or with one of "
                "the depths"
            )
        return self


class Output(Card):
    """Output: interval ``every`` of readings, and number ``fields`` of temperature fields over the drive.

    ``life``: every variant of a sweep answers the fatigue life too, which takes longer than its temperatures.
    """

    every: Annotated[float, Unit("s", gt=0)] = 5.0
    fields: Annotated[int, Field(ge=2, le=10_000)] = 13
    life: bool = False


class Numerics(Card):
    """``tolerance``: allowed time-integration error; ``mesh_sd``: standard deviation by the mesh (estimate)."""

    tolerance: Annotated[float, Unit("delta_degC", gt=0, le=10)] = 0.01
    mesh_sd: Annotated[float, Unit("delta_degC", ge=0)] = 0.05


class DiagnosisChoice(Card):
    """Assumptions of the diagnosis; every default is an estimate.

    ``film_sd``: relative standard deviation of film coefficients. ``discrepancy``: standard deviation of the error of
    a correct model (mesh, time steps, distribution of strain energy), K, correlated over ``correlation_time``.
    ``effects_expected``: prior probability that an effect is missing. ``exclude``: effects known to be absent.
    """

    film_sd: Annotated[float, Unit("1", gt=0, lt=1)] = 0.2
    discrepancy: Annotated[float, Unit("delta_degC", gt=0)] = 0.1
    correlation_time: Annotated[float, Unit("s", gt=0)] = 120.0
    effects_expected: Annotated[float, Unit("1", gt=0, lt=1)] = 0.5
    exclude: tuple[Text, ...] = ()


class MeasuredEntry(Card):
    """A measured table: file, run of the file, drive of that run, and whether the run is held out of all fits.

    ``rename``: column -> sensor, time or run, for columns of another name. ``ignore``: columns to leave out.
    """

    table: Text
    run: Text | None = None
    drive: dict[str, Any] = Field(default_factory=dict)
    hold_out: bool = False
    noise: Annotated[float, Unit("delta_degC", gt=0), THERMOCOUPLE_ERROR] | None = None
    time_offset: Annotated[float, Unit("s")] = 0.0
    rename: dict[Text, Text] = Field(default_factory=dict)
    ignore: tuple[Text, ...] = ()


class StudyCard(Card):
    """A study.toml, before its references to other cards are read.

    ``run``: the measured run that the study is at; effects with ``runs`` act in these only.
    ``made_for``: section of the load law, footprint, given energies and published ranges; the study warns with another
    section.
    """

    kind: ClassVar[str] = "study"
    title: Text
    section: Any
    run: Text | None = None
    made_for: Text | None = None
    materials: dict[str, Any] = Field(default_factory=dict)
    drive: Drive
    mesh: MeshChoice = MeshChoice()
    mechanics: Mechanics = Mechanics()
    boundaries: Boundaries = Field(default_factory=Boundaries)
    sensors: dict[str, Sensor] = Field(default_factory=dict)
    output: Output = Output()
    numerics: Numerics = Numerics()
    uncertainty: dict[str, Annotated[float | str, Deviation()]] = Field(default_factory=dict)
    measured: tuple[MeasuredEntry, ...] = ()
    cases: Text | None = None
    effects: tuple[Annotated[Effect, EffectOf()], ...] = ()
    diagnosis: DiagnosisChoice = DiagnosisChoice()
    plan: PlanChoice = Field(default_factory=PlanChoice)
    explore: ExploreChoice = Field(default_factory=ExploreChoice)
    published: Published = Published()

    @property
    def acting_effects(self) -> tuple[Effect, ...]:
        """The effects of non-zero amplitude that act in ``run``."""
        return tuple(effect for effect in self.effects if not effect.is_null and effect.acts_in(self.run))

    @property
    def of_one_tyre(self) -> tuple[str, ...]:
        """Dotted names of data that hold for one tyre only: measured or estimated, independent of the section."""
        mechanics = self.mechanics
        names = {
            "mechanics.load_law": isinstance(mechanics.load_law, VerticalStiffness),
            "mechanics.footprint": mechanics.footprint.law != TR_R_64.law,
            "mechanics.energy": mechanics.energy is not None,
        }
        names["published"] = any(published_range is not None for _, published_range in self.published)
        return tuple(name for name, there in names.items() if there)

    @field_validator("uncertainty", mode="before")
    @classmethod
    def _quoted(cls, data: Any) -> Any:
        """Refuse nested tables: TOML makes them of dotted names without quotes."""
        for key, value in data.items() if isinstance(data, Mapping) else ():
            if isinstance(value, Mapping):
                inner = next(iter(value), "...")
                raise InputError(f'write dotted names in quotes, e.g. "{key}.{inner}" = "2 %"', field=str(key))
        return data

    @model_validator(mode="after")
    def _sensor_names(self) -> StudyCard:
        for name in self.sensors:
            if name in OUTPUTS or not name.strip():
                raise InputError(f"'{name}' is a name that readings already use", field="sensors")
            if name != name.strip() or len(name.splitlines()) != 1:
                words = f"{name!r} is no name of a column: it begins or ends with a space, or has a line break"
                raise InputError(words, field="sensors")
        return self

    @model_validator(mode="after")
    def _resolved(self) -> StudyCard:
        """Refuse too many readings, and a tolerance below the rounding of the drive's temperatures."""
        check_readings(self.drive.end, self.output.every, "output.every")
        given = [self.drive.initial, *(end for p in self.drive.phases for end in (p.ambient.start, p.ambient.end))]
        least = smallest_tolerance(max(map(abs, given)))
        tolerances = {"numerics.tolerance": self.numerics.tolerance}
        if self.mechanics.feedback is not None:
            tolerances["mechanics.feedback.tolerance"] = self.mechanics.feedback.tolerance
        for field, tolerance in tolerances.items():
            if tolerance < least:
                message = f"{tolerance:g} K is below the rounding of temperatures: must be at least {least:.0e} K"
                raise InputError(message, field=field)
        return self
