"""Do the methods of a class take the arguments with which its base is called?"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Iterator
from typing import Any

from tyrefem.plugins.kind import is_ours

#: Double-underscore methods that are part of a contract.
SPECIAL = ("__call__", "__init__")
_POSITIONAL = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)


def contract_methods(cls: type) -> Iterator[tuple[type, str, Any, Any]]:
    """Class of the user, name, attribute there and attribute of this package, of everything that it overrides."""
    theirs = [part for part in cls.__mro__ if not is_ours(part) and any(map(is_ours, part.__mro__))]
    ours = [part for part in cls.__mro__ if is_ours(part)]
    seen = set()
    for part in theirs:
        for name, attribute in vars(part).items():
            if name in seen or (name.startswith("_") and name not in SPECIAL):
                continue
            base = next((vars(other)[name] for other in ours if name in vars(other)), None)
            if base is not None:
                seen.add(name)
                yield part, name, attribute, base


def wrong_signature(cls: type) -> str | None:
    """The first method that cannot take its arguments, in words; None if all can.

    >>> class Law: ...
    >>> wrong_signature(Law) is None
    True
    """
    for _, name, attribute, base in contract_methods(cls):
        wrong = _wrong(name, attribute, base)
        if wrong:
            return wrong
    return None


def _wrong(name: str, attribute: Any, base: Any) -> str | None:
    if isinstance(base, property | functools.cached_property):
        if callable(attribute) or isinstance(attribute, classmethod | staticmethod):
            return f"'{name}' must be a property: write @property above 'def {name}(self)'"
        return None
    function, without_self = _function(base)
    if function is None:
        return None
    if isinstance(attribute, property | functools.cached_property):
        return f"'{name}' must be a method, not a property: remove @property"
    theirs, without_theirs = _function(attribute)
    if theirs is None:
        return f"'{name}' must be a method, not {type(attribute).__name__}"
    try:
        signature = inspect.signature(theirs)
    except (TypeError, ValueError):
        return None
    wanted = list(inspect.signature(function).parameters.values())
    positions = [None for parameter in wanted if parameter.kind in _POSITIONAL]
    named = {parameter.name: None for parameter in wanted if parameter.kind is inspect.Parameter.KEYWORD_ONLY}
    if without_theirs != without_self:  # a static method takes no self
        positions = positions[1:] if without_self else positions
    try:
        signature.bind(*positions, **named)
    except TypeError:
        return f"method must be {name}({_names(function)}), not {name}({_names(theirs)})"
    return None


def _function(attribute: Any) -> tuple[Any, bool]:
    """The function of a method, and whether its first argument is the object or class."""
    if isinstance(attribute, staticmethod):
        return attribute.__func__, False
    if isinstance(attribute, classmethod):
        return attribute.__func__, True
    return (attribute, True) if inspect.isfunction(attribute) else (None, True)


def _names(function: Any) -> str:
    parameters = inspect.signature(function).parameters.values()
    stars: dict[Any, str] = {inspect.Parameter.VAR_POSITIONAL: "*", inspect.Parameter.VAR_KEYWORD: "**"}
    return ", ".join(stars.get(parameter.kind, "") + parameter.name for parameter in parameters)
