"""A physical effect that a model may lack: its parameters, and the port of the model where it enters."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from tyrefem.cards import Card, Text
from tyrefem.effects.port import port, ports_of
from tyrefem.effects.signature import Signature
from tyrefem.effects.state import EffectState, TemperaturesOfTyre, Values
from tyrefem.effects.tyre import StudyOfTyre, Tyre
from tyrefem.errors import InputError, nearest
from tyrefem.quantity import Unit, convert

if TYPE_CHECKING:
    from tyrefem.conduction import Radiation
    from tyrefem.geometry import Section

Array = NDArray[np.float64]
Factor = float | Array

#: Films that an effect may change: H_c of the contact, the outside air, the same on the tread alone, gas, rim.
FILMS = ("road", "outside_air", "tread_air", "contained_air", "rim")
#: Temperatures that an effect may shift.
SINKS = ("road", "outside_air", "rim")
#: Surfaces that a flux may enter through.
SURFACES = ("road", "outside_air", "contained_air", "rim")


@dataclass(frozen=True)
class Prior:
    """Annotation of an effect's parameter: its unit, and what is known of it before any data. SI.

    ``Annotated[float, Prior("W/m**2", "...", scale=500.0, low=0.0, high=1400.0)]`` accepts ``"0.5 kW/m**2"``.

    Parameters
    ----------
    unit, meaning : unit in a study file; one line.
    scale : standard deviation of the prior about ``null``, the value at which the effect is not there.
    low, high : bounds; physics forbids what lies beyond (the sign, for most).
    start : where a fit begins, for a parameter that only shapes the effect (``amplitude`` False).
    written : unit in which people write it, where that is not ``unit``: ``deg`` for ``rad``.

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
        """A value (SI) as it is written in a study file."""
        unit = self.written or self.unit
        number = value if unit == self.unit else convert(value, self.unit, unit)
        return f"{number:.{digits}g}{'' if unit == '1' else f' {unit}'}"

    @property
    def origin(self) -> float:
        """Where a fit measures the parameter from: the null of an amplitude, the start of a shape."""
        return self.null if self.amplitude or self.start is None else self.start

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        # "40 delta_degC/hour" must not fail at a bound of 40/3600 for its last digits.
        low, high = self.low - 1e-9 * abs(self.low), self.high + 1e-9 * abs(self.high)
        return core_schema.no_info_plain_validator_function(Unit(self.unit, ge=low, le=high))


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect by name."""

    name: str
    prior: Prior


class Effect(Card):
    """Base of all effects; a subclass in a module of this package, or of a folder the user names, registers itself.

    A subclass sets ``name``, ``sentence``, ``source``, its parameters as fields annotated with a `Prior`, and
    overrides the port (method) where it enters. Every port is given the tyre in its surroundings (speed, load
    cases, section). Effects combine as (base + sum of addends) x product of factors, so their order does not matter;
    one whose amplitudes are all null is left out, and the run is then the same to the bit.
    """

    @classmethod
    def __pydantic_init_subclass__(cls, **options: Any) -> None:
        """Refuse a class that lacks what an effect must say of itself."""
        if cls.name:
            complaint = _complaint(cls)
            if complaint:
                raise InputError(f"effect '{cls.name}': {complaint}")

    kind: ClassVar[str] = "effect"
    #: Name in study files; one sentence for people; where the effect is described; heat, conduction, boundary...
    name: ClassVar[str] = ""
    sentence: ClassVar[str] = ""
    source: ClassVar[str] = ""
    family: ClassVar[str] = ""
    #: What shows it, for its picture and its tests.
    signature: ClassVar[Signature] = Signature()
    #: Does it leave the tyre rolling freely and straight, unworn? Else a report says that this stands beside the model.
    free_rolling: ClassVar[bool] = True
    #: A correction of a base number: fitted along in a diagnosis, never named as missing.
    calibration: ClassVar[bool] = False
    #: What it does to films, sinks and the rim depends on time through the drive alone: constant where the drive is.
    of_drive: ClassVar[bool] = False
    #: States that the effect keeps through a run, by name; its ports read them by ``tyre.state(self, name, t)``.
    states: ClassVar[Mapping[str, EffectState]] = {}
    #: Boundaries that the ports `flux` and `radiation` may use.
    surfaces: ClassVar[tuple[str, ...]] = SURFACES

    #: Where the values come from, and their standard deviations: said by who wrote the study, used by nobody.
    provenance: Text | None = Field(default=None, alias="from")
    sd: dict[str, Any] = Field(default_factory=dict)

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
        """What tells this variant from others of the same effect: the sensor's name, say."""
        return {}

    @property
    def is_null(self) -> bool:
        """Are all amplitudes at the value where the effect is not there?"""
        amplitudes = [parameter for parameter in self.parameters() if parameter.prior.amplitude]
        return bool(amplitudes) and all(
            getattr(self, parameter.name) == parameter.prior.null for parameter in amplitudes
        )

    @classmethod
    def overrides(cls, port: str) -> bool:
        """Does the effect enter at this port?"""
        return getattr(cls, port) is not getattr(Effect, port)

    @classmethod
    def ports(cls) -> tuple[str, ...]:
        """The ports where the effect enters."""
        return tuple(port.name for port in PORTS if cls.overrides(port.name))

    @classmethod
    def only_measures(cls) -> bool:
        """Does it change what is measured, and nothing of the tyre?"""
        return all(port.changes == "measurement" for port in PORTS if cls.overrides(port.name))

    @classmethod
    def refusal(cls, study: StudyOfTyre) -> str | None:
        """Why the effect has no meaning in a study; None where it has."""
        return None

    def problem(self, study: StudyOfTyre) -> str | None:
        """What is wrong with this effect in a study: no meaning there, or a choice (a sensor) that it does not have."""
        return self.refusal(study)

    @classmethod
    def variants(cls, study: StudyOfTyre) -> tuple[Mapping[str, str], ...]:
        """The choices (a sensor's name, say) to try in a study, one mapping each."""
        return ({},)

    # -- states ------------------------------------------------------------------------------------------------------

    def initial_states(self, tyre: Tyre) -> Values:
        """State -> its value at the start of the drive: a number, or (n,) with one value per place."""
        return dict.fromkeys(self.states, 0.0)

    def state_rates(self, tyre: Tyre, t: float, state: Values, temperatures: TemperaturesOfTyre) -> Values:
        """State -> d(state)/dt, per second, shaped as the state, at time t (s).

        The states are unknowns of the same equations as the temperatures: one error-controlled step of third order
        takes both, so that the rate may be any smooth function of ``state`` and ``temperatures``.
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
        """W/m2/K added to one of `FILMS` at time t (s)."""
        return 0.0

    @port("resistance in series with a film", changes="surroundings")
    def film_resistance(self, tyre: Tyre, film: str, t: float) -> float:
        """m2 K/W in series with one of `FILMS` at time t (s): 1/h -> 1/h + R."""
        return 0.0

    @port("shift of a surrounding temperature", changes="surroundings")
    def sink_addend(self, tyre: Tyre, sink: str, t: float) -> float:
        """K added to the temperature of one of `SINKS` at time t (s)."""
        return 0.0

    @port("flux through a surface")
    def flux(self, tyre: Tyre, surface: str, x: Array, t: float) -> Factor:
        """W/m2 into the tyre through one of `SURFACES` at points x (2, n) and time t (s)."""
        return 0.0

    @port("radiation of a surface")
    def radiation(self, tyre: Tyre, surface: str) -> Radiation | None:
        """Radiation of one of `SURFACES`; None for none."""
        return None

    @port("factor on the contained air's heat capacity")
    def gas_capacity_factor(self, tyre: Tyre) -> float:
        """Factor on the heat capacity of the contained air."""
        return 1.0

    @port("power into a lumped rim", changes="surroundings")
    def rim_power(self, tyre: Tyre, t: float) -> float:
        """W put into the whole wheel's lumped rim at time t (s)."""
        return 0.0

    # -- ports: section and measurement ------------------------------------------------------------------------------

    @port("the section")
    def worn(self, section: Section) -> Section:
        """The section as it is in truth."""
        return section

    @port("place of a sensor", changes="measurement")
    def displacement(self, sensor: str) -> tuple[float, float]:
        """How far a sensor sits from its stated place: along the meridian and in depth, m."""
        return 0.0, 0.0

    @port("lag of a sensor", changes="measurement")
    def lag_addend(self, sensor: str) -> float:
        """s added to a sensor's lag."""
        return 0.0

    @port("offset of a sensor", changes="measurement")
    def offset(self, sensor: str) -> float:
        """K that a sensor shows too much."""
        return 0.0

    @port("the logger's clock", changes="measurement")
    def clock(self) -> float:
        """s by which the logger's clock is late: what it calls t was measured at t + clock."""
        return 0.0

    @port("the logger's channels", changes="measurement")
    def channel(self, sensor: str) -> str:
        """The sensor whose temperature is recorded under a sensor's name."""
        return sensor


#: The ports, in the order of their methods.
PORTS = ports_of(Effect)
#: What an effect may change.
FAMILIES = ("heat", "conduction", "boundary", "section", "asymmetry", "measurement", "calibration")


def _complaint(cls: type[Effect]) -> str | None:
    """What an effect's class forgot."""
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
    if not cls.ports():
        return f"overrides no port; allowed: {', '.join(port.name for port in PORTS)}"
    for name, field in cls.model_fields.items():
        prior = next((item for item in field.metadata if isinstance(item, Prior)), None)
        if prior is None:
            continue
        begin = prior.null if prior.amplitude else prior.start
        if begin is None or not prior.low <= begin <= prior.high:
            return f"parameter '{name}' must begin from {prior.low:g} to {prior.high:g}, not at {begin}"
        if not 0 < prior.scale < np.inf:
            return f"parameter '{name}' needs a positive scale"
        if field.default != begin:
            return f"parameter '{name}' must have the default {begin:g}"
    return None
