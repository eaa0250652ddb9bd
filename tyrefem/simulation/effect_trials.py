"""Trials of an effect on its tyre before a run: every port gives finite values of the right shape."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction import Radiation
from tyrefem.effects import Effect
from tyrefem.effects.effect import FILMS, SINKS
from tyrefem.mechanics.user_cycle import points_of
from tyrefem.plugins import Range, Trial, registry, trial
from tyrefem.plugins.guard import plugin_error
from tyrefem.simulation.effect_states import checked_states

if TYPE_CHECKING:
    from tyrefem.simulation.surroundings import Surroundings

Array = NDArray[np.float64]
#: Temperatures of the trials, degC.
TEMPERATURES = (20.0, 70.0, 150.0)
NUMBER, POSITIVE, NOT_NEGATIVE = Range(), Range("", 1e-12), Range("", 0.0)


def check_effects_on(tyre: Surroundings) -> None:
    """Try the user's own effects of a tyre's study.

    Raises
    ------
    InputError : the first port that fails; names the effect's file, class, method, and what was expected.
    """
    loaded = registry()
    for effect in tyre.study.effects:
        plugin = loaded.of_class(type(effect))
        if plugin is None:
            continue
        fault = next((trial.fault for trial in effect_trials(tyre, effect) if trial.fault), None)
        if fault:
            raise plugin_error(plugin.origin, f"class {type(effect).__name__}", fault)


def effect_trials(tyre: Surroundings, effect: Effect) -> Iterator[Trial]:
    """Trials of every port where an effect acts: times from start to end, every zone, surface, film and sensor."""
    for name in effect.ports():
        yield from _TRIALS[name](tyre, effect)
    if effect.states:
        yield from _rates(tyre, effect)


def times(tyre: Surroundings) -> tuple[float, ...]:
    """Start, middle and end of the drive, s."""
    end = tyre.drive.end
    return 0.0, 0.5 * end, end


def _on_zones(method: str, allowed: Range) -> Callable[[Surroundings, Effect], Iterator[Trial]]:
    """Trials of a port of zone, points, time and temperatures."""

    def trials(tyre: Surroundings, effect: Effect) -> Iterator[Trial]:
        port = getattr(effect, method)
        for zone in tyre.schedule.zones:
            x = points_of(tyre.study.section, zone)
            for t in times(tyre):
                for temperature in TEMPERATURES:
                    T = np.full(x.shape[1], temperature)
                    words = f"{method}(zone '{zone.name}', {x.shape[1]} points, {t:g} s, {temperature:g} degC)"
                    yield trial(words, functools.partial(port, tyre, zone.name, x, t, T), allowed, T.shape)

    return trials


def _conductivity(tyre: Surroundings, effect: Effect) -> Iterator[Trial]:
    T = np.array(TEMPERATURES)
    for region in tyre.study.section.regions:
        factors = functools.partial(effect.conductivity_factor, tyre, region, T)
        words = f"conductivity_factor('{region}', {T.size} temperatures)"
        for number, along in enumerate(("along the plies", "across them")):
            yield trial(f"{words}, {along},", functools.partial(_part, factors, number), POSITIVE, T.shape)


def _part(pair: Callable[[], Any], number: int) -> Any:
    values = pair()
    if not isinstance(values, tuple) or len(values) != 2:
        raise TypeError(f"gives {values!r:.40}, not a pair: along and across the plies")
    return values[number]


def _capacity(tyre: Surroundings, effect: Effect) -> Iterator[Trial]:
    T = np.array(TEMPERATURES)
    for region in tyre.study.section.regions:
        factor = functools.partial(effect.capacity_factor, tyre, region, T)
        yield trial(f"capacity_factor('{region}', {T.size} temperatures)", factor, POSITIVE, T.shape)


def _over_time(
    method: str, names: tuple[str, ...], allowed: Range
) -> Callable[[Surroundings, Effect], Iterator[Trial]]:
    """Trials of a port of a film or sink, and time."""

    def trials(tyre: Surroundings, effect: Effect) -> Iterator[Trial]:
        port = getattr(effect, method)
        for name in names:
            for t in times(tyre):
                yield trial(f"{method}('{name}', {t:g} s)", functools.partial(port, tyre, name, t), allowed)

    return trials


def _flux(tyre: Surroundings, effect: Effect) -> Iterator[Trial]:
    x = np.concatenate([points_of(tyre.study.section, zone) for zone in tyre.schedule.zones], axis=1)
    for surface in effect.surfaces:
        for t in times(tyre):
            words = f"flux('{surface}', {x.shape[1]} points, {t:g} s)"
            yield trial(words, functools.partial(effect.flux, tyre, surface, x, t), Range("W/m2"), x.shape[1:])


def _radiation(tyre: Surroundings, effect: Effect) -> Iterator[Trial]:
    for surface in effect.surfaces:
        words = f"radiation('{surface}')"
        given = effect.radiation(tyre, surface)
        fits = given is None or isinstance(given, Radiation)
        must = f"{words} must be None or a tyrefem.Radiation"
        yield Trial(f"{words} is None or a tyrefem.Radiation", None if fits else f"{must}, not {given!r:.40}")


def _gas(tyre: Surroundings, effect: Effect) -> Iterator[Trial]:
    yield trial("gas_capacity_factor", lambda: effect.gas_capacity_factor(tyre), POSITIVE)


def _rim(tyre: Surroundings, effect: Effect) -> Iterator[Trial]:
    for t in times(tyre):
        yield trial(f"rim_power({t:g} s)", functools.partial(effect.rim_power, tyre, t), Range("W"))


def _worn(tyre: Surroundings, effect: Effect) -> Iterator[Trial]:
    section = tyre.study.new_section
    given = effect.worn(section)
    fits = isinstance(given, type(section))
    must = "worn(section) must be a section"
    yield Trial("worn(section) is a section", None if fits else f"{must}, not {given!r:.40}")


def _of_sensors(method: str, allowed: Range) -> Callable[[Surroundings, Effect], Iterator[Trial]]:
    """Trials of a port of a sensor."""

    def trials(tyre: Surroundings, effect: Effect) -> Iterator[Trial]:
        for name in tyre.study.sensors:
            yield trial(f"{method}('{name}')", functools.partial(getattr(effect, method), name), allowed)

    return trials


def _displacement(tyre: Surroundings, effect: Effect) -> Iterator[Trial]:
    for name in tyre.study.sensors:
        moved = functools.partial(effect.displacement, name)
        yield trial(f"displacement('{name}')", moved, Range("m"), (2,))


def _clock(tyre: Surroundings, effect: Effect) -> Iterator[Trial]:
    yield trial("clock()", effect.clock, Range("s"))


def _channel(tyre: Surroundings, effect: Effect) -> Iterator[Trial]:
    for name in tyre.study.sensors:
        channel = effect.channel(name)
        must = f"channel('{name}') must be the name of a sensor"
        known = channel in tyre.study.sensors
        yield Trial(f"channel('{name}') is the name of a sensor", None if known else f"{must}, not {channel!r:.40}")


@dataclass(frozen=True)
class EvenTemperatures:
    """A tyre of one temperature, degC."""

    temperature: float

    def surface(self, boundary: str) -> float:
        """Mean temperature of a boundary."""
        return self.temperature

    def region(self, name: str) -> float:
        """Mean temperature of a region."""
        return self.temperature

    def at(self, points: Array) -> Array:
        """Temperatures at points (n_points, 2)."""
        return np.full(len(points), self.temperature)

    def reservoir(self, name: str) -> float:
        """Temperature of a lumped body."""
        return self.temperature


def _rates(tyre: Surroundings, effect: Effect) -> Iterator[Trial]:
    given = checked_states(effect, effect.initial_states(tyre), "initial_states")
    initial = {name: value if value.ndim else float(value) for name, value in given.items()}
    for t in times(tyre):
        for temperature in TEMPERATURES:
            rates = functools.partial(effect.state_rates, tyre, t, initial, EvenTemperatures(temperature))
            for name in effect.states:
                words = f"state_rates({t:g} s, {temperature:g} degC)['{name}']"
                rate = functools.partial(_rate, effect, rates, name)
                yield trial(words, rate, Range(f"{effect.states[name].unit}/s"), np.shape(initial[name]))


def _rate(effect: Effect, rates: Callable[[], Any], name: str) -> Any:
    return checked_states(effect, rates(), "state_rates")[name]


_TRIALS: dict[str, Callable[[Surroundings, Effect], Iterator[Trial]]] = {
    "heat_factor": _on_zones("heat_factor", NUMBER),
    "heat_addend": _on_zones("heat_addend", Range("W/m3")),
    "conductivity_factor": _conductivity,
    "capacity_factor": _capacity,
    "film_factor": _over_time("film_factor", FILMS, NOT_NEGATIVE),
    "film_addend": _over_time("film_addend", FILMS, Range("W/m2/K")),
    "film_resistance": _over_time("film_resistance", FILMS, Range("m2 K/W", 0.0)),
    "sink_addend": _over_time("sink_addend", SINKS, Range("K")),
    "flux": _flux,
    "radiation": _radiation,
    "gas_capacity_factor": _gas,
    "rim_power": _rim,
    "worn": _worn,
    "displacement": _displacement,
    "lag_addend": _of_sensors("lag_addend", Range("s")),
    "offset": _of_sensors("offset", Range("K")),
    "clock": _clock,
    "channel": _channel,
}
