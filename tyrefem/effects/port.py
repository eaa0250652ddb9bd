"""A port: a place of the model where effects may enter. The method that is the port says of itself what it changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, TypeVar

Method = TypeVar("Method", bound=Callable[..., Any])
#: What a port changes: the tyre itself, what surrounds it, or what is measured of it.
Part = Literal["tyre", "surroundings", "measurement"]


@dataclass(frozen=True)
class Port:
    """A port by the name of its method: what it is, in words, and which part of the model it changes."""

    name: str
    words: str
    changes: Part


def port(words: str, changes: Part = "tyre") -> Callable[[Method], Method]:
    """Declare a method of a class a port.

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
