"""The catalogue of physical effects that a model may lack, one class each, registered by their modules.

An effect is an `Effect` subclass in a module of this package, or in a Python file of a folder that the user names in
``TYREFEM_EFFECTS``.

This package knows studies and runs only by the protocols of `effects.tyre`.
"""

from __future__ import annotations

import functools
import importlib
import importlib.util
import os
import pkgutil
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from tyrefem.cache import Cache
from tyrefem.effects.effect import Effect, Parameter, Prior
from tyrefem.effects.state import EffectState
from tyrefem.errors import InputError, nearest
from tyrefem.output import note_input

__all__ = ["Effect", "EffectOf", "EffectState", "Parameter", "Prior", "catalogue", "use_effects"]

#: Effects by class and entry as written.
_READ: Cache[Effect] = Cache(size=4096)


@functools.cache
def _modules(folders: str) -> frozenset[str]:
    """Import every module that defines effects; return the modules' names."""
    modules = [f"{__name__}.{module.name}" for module in pkgutil.iter_modules(__path__)]
    for name in modules:
        importlib.import_module(name)
    for folder in filter(None, folders.split(os.pathsep)):
        if not Path(folder).is_dir():
            raise InputError(f"TYREFEM_EFFECTS names '{folder}', which is not a folder")
        modules += [_loaded(file) for file in sorted(Path(folder).resolve().glob("*.py"))]
    return frozenset(modules)


def _loaded(file: Path) -> str:
    """Execute a user's file as a separate module; return the module's name."""
    name = f"tyrefem_user_effects.{file}"
    spec = importlib.util.spec_from_file_location(name, file)
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    note_input(file)
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[name]
        reason = error.message if isinstance(error, InputError) else f"{type(error).__name__}: {error}"
        raise InputError(f"cannot be loaded as effects: {reason}", file=file) from error
    return name


def use_effects(folder: str | Path) -> tuple[str, ...]:
    """Add a folder of a user's effects to the catalogue for the rest of this process and its workers; their names.

    The same as naming the folder in ``TYREFEM_EFFECTS``.

    Raises
    ------
    InputError : there is no such folder, it has no effect, or a file of it cannot be loaded.
    """
    place = Path(folder).resolve()
    if not place.is_dir():
        raise InputError(f"effects: '{folder}' is not a folder")
    before = os.environ.get("TYREFEM_EFFECTS", "")
    folders = [each for each in before.split(os.pathsep) if each]
    if str(place) not in [str(Path(each).resolve()) for each in folders]:
        os.environ["TYREFEM_EFFECTS"] = os.pathsep.join([*folders, str(place)])
    try:
        names = [
            name
            for name, effect in catalogue().items()
            if Path(str(sys.modules[effect.__module__].__file__)).parent == place
        ]
        if not names:
            files = "no Python file" if not list(place.glob("*.py")) else "Python files, but none with an effect"
            raise InputError(f"effects: '{folder}' has {files}; docs/effects.md, \"An effect of your own\"")
    except InputError:
        os.environ["TYREFEM_EFFECTS"] = before
        raise
    return tuple(names)


def catalogue() -> dict[str, type[Effect]]:
    """Every effect by name, in alphabetical order.

    Raises
    ------
    InputError : a user's file cannot be loaded, or has the name of another effect.

    >>> "hot-road" in catalogue()
    True
    """
    modules = _modules(os.environ.get("TYREFEM_EFFECTS", ""))
    return dict(_by_name(modules, Effect.made))


@functools.lru_cache(maxsize=1)
def _by_name(modules: frozenset[str], made: int) -> dict[str, type[Effect]]:
    """The effects of some modules; ``made``: number of classes of effects so far, which asks for a new search."""
    effects: dict[str, type[Effect]] = {}
    classes = [Effect]
    for cls in classes:
        classes += cls.__subclasses__()
    for cls in classes:
        if not cls.name or cls.__module__ not in modules:
            continue
        if getattr(sys.modules[cls.__module__], cls.__name__, None) is not cls:
            continue  # from an earlier version of its file
        if cls.name in effects:
            both = " and ".join(sorted({cls.__module__, effects[cls.name].__module__}))
            raise InputError(f"two effects are named '{cls.name}': in {both}")
        effects[cls.name] = cls
    return dict(sorted(effects.items()))


class EffectOf:
    """Annotation of an entry of a study's ``[[effects]]``: a table whose ``name`` is in the catalogue."""

    def __call__(self, value: Any) -> Any:
        if not isinstance(value, Mapping):
            raise InputError(f"must be a table with a name, not {value!r:.40}")
        known = catalogue()
        name = value.get("name")
        if not isinstance(name, str) or name not in known:
            raise InputError(f"unknown effect {name!r:.40}{nearest(str(name), known)}", field="name")
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
