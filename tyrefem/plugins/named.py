"""Plugins that plain data name, and their rows for JSON."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from tyrefem.plugins.registry import Plugin, registry


def named_plugins(value: Any) -> set[Plugin]:
    """The plugins whose names are among the texts of plain data, such as the changes of variants."""
    loaded = registry()
    if not loaded.plugins:
        return set()
    texts = set(_texts(value))
    return {plugin for plugin in loaded.plugins if plugin.name.split(".")[-1] in texts}


def rows_of_plugins(used: Iterable[Plugin]) -> list[dict[str, str]]:
    """``plugins`` of a ``summary.json``: kind, name, class, file or package, version and digest, by kind and name."""
    return [plugin.to_dict() for plugin in sorted(used, key=lambda plugin: (plugin.kind.name, plugin.name))]


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        for key, entry in value.items():
            yield from _texts(key)
            yield from _texts(entry)
    elif isinstance(value, tuple | list):
        for entry in value:
            yield from _texts(entry)
