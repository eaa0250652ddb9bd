"""Watch a value go through a run: which functions hand it on, in which order, by `sys.setprofile`.

A function *hands the value on* when it returns it, alone or in what it made. A function that gives back what it was
handed (a check), and a method that reads an object which has the value already, hand nothing on.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields, is_dataclass
from types import FrameType
from typing import Any

from pydantic import BaseModel


@dataclass(frozen=True)
class Step:
    """One hand-over: a function of a module returned the value in a form (see `form`) to a function of ``taker``."""

    module: str
    function: str
    form: str
    taker: str


@dataclass(frozen=True)
class Walk:
    """Steps in their order, and the module where the value arrives."""

    steps: tuple[Step, ...]
    end: str

    @property
    def visits(self) -> tuple[str, ...]:
        """Modules as the steps come to them; a module stands here twice if it is entered twice."""
        modules = [*(step.module for step in self.steps), self.end]
        return tuple(name for name, before in zip(modules, ["", *modules], strict=False) if name != before)

    def form(self, module: str) -> str:
        """What a module hands on to another one at last."""
        return last_form(self.steps, module)


def last_form(steps: Iterable[Step], module: str) -> str:
    """The form of a module's last step to another module; empty for a module without one."""
    return next((step.form for step in reversed(tuple(steps)) if step.module == module != step.taker), "")


@dataclass(slots=True)
class Call:
    """A function at work: its module, and whether it was handed the value."""

    frame: FrameType
    module: str
    handed: bool = False


class Follower:
    """Notes every hand-over in a ``with`` block; ``holds`` says whether an object is the value or has it."""

    def __init__(self, holds: Callable[[Any], bool]) -> None:
        self.holds = holds
        self.steps: list[Step] = []
        self._calls: list[Call] = []

    def __enter__(self) -> Follower:
        sys.setprofile(self._event)
        return self

    def __exit__(self, *_: object) -> None:
        sys.setprofile(None)

    def _event(self, frame: FrameType, event: str, value: Any) -> None:
        if event == "call":
            self._calls.append(Call(frame, str(frame.f_globals.get("__name__", ""))))
        elif event == "return" and self._calls:
            call = self._calls.pop()
            self.returned(call, self._calls[-1] if self._calls else Call(frame, ""), value)

    def returned(self, call: Call, taker: Call, value: Any) -> None:
        """A function returned; ``taker`` is the one that called it."""
        if not call.module.startswith("tyrefem."):
            taker.handed |= call.handed
        elif self.holds(value):
            taker.handed = True
            if not self._read_or_checked(call.frame, value):
                self.note(call, taker, form(value, self.holds))

    def note(self, call: Call, taker: Call, form: str) -> None:
        """Add a step."""
        self.steps.append(Step(call.module, call.frame.f_code.co_qualname, form, taker.module))

    def _read_or_checked(self, frame: FrameType, value: Any) -> bool:
        code = frame.f_code
        arguments = [frame.f_locals.get(name) for name in code.co_varnames[: code.co_argcount]]
        is_method = code.co_varnames[:1] == ("self",)
        return (is_method and self.holds(arguments[0])) or any(argument is value for argument in arguments)


def form(value: Any, holds: Callable[[Any], bool]) -> str:
    """What an object is called in a walk: text, table, number, array, or its class; of a list what is in it."""
    if isinstance(value, float | str):
        return "number" if isinstance(value, float) else "text"
    # A named tuple is what its class says.
    if isinstance(value, dict | list | tuple) and not hasattr(value, "_fields"):
        entries = value.values() if isinstance(value, dict) else value
        inner = next(form(entry, holds) for entry in entries if holds(entry))
        return "table" if inner == "text" else inner
    return {"ndarray": "array"}.get(type(value).__name__, type(value).__name__)


def parts(value: Any) -> Iterable[Any]:
    """The fields of a dataclass or card, without asking its properties; nothing of another object."""
    if isinstance(value, BaseModel):
        return value.__dict__.values()
    if is_dataclass(value) and not isinstance(value, type):
        return [getattr(value, field.name, None) for field in fields(value)]
    return ()


def room(module: str) -> str:
    """The room that a module stands in."""
    return module.removeprefix("tyrefem.").partition(".")[0]
