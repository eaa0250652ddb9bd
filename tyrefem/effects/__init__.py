"""The catalogue of physical effects that a model may lack, one class each, registered by their modules.

An effect is an `Effect` subclass in a module of this package, or in a user's plugin: `tyrefem.plugins`.

This package knows studies and runs only by the protocols of `effects.tyre`.
"""

from __future__ import annotations

import functools
import importlib
import os
import pkgutil
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from tyrefem.cache import Cache
from tyrefem.effects.effect import Effect, Parameter, Prior, complaint, wrong_unit
from tyrefem.effects.shapes import with_checked_shapes
from tyrefem.effects.state import EffectState
from tyrefem.errors import InputError, PluginWarning, nearest
from tyrefem.output import as_path
from tyrefem.plugins import Kind, Origin, Registry, registry, use
from tyrefem.plugins.environment import FOLDERS

__all__ = ["Effect", "EffectOf", "EffectState", "Parameter", "Prior", "catalogue", "use_effects"]

#: Effects by class and entry as written.
_READ: Cache[Effect] = Cache(size=4096)


@functools.cache
def shipped_effects() -> dict[str, type[Effect]]:
    """The effects of this package by name, in alphabetical order."""
    for module in pkgutil.iter_modules(__path__):
        importlib.import_module(f"{__name__}.{module.name}")
    effects: dict[str, type[Effect]] = {}
    classes = [Effect]
    for cls in classes:
        classes += cls.__subclasses__()
    for cls in classes:
        if not cls.name or not cls.__module__.startswith(f"{__name__}."):
            continue
        if cls.name in effects:
            both = " and ".join(sorted({cls.__module__, effects[cls.name].__module__}))
            raise InputError(f"two effects are named '{cls.name}': in {both}")
        effects[cls.name] = cls
    return dict(sorted(effects.items()))


KIND = Effect.plugin_kind = Kind(
    "effect",
    "effects",
    'name: ClassVar[str] = "..."',
    lambda cls: str(getattr(cls, "name", "")),
    shipped_effects,
    lambda cls: complaint(cls) or wrong_unit(cls),
    with_checked_shapes,
)


def use_effects(folder: str | Path) -> tuple[str, ...]:
    """Add a folder of a user's effects to the catalogue for the rest of this process and its workers; their names.

    The same as naming the folder in ``TYREFEM_PLUGINS``.

    Raises
    ------
    InputError : there is no such folder, it has no effect, or a file of it cannot be loaded.
    """
    place = as_path(folder, "effects").resolve()
    if not place.is_dir():
        raise InputError(f"'{folder}' is not a folder", field="effects")
    before = os.environ.get(FOLDERS, "")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PluginWarning)  # a failure in this folder is raised below
        use(place)
        loaded = registry()
    inside = [plugin.name for plugin in loaded.plugins if plugin.kind is KIND and _lies_in(plugin.origin, place)]
    failure = next((failure for failure in loaded.failures if _lies_in(failure.origin, place)), None)
    if failure is not None or not inside:
        os.environ[FOLDERS] = before
        if failure is not None:
            raise failure.error
        files = "no Python file" if not list(place.glob("*.py")) else "Python files, but none with an effect"
        raise InputError(f"'{folder}' has {files}; docs/effects.md, \"An effect of your own\"", field="effects")
    return tuple(sorted(inside))


def _lies_in(origin: Origin, place: Path) -> bool:
    return origin.file is not None and origin.file.parent == place


def catalogue() -> dict[str, type[Effect]]:
    """Every effect by name, in alphabetical order; a user's effect that fails is left out, with a warning.

    >>> "hot-road" in catalogue()
    True
    """
    return dict(_all_effects(registry()))


@functools.lru_cache(maxsize=4)
def _all_effects(plugins: Registry) -> dict[str, type[Effect]]:
    """`catalogue` with given plugins; not to be changed."""
    return dict(sorted({**shipped_effects(), **plugins.classes(KIND)}.items()))


class EffectOf:
    """Annotation of an entry of a study's ``[[effects]]``: a table whose ``name`` is in the catalogue."""

    def __call__(self, value: Any) -> Any:
        if not isinstance(value, Mapping):
            raise InputError(f"must be a table with a name, not {value!r:.40}")
        plugins = registry()
        known = _all_effects(plugins)
        name = value.get("name")
        plugins.refuse(KIND, name, known=isinstance(name, str) and name in known)
        if "name" not in value:
            raise InputError(f"missing; it names the effect{nearest('', known)}", field="name")
        if not isinstance(name, str) or name not in known:
            wrong = f"unknown effect {name!r:.40}{nearest(str(name), known)}"
            raise InputError(f"{wrong}; your own needs its folder in {FOLDERS}", field="name")
        effect, entry = known[name], {key: entry for key, entry in value.items() if key != "name"}
        # A fit reads hundreds of studies that differ in one effect; effects are immutable, so studies share them.
        return _READ.get((effect, repr(entry)), lambda: effect.check(entry))

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self)

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """A table with the name of an effect and the effect's keys."""
        known = catalogue()
        tables = []
        for name, effect in known.items():
            reference = handler(effect.__pydantic_core_schema__)
            table = handler.resolve_ref_schema(reference)
            sentence = {"const": name, "description": f"{effect.sentence} Source: {effect.source}."}
            table["properties"] = {"name": sentence, **table["properties"]}
            table["required"] = list(dict.fromkeys(["name", *table.get("required", [])]))
            tables.append(reference)
        names = {"type": "string", "enum": list(known)}
        return {"type": "object", "required": ["name"], "properties": {"name": names}, "oneOf": tables}
