"""The plugins that a study uses: own effects and laws in its file and cards."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from tyrefem.cards import Card
from tyrefem.plugins import Plugin, registry
from tyrefem.plugins.named import named_plugins, rows_of_plugins

if TYPE_CHECKING:
    from tyrefem.inputs.study import StudyData


def plugins_of(study: StudyData) -> tuple[Plugin, ...]:
    """The user's effects and laws that a study uses, each once, by kind and name."""
    loaded = study.parts.plugins
    used = (
        [loaded.of_class(type(card)) for card in _cards((study.card, dict(study.materials)))] if loaded.plugins else []
    )
    strain = study.card.mechanics.strain
    used += [plugin for plugin in registry().plugins if plugin.kind.name == "strain law" and plugin.name == strain]
    present = {plugin for plugin in used if plugin is not None}
    return tuple(sorted(present, key=lambda plugin: (plugin.kind.name, plugin.name)))


def _cards(value: Any) -> Iterator[Card]:
    if isinstance(value, Card):
        yield value
        for name in type(value).model_fields:
            yield from _cards(getattr(value, name))
    elif isinstance(value, Mapping):
        for entry in value.values():
            yield from _cards(entry)
    elif isinstance(value, tuple | list):
        for entry in value:
            yield from _cards(entry)


def plugin_summary(study: StudyData | None, *also: Any) -> dict[str, Any]:
    """``plugins`` of a ``summary.json``: kind, name, class, file or package, version and digest of each plugin used.

    ``also``: plain data that may name more of them. ``study``: None, where the data are all.
    """
    used = {*(plugins_of(study) if study is not None else ()), *named_plugins(list(also))}
    return {"plugins": rows_of_plugins(used)}
