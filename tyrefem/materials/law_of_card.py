"""A table of a material card whose law is shipped, or a user's."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, get_args

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from tyrefem.errors import InputError, nearest
from tyrefem.plugins import Kind, registry, working


def law_name(cls: type) -> str:
    """The first name of a class's ``law``; empty for a class without a name of its own."""
    field = getattr(cls, "model_fields", {}).get("law")
    names = get_args(field.annotation) if field is not None else ()
    return str(names[0]) if names else ""


@dataclass(frozen=True)
class LawOfCard:
    """Annotation of a card's table: its ``law`` is of the shipped class, or of a user's plugin.

    Parameters
    ----------
    kind : of the plugins. base : their base class. shipped : class of the shipped laws.
    """

    kind: Kind
    base: type[Any]
    shipped: type[Any]

    def __call__(self, value: Any) -> Any:
        if isinstance(value, self.base):
            return value
        name = value.get("law") if isinstance(value, Mapping) else None
        if isinstance(name, str):
            ours, loaded = self.kind.shipped(), registry()
            loaded.refuse(self.kind, name, known=name in ours)
            plugin = loaded.named(self.kind, name)
            if plugin is not None:
                return working(self._of_plugin(plugin.cls, value))
            if name not in ours:
                known = [*ours, *loaded.classes(self.kind)]
                raise InputError(f"unknown law '{name}'{nearest(name, known)}", field="law")
        return self.shipped.check(value)

    def _of_plugin(self, law: Any, table: Mapping[str, Any]) -> Any:
        """A user's law of a table, without the numbers that are left of the shipped law of a changed card."""
        left = set(self.shipped.model_fields) - set(law.model_fields)
        return law.check({key: value for key, value in table.items() if key not in left})

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self)

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """The table of the shipped class, or of a user's."""
        classes: list[Any] = [self.shipped, *registry().classes(self.kind).values()]
        tables: list[dict[str, Any]] = [handler(law.__pydantic_core_schema__) for law in classes]
        return tables[0] if len(tables) == 1 else {"anyOf": tables}
