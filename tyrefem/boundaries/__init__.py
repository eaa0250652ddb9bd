"""The tyre's surroundings, to which it loses heat: road, outside air, contained air, rim. One class per law.

A law is a `Law` subclass in a module of this package, or in a user's plugin (`tyrefem.plugins`); its ``law`` key in a
study's ``[boundaries]`` selects it.

This package does not import drives, effects and runs.
"""

from __future__ import annotations

import functools
import importlib
import pkgutil
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, get_args

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from tyrefem.cards import Card
from tyrefem.errors import InputError, nearest
from tyrefem.plugins import Kind, Range, Trial, registry, working

#: 1 cal/(cm2 s K), in which the report gives its film coefficients, in W/m2/K.
CAL = 41840.0
#: Allowed films, and the speeds at which laws are tried, m/s.
FILM = Range("W/m2/K", 0.0)
SPEEDS = (0.0, 1.0, 10.0, 40.0, 90.0)


class Law(Card):
    """A boundary law. Subclasses set their ``side`` and ``law: Literal["name"]``."""

    side: ClassVar[str] = ""
    plugin_kind: ClassVar[Kind]
    #: The law's table as in a file, with which `tyrefem check` tries it; only what has no default.
    example: ClassVar[Mapping[str, Any]] = {}
    if TYPE_CHECKING:
        law: str

    def trials(self) -> Iterable[Trial]:
        """Trials of the law's values at usual conditions, which every law must pass."""
        return ()


@dataclass(frozen=True)
class Contact:
    """Contact of a tread point with the road: speed m/s, footprint length m, tread W/m/K and J/m3/K."""

    speed: float
    footprint_length: float
    conductivity: float
    heat_capacity: float


#: The sides of the tyre, and the sliding tread, that have a law each.
SIDES = ("road", "outside_air", "contained_air", "rim", "sliding")


def _name(cls: type) -> str:
    """``side.law`` of a law's class; empty for a class without its own ``law``."""
    field = cls.model_fields.get("law") if issubclass(cls, Law) else None
    names = get_args(field.annotation) if field is not None else ()
    return f"{getattr(cls, 'side', '')}.{names[0]}" if names else ""


def _complaint(cls: type) -> str | None:
    side = getattr(cls, "side", "")
    if side not in SIDES:
        return f"unknown side '{side}'{nearest(side, SIDES)}; extend a law of a side, such as OutsideAirLaw"
    return None


@functools.cache
def shipped_laws() -> dict[str, type[Law]]:
    """Every law of this package by ``side.law``."""
    for module in pkgutil.iter_modules(__path__):
        importlib.import_module(f"{__name__}.{module.name}")
    by_name: dict[str, type[Law]] = {}
    stack = list(Law.__subclasses__())
    while stack:
        law = stack.pop()
        stack.extend(law.__subclasses__())
        if _name(law) and law.__module__.startswith(f"{__name__}."):
            by_name[_name(law)] = law
    return by_name


KIND = Law.plugin_kind = Kind("boundary law", "boundary laws", 'law: Literal["..."]', _name, shipped_laws, _complaint)


def laws(side: str) -> dict[str, type[Law]]:
    """Every law of a side, by name.

    >>> sorted(laws("road"))
    ['cattani', 'constant', 'half-space']
    """
    every = {**shipped_laws(), **registry().classes(KIND)}
    return {name.removeprefix(f"{side}."): law for name, law in every.items() if name.startswith(f"{side}.")}


@dataclass(frozen=True)
class LawOf:
    """Annotation of a study's boundary: a table whose ``law`` is one of a side's laws."""

    side: str
    default: str

    def __call__(self, value: Any) -> Any:
        known = laws(self.side)
        if isinstance(value, str):
            value = {"law": value}
        if not isinstance(value, Mapping):
            raise InputError(f"must be a table with a law, not {value!r:.40}; allowed: {', '.join(sorted(known))}")
        name = value.get("law", self.default)
        registry().refuse(KIND, f"{self.side}.{name}", known=isinstance(name, str) and name in known)
        if not isinstance(name, str) or name not in known:
            raise InputError(f"unknown law {name!r:.40}{nearest(str(name), known)}", field="law")
        return working(known[name].check({"law": name, **value}))

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self)

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """A table of one of the side's laws, or a law's name; a table without a law has the default law."""
        known = dict(sorted(laws(self.side).items()))
        tables = []
        for name, law in known.items():
            reference = handler(law.__pydantic_core_schema__)
            table = handler.resolve_ref_schema(reference)
            needed = [key for key in table.get("required", []) if key != "law" or name != self.default]
            table["required"] = needed
            tables.append(reference)
        names = {"type": "string", "enum": list(known)}
        return {"anyOf": [names, {"type": "object", "properties": {"law": names}, "oneOf": tables}]}
