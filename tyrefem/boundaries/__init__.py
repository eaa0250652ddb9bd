"""The tyre's surroundings, to which it loses heat: road, outside air, contained air, rim. One class per law.

A law is a `Law` subclass in a module of this package; its ``law`` key in a study's ``[boundaries]`` selects it.

This package does not import drives, effects and runs.
"""

from __future__ import annotations

import functools
import importlib
import pkgutil
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, get_args

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from tyrefem.cards import Card
from tyrefem.errors import InputError, nearest

#: 1 cal/(cm2 s K), in which the report gives its film coefficients, in W/m2/K.
CAL = 41840.0


class Law(Card):
    """A boundary law. Subclasses set their ``side`` and ``law: Literal["name"]``."""

    side: ClassVar[str] = ""
    if TYPE_CHECKING:
        law: str


@dataclass(frozen=True)
class Contact:
    """Contact of a tread point with the road: speed m/s, footprint length m, tread W/m/K and J/m3/K."""

    speed: float
    footprint_length: float
    conductivity: float
    heat_capacity: float


@functools.cache
def laws(side: str) -> dict[str, type[Law]]:
    """Every law of a side, by name.

    >>> sorted(laws("road"))
    ['cattani', 'constant', 'half-space']
    """
    for module in pkgutil.iter_modules(__path__):
        importlib.import_module(f"{__name__}.{module.name}")
    by_name: dict[str, type[Law]] = {}
    stack = list(Law.__subclasses__())
    while stack:
        law = stack.pop()
        stack.extend(law.__subclasses__())
        if law.side == side and "law" in law.model_fields:
            by_name[get_args(law.model_fields["law"].annotation)[0]] = law
    return by_name


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
        if not isinstance(name, str) or name not in known:
            raise InputError(f"unknown law {name!r:.40}{nearest(str(name), known)}", field="law")
        return known[name].check({"law": name, **value})

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
