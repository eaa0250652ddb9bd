"""Combination of the effects on a tyre: (base + sum of addends) x product of factors."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import Cache, Content
from tyrefem.conduction import Flux, Radiation
from tyrefem.effects.effect import PORTS, Effect
from tyrefem.effects.tyre import Tyre

Array = NDArray[np.float64]
Source = Callable[[Array, float, Array], Array]
#: Sets of points whose factors of place are kept, for each zone.
PLACES = 4
#: Ports that act on the tyre's surroundings.
SURROUNDING = tuple(port.name for port in PORTS if port.changes == "surroundings")


@dataclass(frozen=True, eq=False)
class Acting:
    """Quantities of the model, changed by a tyre's effects."""

    tyre: Tyre
    effects: tuple[Effect, ...]

    def at(self, *ports: str) -> tuple[Effect, ...]:
        """The effects that act at one of these ports."""
        if ports not in self._entering:
            entering = tuple(effect for effect in self.effects if any(effect.overrides(port) for port in ports))
            self._entering[ports] = entering
        return self._entering[ports]

    @functools.cached_property
    def _entering(self) -> dict[tuple[str, ...], tuple[Effect, ...]]:
        return {}

    @property
    def changes_films(self) -> bool:
        """True if an effect changes a film."""
        return bool(self.at("film_factor", "film_addend", "film_resistance"))

    @functools.cached_property
    def with_states(self) -> tuple[Effect, ...]:
        """The effects with states."""
        return tuple(effect for effect in self.effects if effect.states)

    @property
    def follows_drive(self) -> bool:
        """True if films, sinks and the rim's power depend on time only through the drive."""
        return all(effect.of_drive for effect in self.at(*SURROUNDING))

    def film(self, film: str, t: float, base: float) -> float:
        """A film at a time, W/m2/K: sums, then factors, then resistances in series."""
        for effect in self.at("film_addend"):
            base = base + effect.film_addend(self.tyre, film, t)
        for effect in self.at("film_factor"):
            base = base * effect.film_factor(self.tyre, film, t)
        resisting = self.at("film_resistance")
        resistance = sum(effect.film_resistance(self.tyre, film, t) for effect in resisting) if resisting else 0.0
        return base / (1 + base * resistance) if resistance else base

    def sink(self, sink: str, t: float, base: float) -> float:
        """A surrounding temperature at a time, degC."""
        return base + sum(effect.sink_addend(self.tyre, sink, t) for effect in self.at("sink_addend"))

    def source(self, zone: str, base: Source) -> Source:
        """The heat source of a zone, with all effects."""
        addends, factors, tyre = self.at("heat_addend"), self.at("heat_factor"), self.tyre
        if not addends and not factors:
            return base
        lasting = tuple(effect for effect in factors if effect.of_place)
        changing = tuple(effect for effect in factors if not effect.of_place)
        known = Cache[Array](PLACES)
        latest: list[tuple[Array, Array]] = []

        def heat(x: Array, t: float, T: Array) -> Array:
            q = base(x, t, T)
            for effect in addends:
                q = q + effect.heat_addend(tyre, zone, x, t, T)
            for effect in changing:
                q = q * effect.heat_factor(tyre, zone, x, t, T)
            return q * of_place(x, t, T) if lasting else q

        def of_place(x: Array, t: float, T: Array) -> Array:
            # Solvers pass the same array of points in every call, so that the search by value is rarely needed.
            points, factor = latest[0] if latest else (None, None)
            if factor is None or points is not x:
                factor = known.get(Content.of(x), lambda: product(x, t, T))
                latest[:] = [(x, factor)]
            return factor

        def product(x: Array, t: float, T: Array) -> Array:
            return np.asarray(math.prod(effect.heat_factor(tyre, zone, x, t, T) for effect in lasting))

        return heat

    def conductivity(self, region: str, law: Any) -> Any:
        """Conductivity of a region, as input of `tyrefem.conduction.Material`."""
        factors = self.at("conductivity_factor")
        if not factors:
            return law

        def k(T: Array) -> tuple[Any, Any]:
            value = law(T) if callable(law) else law
            along, across = value if isinstance(value, tuple) else (value, value)
            for effect in factors:
                first, second = effect.conductivity_factor(self.tyre, region, T)
                along, across = along * first, across * second
            return along, across

        if not callable(law):
            cold, hot = k(np.array([0.0])), k(np.array([100.0]))
            if all(np.ndim(value) == 0 for value in (*cold, *hot)) and cold == hot:
                return cold
        return k

    def capacity(self, region: str, law: Any) -> Any:
        """Heat capacity of a region, as input of `tyrefem.conduction.Material`."""
        factors = self.at("capacity_factor")
        if not factors:
            return law

        def capacity(T: Array) -> Any:
            value = law(T) if callable(law) else law
            for effect in factors:
                value = value * effect.capacity_factor(self.tyre, region, T)
            return value

        return capacity

    def gas_capacity(self, base: float) -> float:
        """Heat capacity of the contained air, J/K."""
        for effect in self.at("gas_capacity_factor"):
            base = base * effect.gas_capacity_factor(self.tyre)
        return base

    def rim_power(self, t: float) -> float:
        """Power of the effects into the whole wheel's lumped rim at a time, W."""
        return sum(effect.rim_power(self.tyre, t) for effect in self.at("rim_power"))

    def conditions(self, surface: str) -> list[tuple[str, Any]]:
        """Fluxes and radiation of effects on a boundary, each with a name for the heat budget."""
        conditions: list[tuple[str, Any]] = []
        for effect in self.effects:
            if surface not in effect.surfaces:
                continue
            label = " ".join([*effect.label, "on the", surface.replace("_", " ")])
            if effect.overrides("flux"):
                conditions.append((label, Flux(_flux_of(effect, self.tyre, surface))))
            if effect.overrides("radiation"):
                radiation: Radiation | None = effect.radiation(self.tyre, surface)
                conditions += [] if radiation is None else [(label, radiation)]
        return conditions


def _flux_of(effect: Effect, tyre: Tyre, surface: str) -> Callable[[Array, float], Any]:
    return lambda x, t: effect.flux(tyre, surface, x, t)
