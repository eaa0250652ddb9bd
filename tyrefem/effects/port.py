"""A port: a place of the model where effects may act, declared by a method of a class."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, TypeVar

Method = TypeVar("Method", bound=Callable[..., Any])
#: Part of the model that a port changes: the tyre, its surroundings, or its measurement.
Part = Literal["tyre", "surroundings", "measurement"]


@dataclass(frozen=True)
class Port:
    """A port: name of its method, description, and the part of the model that it changes."""

    name: str
    words: str
    changes: Part


def port(words: str, changes: Part = "tyre") -> Callable[[Method], Method]:
    """Declare that a method of a class is a port.

    >>> class Model:
    ...     @port("lag of a sensor", changes="measurement")
    ...     def lag(self): ...
    >>> ports_of(Model)
    (Port(name='lag', words='lag of a sensor', changes='measurement'),)
    """

    def declared(method: Method) -> Method:
        setattr(method, _MARK, Port(method.__name__, words, changes))
        return method

    return declared


_MARK = "_port"


def ports_of(cls: type) -> tuple[Port, ...]:
    """The ports that a class declares, in the order of its methods."""
    return tuple(getattr(method, _MARK) for method in vars(cls).values() if hasattr(method, _MARK))
