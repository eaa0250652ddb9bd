"""A physical effect that a model may lack: its parameters, and the ports where it acts on the model."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, GetCoreSchemaHandler, GetJsonSchemaHandler, model_validator
from pydantic_core import CoreSchema, core_schema

from tyrefem.cards import Card, Text
from tyrefem.effects.port import port, ports_of
from tyrefem.effects.signature import Signature
from tyrefem.effects.state import EffectState, TemperaturesOfTyre, Values
from tyrefem.effects.tyre import StudyOfTyre, Tyre
from tyrefem.errors import InputError, nearest
from tyrefem.plugins.kind import Kind, is_ours
from tyrefem.quantity import Unit, convert

if TYPE_CHECKING:
    from tyrefem.conduction import Radiation
    from tyrefem.geometry import Section

Array = NDArray[np.float64]
Factor = float | Array

#: Films that an effect may change: H_c of the contact, outside air, outside air at the tread only, gas, rim.
FILMS = ("road", "outside_air", "tread_air", "contained_air", "rim")
#: Temperatures that an effect may shift.
SINKS = ("road", "outside_air", "rim")
#: Surfaces for a flux.
SURFACES = ("road", "outside_air", "contained_air", "rim")


def _run_names(value: Any) -> Any:
    if not isinstance(value, list | tuple) or not value:
        raise InputError(f"must be a list of names of measured runs, such as ['run-2'], not {value!r:.40}")
    return tuple(value)


@dataclass(frozen=True)
class Prior:
    """Annotation of an effect's parameter: its unit and prior. SI.

    ``Annotated[float, Prior("W/m**2", "...", scale=500.0, low=0.0, high=1400.0)]`` accepts ``"0.5 kW/m**2"``.

    Parameters
    ----------
    unit, meaning : unit in a study file; meaning in one line.
    scale : standard deviation of the prior about `origin`.
    low, high : physical bounds (for most parameters, on the sign).
    null : value of an amplitude at which the effect is absent.
    start : of a shape parameter (``amplitude`` False) in place of ``null``: start value of a fit, and its default.
    written : unit of a study file, if it is not ``unit``: ``deg`` for ``rad``.

    >>> Prior("m", "along the meridian", 4e-3, -0.02, 0.02, written="mm").text(0.0025)
    '2.5 mm'
    """

    unit: str
    meaning: str
    scale: float
    low: float
    high: float
    null: float = 0.0
    start: float | None = None
    amplitude: bool = True
    written: str | None = None

    def text(self, value: float, digits: int = 4) -> str:
        """A value (SI) as text of a study file."""
        unit = self.written or self.unit
        number = value if unit == self.unit else convert(value, self.unit, unit)
        return f"{number:.{digits}g}{'' if unit == '1' else f' {unit}'}"

    @property
    def usual(self) -> float:
        """The value one standard deviation from ``null``, on an allowed side and within the bounds.

        >>> Prior("W/m**2", "cooling", 200.0, -9000.0, 0.0).usual, Prior("1", "gain", 2.0, 0.0, 20.0).usual
        (-200.0, 2.0)
        """
        if self.high > self.null:
            return min(self.null + self.scale, self.high)
        return max(self.null - self.scale, self.low)

    @property
    def origin(self) -> float:
        """Origin of the parameter in a fit: the null of an amplitude, the start of a shape."""
        return self.null if self.amplitude or self.start is None else self.start

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self._read)

    @property
    def _read(self) -> Unit:
        # Rounding must not refuse "40 delta_degC/hour" at a bound of 40/3600.
        low, high = self.low - 1e-9 * abs(self.low), self.high + 1e-9 * abs(self.high)
        return Unit(self.unit, ge=low, le=high)

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        meaning = f"{self.meaning[:1].upper()}{self.meaning[1:]}."
        return {
            **self._read.schema(),
            "description": meaning if self.amplitude else f"{meaning} Start of a fit: {self.text(self.start or 0.0)}.",
            "x-quantity": {"unit": self.unit, "ge": self.low, "le": self.high, "written": self.written},
        }


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect: name and prior."""

    name: str
    prior: Prior


class Effect(Card):
    """Base of all effects; a subclass in a module of this package, or of a user's plugin, registers itself.

    A subclass sets ``name``, ``sentence``, ``source``, its parameters as fields annotated with a `Prior`, and
    overrides the ports (methods) where it acts. Ports receive the tyre in its surroundings (speed, load cases,
    section). Effects combine as (base + sum of addends) x product of factors, so their order has no influence. An
    effect with all amplitudes at null is left out; the run is then the same to the last bit.
    """

    @classmethod
    def __pydantic_init_subclass__(cls, **options: Any) -> None:
        """Refuse a class that lacks a required attribute of an effect; `tyrefem.plugins` judges the user's."""
        if cls.name and is_ours(cls):
            wrong = complaint(cls)
            if wrong:
                raise InputError(f"effect '{cls.name}': {wrong}")

    kind: ClassVar[str] = "effect"
    plugin_kind: ClassVar[Kind]
    #: Name in study files; one sentence; reference; family: heat, conduction, boundary...
    name: ClassVar[str] = ""
    sentence: ClassVar[str] = ""
    source: ClassVar[str] = ""
    family: ClassVar[str] = ""
    #: The sentence if the amplitude is negative; empty: ``sentence`` holds for both signs.
    opposite: ClassVar[str] = ""
    #: Study and sensors that show the effect, for its picture and its tests.
    signature: ClassVar[Signature] = Signature()
    #: True if the tyre still rolls freely and straight, without wear; else a report states the effect as an addition.
    free_rolling: ClassVar[bool] = True
    #: True for a correction of a base number: a diagnosis fits it, but never names it as missing.
    calibration: ClassVar[bool] = False
    #: True if it may differ from one measured run to another, as road and weather do: a diagnosis also tries it in
    #: single runs.
    of_the_day: ClassVar[bool] = False
    #: True if its action on films, sinks and rim depends on time only through the drive.
    of_drive: ClassVar[bool] = False
    #: True if its factor on the heat depends on place only, not on time or temperature: it is then kept by place.
    of_place: ClassVar[bool] = False
    #: False if its addend to the heat or factor on it is the same at all temperatures: it is then kept by time.
    heat_of_temperature: ClassVar[bool] = True
    #: Times of the drive, within a phase, at which a port jumps, s: simulations end a step there. A property, if a
    #: parameter says when.
    jumps: ClassVar[tuple[float, ...]] = ()
    #: States of the effect during a run, by name; its ports read them by ``tyre.state(self, name, t)``.
    states: ClassVar[Mapping[str, EffectState]] = {}
    #: Boundaries that the ports `flux` and `radiation` may use.
    surfaces: ClassVar[tuple[str, ...]] = SURFACES

    #: Origin of the values, and their standard deviations, stated by the study: a diagnosis fits values within them.
    provenance: Text | None = Field(default=None, alias="from")
    sd: dict[str, Any] = Field(default_factory=dict)
    #: Names of the measured runs in which the effect acts; None: in every run, and in a drive that is no measured run.
    runs: Annotated[tuple[Text, ...], BeforeValidator(_run_names)] | None = None

    @model_validator(mode="after")
    def _check_deviations(self) -> Effect:
        """Refuse a standard deviation of no parameter, or that is none: a diagnosis would leave it out unseen."""
        if not self.sd:
            return self
        units = {parameter.name: parameter.prior.unit for parameter in self.parameters()}
        for name, deviation in self.sd.items():
            if name not in units:
                raise InputError(f"'{name}' is no number of this effect{nearest(name, units)}", field="sd")
            try:
                Unit(units[name], ge=0)(deviation)
            except InputError as error:
                raise error.within(field=f"sd.{name}") from None
        return self

    # -- parameters --------------------------------------------------------------------------------------------------

    @classmethod
    @functools.cache
    def parameters(cls) -> tuple[Parameter, ...]:
        """The parameters with unit and prior, amplitudes first."""
        parameters = []
        for name, field in cls.model_fields.items():
            parameters += [Parameter(name, item) for item in field.metadata if isinstance(item, Prior)]
        return tuple(sorted(parameters, key=lambda parameter: not parameter.prior.amplitude))

    @property
    def values(self) -> dict[str, float]:
        """Parameter -> value, SI."""
        return {parameter.name: float(getattr(self, parameter.name)) for parameter in self.parameters()}

    @property
    def choice(self) -> dict[str, str]:
        """The choices of this variant of the effect, such as the sensor's name."""
        return {}

    @property
    def label(self) -> tuple[str, ...]:
        """Name and choices of the effect, and the runs in which it acts if these are not all."""
        return (self.name, *self.choice.values(), *(("in", ", ".join(self.runs)) if self.runs else ()))

    def acts_in(self, run: str | None) -> bool:
        """Whether the effect acts in a measured run; None: in a drive that is no measured run."""
        return self.runs is None or run in self.runs

    @property
    def is_null(self) -> bool:
        """True if all amplitudes are at null, where the effect is absent."""
        amplitudes = [parameter for parameter in self.parameters() if parameter.prior.amplitude]
        return bool(amplitudes) and all(
            getattr(self, parameter.name) == parameter.prior.null for parameter in amplitudes
        )

    @classmethod
    @functools.cache
    def overrides(cls, port: str) -> bool:
        """True if the effect acts at this port."""
        return getattr(cls, port) is not getattr(Effect, port)

    @classmethod
    def ports(cls) -> tuple[str, ...]:
        """The ports where the effect acts."""
        return tuple(port.name for port in PORTS if cls.overrides(port.name))

    @classmethod
    def only_measures(cls) -> bool:
        """True if the effect changes only measurements, and not the tyre."""
        return all(port.changes == "measurement" for port in PORTS if cls.overrides(port.name))

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """Reason why the effect is not possible in a study; None if it is possible."""
        return None

    @classmethod
    def caution(cls, study: StudyOfTyre) -> str | None:
        """What a person should know of the effect in a study, as a warning; None: nothing."""
        return None

    @classmethod
    def beside_pressing(cls, study: StudyOfTyre) -> str | None:
        """`caution` beside a strain law that presses the tyre on the road itself (``StrainLaw.presses``)."""
        return None

    def problem(self, study: StudyOfTyre) -> str | None:
        """Error of this effect in a study (not possible there, or unknown choice such as a sensor), or None."""
        return self.refusal(study)

    @classmethod
    def variants(cls, study: StudyOfTyre) -> tuple[Mapping[str, str], ...]:
        """The variants of the effect in a study: one mapping of choices, such as the sensor's name, each."""
        return ({},)

    # -- states ------------------------------------------------------------------------------------------------------

    def initial_states(self, tyre: Tyre) -> Values:
        """State -> its value at the start of the drive: a number, or (n,) with one value per place."""
        return dict.fromkeys(self.states, 0.0)

    def state_rates(self, tyre: Tyre, t: float, state: Values, temperatures: TemperaturesOfTyre) -> Values:
        """State -> d(state)/dt, per second, shaped as the state, at time t (s).

        States and temperatures are unknowns of the same error-controlled time step of third order, so the rate may be
        any smooth function of ``state`` and ``temperatures``.
        """
        return dict.fromkeys(self.states, 0.0)

    # -- ports: heat and conduction ----------------------------------------------------------------------------------

    @port("factor on the heat source")
    def heat_factor(self, tyre: Tyre, zone: str, x: Array, t: float, T: Array) -> Factor:
        """Factor on the heat source of a strain zone at points x (2, n), time t (s), temperatures T (n,), degC."""
        return 1.0

    @port("addend to the heat source")
    def heat_addend(self, tyre: Tyre, zone: str, x: Array, t: float, T: Array) -> Factor:
        """Heat added to a strain zone's source, W/m3; arguments as of `heat_factor`."""
        return 0.0

    @port("factor on the conductivity")
    def conductivity_factor(self, tyre: Tyre, region: str, T: Array) -> tuple[Factor, Factor]:
        """Factors on the conductivity along and across the plies at temperatures T (n,), degC."""
        return 1.0, 1.0

    @port("factor on the heat capacity")
    def capacity_factor(self, tyre: Tyre, region: str, T: Array) -> Factor:
        """Factor on the volumetric heat capacity at temperatures T (n,), degC."""
        return 1.0

    # -- ports: boundaries -------------------------------------------------------------------------------------------

    @port("factor on films", changes="surroundings")
    def film_factor(self, tyre: Tyre, film: str, t: float) -> float:
        """Factor on one of `FILMS` at time t (s)."""
        return 1.0

    @port("addend to films", changes="surroundings")
    def film_addend(self, tyre: Tyre, film: str, t: float) -> float:
        """Addend to one of `FILMS` at time t (s), W/m2/K."""
        return 0.0

    @port("resistance in series with a film", changes="surroundings")
    def film_resistance(self, tyre: Tyre, film: str, t: float) -> float:
        """Resistance in series with one of `FILMS` at time t (s), m2 K/W: 1/h -> 1/h + R."""
        return 0.0

    @port("shift of a surrounding temperature", changes="surroundings")
    def sink_addend(self, tyre: Tyre, sink: str, t: float) -> float:
        """Shift of the temperature of one of `SINKS` at time t (s), K."""
        return 0.0

    @port("flux through a surface")
    def flux(self, tyre: Tyre, surface: str, x: Array, t: float) -> Factor:
        """Heat flux into the tyre through one of `SURFACES` at points x (2, n) and time t (s), W/m2."""
        return 0.0

    @port("radiation of a surface")
    def radiation(self, tyre: Tyre, surface: str) -> Radiation | None:
        """Radiation of one of `SURFACES`; None: no radiation."""
        return None

    @port("factor on the contained air's heat capacity")
    def gas_capacity_factor(self, tyre: Tyre) -> float:
        """Factor on the heat capacity of the contained air."""
        return 1.0

    @port("power into a lumped rim", changes="surroundings")
    def rim_power(self, tyre: Tyre, t: float) -> float:
        """Power into the whole wheel's lumped rim at time t (s), W."""
        return 0.0

    # -- ports: section and measurement ------------------------------------------------------------------------------

    @port("the section")
    def worn(self, section: Section) -> Section:
        """The real section, such as the worn section."""
        return section

    @port("place of a sensor", changes="measurement")
    def displacement(self, sensor: str) -> tuple[float, float]:
        """Displacement of a sensor from its stated place: along the meridian and in depth, m."""
        return 0.0, 0.0

    @port("lag of a sensor", changes="measurement")
    def lag_addend(self, sensor: str) -> float:
        """Addend to a sensor's lag, s."""
        return 0.0

    @port("offset of a sensor", changes="measurement")
    def offset(self, sensor: str) -> float:
        """Offset of a sensor's readings, K."""
        return 0.0

    @port("the logger's clock", changes="measurement")
    def clock(self) -> float:
        """Delay of the logger's clock, s: readings of logged time t were measured at t + clock."""
        return 0.0

    @port("the logger's channels", changes="measurement")
    def channel(self, sensor: str) -> str:
        """The sensor whose temperature is recorded under the name of ``sensor``."""
        return sensor


#: The ports, in the order of their methods.
PORTS = ports_of(Effect)
#: What an effect may change.
FAMILIES = ("heat", "conduction", "boundary", "section", "asymmetry", "measurement", "calibration")


def complaint(cls: type[Effect]) -> str | None:
    """Error of an effect's class, or None."""
    for attribute in ("sentence", "source", "family"):
        if not getattr(cls, attribute):
            return f"needs '{attribute}'"
    if cls.family not in FAMILIES:
        return f"unknown family '{cls.family}'{nearest(cls.family, FAMILIES)}"
    if cls.states and cls.state_rates is Effect.state_rates:
        return f"declares states ({', '.join(cls.states)}), but no 'state_rates'"
    for name, state in cls.states.items():
        if not state.scale > 0:
            return f"state '{name}' needs a positive scale"
    wrong = _wrong_surfaces(cls.surfaces) or _wrong_jumps(cls.jumps)
    if wrong:
        return wrong
    if not cls.ports():
        return f"overrides no port; allowed: {', '.join(port.name for port in PORTS)}"
    for name, field in cls.model_fields.items():
        prior = next((item for item in field.metadata if isinstance(item, Prior)), None)
        if prior is None:
            continue
        begin = prior.null if prior.amplitude else prior.start
        if begin is None or not prior.low <= begin <= prior.high:
            which = f"'null' is {begin:g}" if prior.amplitude else f"'start' is {begin}"
            return (
                f"parameter '{name}': {which}, outside its bounds {prior.low:g} to {prior.high:g}; 'null' is the value "
                "at which the effect is absent; a period or a place has none: Prior(..., start=VALUE, amplitude=False)"
            )
        if not 0 < prior.scale < np.inf:
            return f"parameter '{name}' needs a positive scale"
        if field.default != begin:
            return f"parameter '{name}' must have the default {begin:g}"
    return None


def _wrong_surfaces(surfaces: Any) -> str | None:
    """What is wrong with a class's surfaces: at an unknown one an effect would do nothing."""
    if isinstance(surfaces, property | functools.cached_property):  # of each study
        return None
    if not isinstance(surfaces, tuple | list):
        return f"'surfaces' must be a tuple of names, such as ('road',), not {surfaces!r:.40}"
    unknown = next((name for name in surfaces if name not in SURFACES), None)
    return None if unknown is None else f"unknown surface {unknown!r:.40}{nearest(str(unknown), SURFACES)}"


def _wrong_jumps(jumps: Any) -> str | None:
    """What is wrong with a class's jumps: a run ends a time step at each of them."""
    if isinstance(jumps, property | functools.cached_property):  # of each effect
        return None
    if isinstance(jumps, tuple | list) and all(isinstance(time, int | float) for time in jumps):
        return None
    return f"'jumps' must be a tuple of times in seconds, such as (300.0,), not {jumps!r:.40}"


def wrong_unit(cls: type[Effect]) -> str | None:
    """The first parameter of an effect's class whose unit cannot be read, or None."""
    for parameter in cls.parameters():
        prior = parameter.prior
        if not prior.unit:
            return f"parameter '{parameter.name}' needs a unit: '1' for a pure number"
        try:
            Unit(prior.unit)(prior.text(prior.origin))
        except InputError as error:
            return f"parameter '{parameter.name}': {error.message}"
    return None
