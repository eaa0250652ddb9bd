"""The catalogue of physical effects that a model may lack. One class per effect, found by existing.

An effect is an `Effect` subclass in a module of this package, or in a Python file of a folder that the user names in
``TYREFEM_EFFECTS``.
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

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from tyrefem.effects.effect import Effect, Parameter, Prior
from tyrefem.errors import InputError, nearest

__all__ = ["Effect", "EffectOf", "Parameter", "Prior", "catalogue"]


@functools.cache
def _modules(folders: str) -> None:
    """Import every module that defines effects."""
    for module in pkgutil.iter_modules(__path__):
        importlib.import_module(f"{__name__}.{module.name}")
    for folder in filter(None, folders.split(os.pathsep)):
        if not Path(folder).is_dir():
            raise InputError(f"TYREFEM_EFFECTS names '{folder}', which is no folder")
        for file in sorted(Path(folder).glob("*.py")):
            name = f"tyrefem_user_effects_{file.stem}"
            spec = importlib.util.spec_from_file_location(name, file)
            assert spec is not None
            assert spec.loader is not None
            module_object = importlib.util.module_from_spec(spec)
            sys.modules[name] = module_object
            try:
                spec.loader.exec_module(module_object)
            except Exception as error:
                raise InputError(f"cannot be loaded as effects: {error}", file=file) from error


def catalogue() -> dict[str, type[Effect]]:
    """Every effect by name, in alphabetical order.

    >>> "hot-road" in catalogue()
    True
    """
    _modules(os.environ.get("TYREFEM_EFFECTS", ""))
    found: dict[str, type[Effect]] = {}
    stack = list(Effect.__subclasses__())
    while stack:
        one = stack.pop()
        stack.extend(one.__subclasses__())
        if one.name:
            found[one.name] = one
    return dict(sorted(found.items()))


class EffectOf:
    """Annotation of an entry of a study's ``[[effects]]``: a table whose ``name`` is in the catalogue."""

    def __call__(self, value: Any) -> Any:
        if not isinstance(value, Mapping):
            raise InputError(f"must be a table with a name, not {value!r:.40}")
        known = catalogue()
        name = value.get("name")
        if not isinstance(name, str) or name not in known:
            raise InputError(f"unknown effect {name!r:.40}{nearest(str(name), known)}", field="name")
        return known[name].check({key: entry for key, entry in value.items() if key != "name"})

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self)
