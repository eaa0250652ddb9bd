"""States of a tyre's effects during a run: their places in one vector, and their present values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import read_only
from tyrefem.effects import Effect
from tyrefem.effects.state import EffectState, TemperaturesOfTyre, Value
from tyrefem.effects.tyre import Tyre
from tyrefem.errors import InputError
from tyrefem.plugins import registry
from tyrefem.plugins.guard import plugin_error

Array = NDArray[np.float64]
Key = tuple[str, ...]


@dataclass(frozen=True)
class StateHistory:
    """A state over time: ``values`` (n_times,), or (n_times, n) with one value per place, in ``unit``."""

    unit: str
    meaning: str
    values: Array


@dataclass(frozen=True)
class _Place:
    """Place of an effect's state in the vector."""

    effect: Effect
    name: str
    state: EffectState
    part: slice
    shape: tuple[int, ...]

    @property
    def label(self) -> str:
        return " ".join([*_key(self.effect), self.name])


def _key(effect: Effect) -> Key:
    return effect.label


class EffectStates:
    """States of effects as one vector (k,).

    During a run, `value` gives the states at the computed time; after the run, those of the history.

    Raises
    ------
    InputError : an effect's initial states are not finite, or differ from its declared states.
    """

    def __init__(self, tyre: Tyre, effects: Sequence[Effect]) -> None:
        self.places: list[_Place] = []
        initial: list[Array] = []
        size = 0
        for effect in effects:
            given = checked_states(effect, effect.initial_states(tyre), "initial_states")
            for name, state in effect.states.items():
                value = given[name]
                self.places.append(_Place(effect, name, state, slice(size, size + value.size), value.shape))
                initial.append(value.reshape(-1))
                size += value.size
        self.initial = np.concatenate(initial) if initial else np.zeros(0)
        self.scale = np.concatenate(
            [np.full(place.part.stop - place.part.start, place.state.scale) for place in self.places]
        )
        self._now: Array | None = None
        self._history: tuple[Array, Array] | None = None

    def rate(self, tyre: Tyre, t: float, z: Array, temperatures: TemperaturesOfTyre) -> Array:
        """Rates (k,) per second of the states z (k,)."""
        rates = np.empty(z.size)
        effects = {_key(place.effect): place.effect for place in self.places}
        for key, effect in effects.items():
            mine = [place for place in self.places if _key(place.effect) == key]
            state = {place.name: self._value(place, z) for place in mine}
            given = checked_states(effect, effect.state_rates(tyre, t, state, temperatures), "state_rates")
            for place in mine:
                if given[place.name].shape != place.shape:
                    words = f"state '{place.name}' has the shape {place.shape}, its rate {given[place.name].shape}"
                    raise _error(effect, "state_rates", words)
                rates[place.part] = given[place.name].reshape(-1)
        return rates

    def show(self, z: Array) -> None:
        """Set the present states."""
        self._now = z

    def record(self, times: Array, values: Array) -> None:
        """Set the history of the finished run, values (n_times, k)."""
        self._now, self._history = None, (times, values)

    def value(self, effect: Effect, name: str, t: float) -> Value:
        """A state at a time: of the computed step, or of the history after a run; before a run, the initial state."""
        place = next(
            (
                candidate
                for candidate in self.places
                if candidate.name == name and _key(candidate.effect) == _key(effect)
            ),
            None,
        )
        if place is None:
            raise InputError(f"has no state '{name}'", field=f"effects.{effect.name}")
        if self._now is not None:
            return self._value(place, self._now)
        if self._history is None:
            return self._value(place, self.initial)
        times, values = self._history
        return self._value(place, np.array([np.interp(t, times, column) for column in values.T]))

    @staticmethod
    def _value(place: _Place, z: Array) -> Value:
        part = read_only(z[place.part].reshape(place.shape))  # of the solver
        return part if part.ndim else float(part)

    def named(self, values: Array) -> dict[str, StateHistory]:
        """ "effect state" -> its history, from values (n_times, k)."""
        return {
            place.label: StateHistory(
                place.state.unit, place.state.meaning, values[:, place.part].reshape(len(values), *place.shape)
            )
            for place in self.places
        }


def checked_states(effect: Effect, given: Mapping[str, Value], method: str) -> dict[str, Array]:
    """Check the return value of an effect's method: state -> array () or (n,)."""
    if not isinstance(given, Mapping) or set(given) != set(effect.states):
        names = ", ".join(effect.states)
        raise _error(effect, method, f"must return a mapping with {names}, not {given!r:.60}")
    values = {}
    for name, value in given.items():
        must = f"'{name}' must be finite, a number or an array (n,), not {value!r:.60}"
        try:
            values[name] = np.asarray(value, dtype=float)
        except (TypeError, ValueError):
            raise _error(effect, method, must) from None
        if values[name].ndim > 1 or not np.isfinite(values[name]).all():
            raise _error(effect, method, must)
    return values


def _error(effect: Effect, method: str, words: str) -> InputError:
    """An error of an effect's method; of a user's effect with its file."""
    plugin = registry().of_class(type(effect))
    if plugin is None:
        return InputError(words, field=f"effects.{effect.name}.{method}")
    return plugin_error(plugin.origin, f"class {type(effect).__name__}, {method}", words)
