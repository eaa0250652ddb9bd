"""Trials of a plugin's values: what must hold, and what is wrong, in words."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import numpy as np

from tyrefem.errors import InputError
from tyrefem.plugins.guard import WrongValueError, failure_words, plugin_error
from tyrefem.plugins.registry import registry


@dataclass(frozen=True)
class Trial:
    """What was tried: the claim, for all trials of its method alike, and what is wrong; None: nothing."""

    claim: str
    fault: str | None = None


@dataclass(frozen=True)
class Range:
    """The values that are allowed, with their unit.

    >>> Range("W/m2/K", 0.0).words, Range("1", 0.0, 5.0).words
    ('of at least 0 W/m2/K', 'from 0 to 5')
    """

    unit: str = ""
    low: float = -np.inf
    high: float = np.inf

    @property
    def words(self) -> str:
        """The range with its unit."""
        unit = "" if self.unit in ("", "1") else f" {self.unit}"
        if np.isfinite(self.low) and np.isfinite(self.high):
            return f"from {self.low:g} to {self.high:g}{unit}"
        if np.isfinite(self.low):
            return f"of at least {self.low:g}{unit}"
        return f"in {self.unit}" if unit else ""


def trial(words: str, compute: Callable[[], Any], allowed: Range, shape: tuple[int, ...] = ()) -> Trial:
    """Try that a computed value is finite, of a shape, and within a range.

    ``words``: what is computed, ``film(10 m/s)``. ``shape``: () is a single number; other shapes are met by what
    numpy spreads over them.

    >>> trial("film(10 m/s)", lambda: float("nan"), Range("W/m2/K", 0.0)).fault
    'film(10 m/s) must be a finite number of at least 0 W/m2/K, not nan'
    """
    number = "a finite number" if shape == () else f"finite numbers of shape {shape}"
    must = f"{words} must be {number} {allowed.words}".rstrip()
    given = f"a finite number {allowed.words}" if shape == () else f"finite numbers {allowed.words}, one per place"
    claim = f"{words.split('(')[0].strip()} gives {given}".replace(" ,", ",").rstrip()
    try:
        value = compute()
    except WrongValueError as error:
        value = error.value
    except InputError as error:
        return Trial(claim, f"{must}, but fails: {error.message}")
    except Exception as error:
        return Trial(claim, f"{must}, but fails: {failure_words(error, '')}")
    return Trial(claim, _fault(must, value, allowed, shape))


def _fault(must: str, value: Any, allowed: Range, shape: tuple[int, ...]) -> str | None:
    try:
        numbers = np.asarray(value, dtype=float)
        # A method without return gives None, which would count as nan; a text of digits would count as a number.
        is_numeric = value is not None and np.asarray(value).dtype.kind not in "US"
    except (TypeError, ValueError):
        is_numeric = False
    if not is_numeric:
        return f"{must}, not {value!r:.60}"
    try:
        fits = numbers.shape == shape or np.broadcast_shapes(numbers.shape, shape) == shape
    except ValueError:
        fits = False
    if not fits:
        return f"{must}, not an array of shape {numbers.shape}"
    wrong = ~np.isfinite(numbers) | (numbers < allowed.low) | (numbers > allowed.high)
    if wrong.any():
        return f"{must}, not {numbers[wrong].flat[0]:g}"
    return None


class Tried(Protocol):
    """What can be tried."""

    def trials(self) -> Iterable[Trial]:
        """The trials, each done when it is asked for."""


Checked = TypeVar("Checked", bound=Tried)


def working(law: Checked) -> Checked:
    """The law itself, after its trials if it is a user's.

    Raises
    ------
    InputError : the first trial that fails; names file, class and what was expected.
    """
    plugin = registry().of_class(type(law))
    if plugin is not None:
        fault = next((trial.fault for trial in law.trials() if trial.fault), None)
        if fault:
            raise plugin_error(plugin.origin, f"class {type(law).__name__}", fault)
    return law
