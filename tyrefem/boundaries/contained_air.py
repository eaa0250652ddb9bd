"""The gas inside the tyre: one temperature, heated by the inner surface."""

from __future__ import annotations

from abc import abstractmethod
from typing import Annotated, ClassVar, Literal

from tyrefem.boundaries import CAL, Law
from tyrefem.cards import FilmCoefficient, Temperature
from tyrefem.cards.plausible import AIR_FILM, GAS_HEAT
from tyrefem.quantity import Unit

#: Specific gas constant of dry air, J/kg/K (R / M = 8.314462618 / 0.0289652; M: CIPM-2007).
GAS_CONSTANT = 8.314462618 / 0.0289652
ATMOSPHERE = 101325.0
KELVIN = 273.15


class ContainedAirLaw(Law):
    """Film from the inner surface to the gas, and the gas's heat capacity.

    m c dTg/dt = sum of h A (T - Tg) over the inner surface   (Clark & Dodge 1980, eq G1)
    """

    side: ClassVar[str] = "contained_air"
    #: 1e-4 cal/(cm2 s K), appendix I: gentle mixing by the carcass's motion.
    film: Annotated[FilmCoefficient, AIR_FILM] = 1e-4 * CAL
    #: Initial temperature; by default the drive's initial temperature.
    initial: Temperature | None = None

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


class Gas(ContainedAirLaw):
    """The real mass of gas, m = p V / (R T), at constant volume: c = c_v = 718 J/kg/K for air."""

    law: Literal["gas"]
    specific_heat: Annotated[float, Unit("J/kg/K", gt=0), GAS_HEAT] = 718.0
    gas_constant: Annotated[float, Unit("J/kg/K", gt=0)] = GAS_CONSTANT

    def heat_capacity(self, volume: float, pressure: float, temperature: float) -> float:
        """m c_v, J/K."""
        mass = (pressure + ATMOSPHERE) * volume / (self.gas_constant * (temperature + KELVIN))
        return mass * self.specific_heat


class Report(ContainedAirLaw):
    """The report's air: 0.0013 g/cm3 and 0.24 cal/g/K at any inflation pressure (appendix I)."""

    law: Literal["report"]
    density: Annotated[float, Unit("kg/m**3", gt=0)] = 1.3
    specific_heat: Annotated[float, Unit("J/kg/K", gt=0), GAS_HEAT] = 0.24 * 4184.0

    def heat_capacity(self, volume: float, pressure: float, temperature: float) -> float:
        """rho V c_p, J/K."""
        return self.density * volume * self.specific_heat


class Held(ContainedAirLaw):
    """A gas of constant ``temperature``, as measured or of a large reservoir."""

    law: Literal["held"]
    temperature: Temperature

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
