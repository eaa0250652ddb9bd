"""The gas inside the tyre: one temperature, heated by the inner surface."""

from __future__ import annotations

import functools
from abc import abstractmethod
from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

from tyrefem.boundaries import CAL, FILM, Law
from tyrefem.cards import FilmCoefficient, Warmth
from tyrefem.cards.plausible import AIR_FILM, GAS_DENSITY, GAS_HEAT
from tyrefem.cards.plausible import GAS_CONSTANT as LIKELY_GAS_CONSTANT
from tyrefem.errors import InputWarning
from tyrefem.plugins import Range, Trial, trial
from tyrefem.quantity import KELVIN, Unit

#: Specific gas constant of dry air, J/kg/K (R / M = 8.314462618 / 0.0289652; M: CIPM-2007).
GAS_CONSTANT = 8.314462618 / 0.0289652
ATMOSPHERE = 101325.0


class ContainedAirLaw(Law):
    """Film from the inner surface to the gas, and the gas's heat capacity.

    m c dTg/dt = sum of h A (T - Tg) over the inner surface   (Clark & Dodge 1980, eq G1)
    """

    side: ClassVar[str] = "contained_air"
    #: 1e-4 cal/(cm2 s K), appendix I: gentle mixing by the carcass's motion.
    film: Annotated[FilmCoefficient, AIR_FILM] = 1e-4 * CAL
    #: Initial temperature; by default the drive's initial temperature.
    initial: Warmth | None = None

    def start(self, initial: float) -> float:
        """Initial temperature of the gas, degC, for the initial temperature of the drive."""
        return initial if self.initial is None else self.initial

    @property
    def fixed_temperature(self) -> float:
        """Temperature of a gas without a heat capacity, degC. A law with a fixed gas temperature overrides it.

        Raises
        ------
        NotImplementedError : the gas has a heat capacity; its temperature follows from a run.
        """
        raise NotImplementedError(f"the contained air's law '{self.law}' does not hold its temperature")

    @abstractmethod
    def heat_capacity(self, volume: float, pressure: float, temperature: float) -> float | None:
        """J/K of a volume (m3) filled to a gauge pressure (Pa) at a temperature (degC); None: fixed temperature."""

    def trials(self) -> Iterator[Trial]:
        """Start, film, and heat capacity, or the temperature of a gas without one."""
        yield trial("start(25 degC)", lambda: self.start(25.0), Range("degC", -KELVIN))
        yield trial("film", lambda: self.film, FILM)
        for pressure in (0.0, 2e5, 1.5e6):
            words = f"heat_capacity(0.03 m3, {pressure:g} Pa, 25 degC)"
            capacity = functools.partial(self._capacity, pressure)
            yield trial(words, capacity, Range("J/K", 0.0))

    def _capacity(self, pressure: float) -> float:
        """Heat capacity of 0.03 m3, J/K; the fixed temperature must be there where there is none."""
        capacity = self.heat_capacity(0.03, pressure, 25.0)
        return abs(self.fixed_temperature) if capacity is None else capacity


class Gas(ContainedAirLaw):
    """The real mass of gas, m = p V / (R T), at constant volume: c = c_v = 718 J/kg/K for air."""

    law: Literal["gas"]
    specific_heat: Annotated[float, Unit("J/kg/K", gt=0), GAS_HEAT] = 718.0
    gas_constant: Annotated[float, Unit("J/kg/K", gt=0), LIKELY_GAS_CONSTANT] = GAS_CONSTANT

    def heat_capacity(self, volume: float, pressure: float, temperature: float) -> float:
        """m c_v, J/K."""
        mass = (pressure + ATMOSPHERE) * volume / (self.gas_constant * (temperature + KELVIN))
        return mass * self.specific_heat


class Report(ContainedAirLaw):
    """The report's air: 0.0013 g/cm3 and 0.24 cal/g/K at any inflation pressure (appendix I)."""

    law: Literal["report"]
    density: Annotated[float, Unit("kg/m**3", gt=0), GAS_DENSITY] = 1.3
    specific_heat: Annotated[float, Unit("J/kg/K", gt=0), GAS_HEAT] = 0.24 * 4184.0

    def heat_capacity(self, volume: float, pressure: float, temperature: float) -> float:
        """rho V c_p, J/K."""
        return self.density * volume * self.specific_heat


class Held(ContainedAirLaw):
    """A gas of constant ``temperature``, as measured or of a large reservoir."""

    law: Literal["held"]
    temperature: Warmth

    def warnings(self) -> tuple[InputWarning, ...]:
        """An initial temperature, which a gas of constant temperature does not have."""
        if self.initial is None:
            return super().warnings()
        return (*super().warnings(), InputWarning("does not act: the gas keeps its 'temperature'", "initial"))

    @property
    def fixed_temperature(self) -> float:
        """The given temperature, degC."""
        return self.temperature

    def start(self, initial: float) -> float:
        """The given temperature, degC."""
        return self.temperature

    def heat_capacity(self, volume: float, pressure: float, temperature: float) -> None:
        """None: fixed temperature."""
        return
