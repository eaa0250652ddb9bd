"""The effects at work in a tyre, combined: (base + sum of addends) x product of factors."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction import Flux, Radiation
from tyrefem.effects.effect import PORTS, Effect
from tyrefem.effects.tyre import Tyre

Array = NDArray[np.float64]
Source = Callable[[Array, float, Array], Array]
#: Ports that act on what surrounds the tyre.
SURROUNDING = tuple(port.name for port in PORTS if port.changes == "surroundings")


@dataclass(frozen=True, eq=False)
class Acting:
    """What a tyre's effects make of a quantity of the model."""

    tyre: Tyre
    effects: tuple[Effect, ...]

    def at(self, *ports: str) -> tuple[Effect, ...]:
        """The effects that enter at one of these ports."""
        if ports not in self._entering:
            entering = tuple(one for one in self.effects if any(one.overrides(port) for port in ports))
            self._entering[ports] = entering
        return self._entering[ports]

    @functools.cached_property
    def _entering(self) -> dict[tuple[str, ...], tuple[Effect, ...]]:
        return {}

    @property
    def changes_films(self) -> bool:
        """Does any effect touch a film?"""
        return bool(self.at("film_factor", "film_addend", "film_resistance"))

    @functools.cached_property
    def with_states(self) -> tuple[Effect, ...]:
        """The effects that keep states through a run."""
        return tuple(one for one in self.effects if one.states)

    @property
    def follows_drive(self) -> bool:
        """Do films, sinks and the rim's power depend on time through the drive alone?"""
        return all(one.of_drive for one in self.at(*SURROUNDING))

    def film(self, film: str, t: float, base: float) -> float:
        """A film at a time, W/m2/K: sums, then factors, then resistances in series."""
        for one in self.at("film_addend"):
            base = base + one.film_addend(self.tyre, film, t)
        for one in self.at("film_factor"):
            base = base * one.film_factor(self.tyre, film, t)
        resistance = sum(one.film_resistance(self.tyre, film, t) for one in self.at("film_resistance"))
        return base / (1 + base * resistance) if resistance else base

    def sink(self, sink: str, t: float, base: float) -> float:
        """A surrounding temperature at a time, degC."""
        return base + sum(one.sink_addend(self.tyre, sink, t) for one in self.at("sink_addend"))

    def source(self, zone: str, base: Source) -> Source:
        """The heat source of a zone with every effect on it."""
        addends, factors, tyre = self.at("heat_addend"), self.at("heat_factor"), self.tyre
        if not addends and not factors:
            return base

        def heat(x: Array, t: float, T: Array) -> Array:
            q = base(x, t, T)
            for one in addends:
                q = q + one.heat_addend(tyre, zone, x, t, T)
            for one in factors:
                q = q * one.heat_factor(tyre, zone, x, t, T)
            return q

        return heat

    def conductivity(self, region: str, law: Any) -> Any:
        """Conductivity of a region as `tyrefem.conduction.Material` takes it."""
        factors = self.at("conductivity_factor")
        if not factors:
            return law

        def k(T: Array) -> tuple[Any, Any]:
            value = law(T) if callable(law) else law
            along, across = value if isinstance(value, tuple) else (value, value)
            for one in factors:
                first, second = one.conductivity_factor(self.tyre, region, T)
                along, across = along * first, across * second
            return along, across

        if not callable(law):
            cold, hot = k(np.array([0.0])), k(np.array([100.0]))
            if all(np.ndim(value) == 0 for value in (*cold, *hot)) and cold == hot:
                return cold
        return k

    def capacity(self, region: str, law: Any) -> Any:
        """Heat capacity of a region as `tyrefem.conduction.Material` takes it."""
        factors = self.at("capacity_factor")
        if not factors:
            return law

        def capacity(T: Array) -> Any:
            value = law(T) if callable(law) else law
            for one in factors:
                value = value * one.capacity_factor(self.tyre, region, T)
            return value

        return capacity

    def gas_capacity(self, base: float) -> float:
        """Heat capacity of the contained air, J/K."""
        for one in self.at("gas_capacity_factor"):
            base = base * one.gas_capacity_factor(self.tyre)
        return base

    def rim_power(self, t: float) -> float:
        """W that effects put into the whole wheel's lumped rim at a time."""
        return sum(one.rim_power(self.tyre, t) for one in self.at("rim_power"))

    def conditions(self, surface: str) -> list[tuple[str, Any]]:
        """Fluxes and radiation that effects add to a boundary, each with a name for the heat budget."""
        found: list[tuple[str, Any]] = []
        for one in self.effects:
            if surface not in one.surfaces:
                continue
            label = " ".join([one.name, *one.choice.values(), "on the", surface.replace("_", " ")])
            if one.overrides("flux"):
                found.append((label, Flux(_flux_of(one, self.tyre, surface))))
            if one.overrides("radiation"):
                radiation: Radiation | None = one.radiation(self.tyre, surface)
                found += [] if radiation is None else [(label, radiation)]
        return found


def _flux_of(effect: Effect, tyre: Tyre, surface: str) -> Callable[[Array, float], Any]:
    return lambda x, t: effect.flux(tyre, surface, x, t)
