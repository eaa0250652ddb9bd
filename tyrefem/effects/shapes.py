"""Shapes of what a user's effect gives: a wrong one names the effect's file, class and method."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from tyrefem.plugins import Origin
from tyrefem.plugins.guard import plugin_error

#: Ports of many places -> the number of the argument with the points (2, n), or with the temperatures (n,).
PLACES = {"heat_factor": 2, "heat_addend": 2, "flux": 2}
_MARK = "checks_its_shape"


def with_checked_shapes(cls: type[Any], origin: Origin) -> None:
    """Let the ports of a user's effect refuse values that do not fit the points."""
    for name, place in PLACES.items():
        for part in cls.__mro__:
            method = vars(part).get(name)
            if method is not None and hasattr(method, "_names_its_plugin") and not hasattr(method, _MARK):
                setattr(part, name, _checked(method, place, f"class {part.__name__}, {name}", origin))


def _checked(method: Callable[..., Any], place: int, where: str, origin: Origin) -> Callable[..., Any]:
    @functools.wraps(method)
    def checked(self: Any, *given: Any) -> Any:
        value = method(self, *given)
        if isinstance(value, float | int):
            return value
        size = given[place].shape[1]
        shape = np.shape(value)
        if shape not in ((size,), (), (1,)) or np.asarray(value).dtype.kind not in "fiub":
            must = f"must give a number, or {size} numbers for {size} points"
            raise plugin_error(origin, where, f"{must}, not {_words(value)}")
        return value

    setattr(checked, _MARK, True)
    return checked


def _words(value: Any) -> str:
    return f"an array of shape {np.shape(value)}" if isinstance(value, np.ndarray) else f"{value!r:.40}"
