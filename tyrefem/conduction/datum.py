"""A number or a function of place and time given by the user, checked at every use."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.conditions import is_number
from tyrefem.errors import InputError

Array = NDArray[Any]


class Datum:
    """A number or a function of (x, t), checked and cached for the latest time."""

    def __init__(self, value: Any, x: Array, field: str, low: float = -np.inf) -> None:
        self.constant = is_number(value)
        self._x, self._field, self._low = x, field, low
        self._value: Any = float(value) if self.constant else value
        self._time: float | None = None
        self._latest: Any = None

    def clear_cache(self) -> None:
        """Clear the cache: the next use calls the function, also for the same time."""
        self._time = None

    def __call__(self, t: float) -> Any:
        if self.constant:
            return self._value
        if t != self._time:
            latest = checked(self._value(self._x, t), self._x.shape[1], self._field, t)
            if (latest if isinstance(latest, float) else latest.min()) < self._low:
                raise InputError(f"is below {self._low:g} at t = {t:g} s", field=self._field)
            self._latest, self._time = latest, t
        return self._latest


def checked(value: Any, n: int, field: str, t: float) -> Any:
    """The return value of a user's function as a float or a finite array (n,)."""
    if isinstance(value, float) and math.isfinite(value):
        return float(value)
    array = np.asarray(value, dtype=float)
    if array.size == 1:
        array = array.reshape(())
    elif array.shape != (n,):
        raise InputError(f"the function returned shape {array.shape}; wanted a scalar or ({n},)", field=field)
    if not np.isfinite(array).all():
        raise InputError(f"the function returned a value that is not finite at t = {t:g} s", field=field)
    return float(array) if array.ndim == 0 else array
