"""Shapes of what a user's effect gives: a wrong one names the effect's file, class and method."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from tyrefem.plugins import Origin
from tyrefem.plugins.guard import plugin_error

#: Ports of many points (2, n), and of many temperatures; both are their third argument after the object.
OF_POINTS, OF_TEMPERATURES = ("heat_factor", "heat_addend", "flux"), ("capacity_factor", "conductivity_factor")
_PLACES = 2
_MARK = "checks_its_shape"


def with_checked_shapes(cls: type[Any], origin: Origin) -> None:
    """Let the ports of a user's effect refuse values that do not fit the points."""
    for name in (*OF_POINTS, *OF_TEMPERATURES):
        for part in cls.__mro__:
            method = vars(part).get(name)
            if method is not None and hasattr(method, "_names_its_plugin") and not hasattr(method, _MARK):
                setattr(part, name, _checked(method, name, f"class {part.__name__}, {name}", origin))


def _checked(method: Callable[..., Any], name: str, where: str, origin: Origin) -> Callable[..., Any]:
    @functools.wraps(method)
    def checked(self: Any, *given: Any) -> Any:
        value = method(self, *given)
        # A pair: along and across the plies. What is no pair is refused by the trial of the port.
        for each in value if name == "conductivity_factor" and isinstance(value, tuple) else (value,):
            if isinstance(each, float | int):
                continue
            places = np.shape(given[_PLACES])[1:] if name in OF_POINTS else np.shape(given[_PLACES])
            if np.shape(each) not in (places, (), (1,)) or np.asarray(each).dtype.kind not in "fiub":
                many, what = math.prod(places), "points" if name in OF_POINTS else "temperatures"
                must = f"must give a number, or {many} numbers for {many} {what}"
                raise plugin_error(origin, where, f"{must}, not {_words(each)}")
        return value

    setattr(checked, _MARK, True)
    return checked


def _words(value: Any) -> str:
    return f"an array of shape {np.shape(value)}" if isinstance(value, np.ndarray) else f"{value!r:.40}"
