"""All plugins of this process by kind and name, and those that failed, with the reason."""

from __future__ import annotations

import functools
import multiprocessing
import os
import re
import threading
import warnings
from dataclasses import dataclass, field, replace
from pathlib import Path

from tyrefem.errors import InputError, PluginWarning
from tyrefem.plugins import environment
from tyrefem.plugins.guard import failure_words, guard, plugin_error
from tyrefem.plugins.kind import Kind, is_ours, kind_of
from tyrefem.plugins.loading import LoadedModule, entry_points, load_entry_point, load_file, python_files
from tyrefem.plugins.origin import Origin
from tyrefem.plugins.signature import wrong_signature


@dataclass(frozen=True, eq=False)
class Plugin:
    """A class that a user added: its kind, name and origin."""

    kind: Kind
    name: str
    cls: type
    origin: Origin

    def to_dict(self) -> dict[str, str]:
        """Content for JSON."""
        return {"kind": self.kind.name, "name": self.name, "class": self.cls.__name__, **self.origin.to_dict()}


@dataclass(frozen=True)
class Failure:
    """A file, package or class that cannot be used.

    Parameters
    ----------
    origin : where it is. words : what is wrong. place : the class, or empty.
    kind, name : of the class; empty if the whole file failed. mentioned : words in quotes in such a file.
    """

    origin: Origin
    words: str
    place: str = ""
    kind: str = ""
    name: str = ""
    mentioned: frozenset[str] = frozenset()

    @property
    def error(self) -> InputError:
        """The failure as an error that ends a command."""
        return plugin_error(self.origin, self.place, self.words)

    def of_file(self, kind: Kind, name: str) -> Failure:
        """The failure of a whole file as that of a plugin that it mentions."""
        return replace(self, words=f"{kind.name} '{name}' stands in this file, which {self.words}")

    def concerns(self, kind: Kind, name: str, *, known: bool) -> bool:
        """True if a file that names this plugin would mean the failed one. ``known``: there is one of that name."""
        if self.kind:
            return self.kind == kind.name and self.name == name
        return not known and (name in self.mentioned or name.split(".")[-1] in self.mentioned)


@dataclass(frozen=True, eq=False)
class Registry:
    """Plugins and failures. ``modules``: the loaded files and packages, also those without a plugin."""

    plugins: tuple[Plugin, ...] = ()
    failures: tuple[Failure, ...] = ()
    modules: tuple[LoadedModule, ...] = ()
    _by_class: dict[type, Plugin] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        self._by_class.update({plugin.cls: plugin for plugin in self.plugins})

    def classes(self, kind: Kind) -> dict[str, type]:
        """Name -> class of the plugins of a kind."""
        return {plugin.name: plugin.cls for plugin in self.plugins if plugin.kind is kind}

    def of_class(self, cls: type) -> Plugin | None:
        """The plugin of a class; None for a class of this package."""
        return self._by_class.get(cls)

    def keeps(self, other: Registry) -> bool:
        """True if it has every class of another one: none has been edited or left out since."""
        return other is self or other._by_class.keys() <= self._by_class.keys()

    def named(self, kind: Kind, name: str) -> Plugin | None:
        """The plugin of a kind and name, or None."""
        return next((plugin for plugin in self.plugins if plugin.kind is kind and plugin.name == name), None)

    def refuse(self, kind: Kind, name: object, *, known: bool) -> None:
        """Raise the error of the failed plugin that a name means, if there is one.

        Raises
        ------
        InputError : names the plugin's file, class, and what was expected.
        """
        for failure in self.failures:
            if isinstance(name, str) and failure.concerns(kind, name, known=known):
                raise failure.error if failure.kind else failure.of_file(kind, name).error


_QUOTED = re.compile(r"[\"']([\w.-]+)[\"']")
_lock = threading.RLock()
_loading = False


def registry() -> Registry:
    """The plugins that the environment names now. A failed one is warned of once, and left out."""
    with _lock:
        if _loading:
            return Registry()  # a plugin's file that asks while it is loaded
        return _registry(environment.state(), environment.received())


def forget() -> None:
    """Look for plugins again at the next call of `registry`."""
    with _lock:
        _registry.cache_clear()


@functools.lru_cache(maxsize=4)
def _registry(values: tuple[str, str, str], received: tuple[str, ...] | None) -> Registry:
    global _loading
    _loading = True
    try:
        modules, failures = _loaded(values, received)
    finally:
        _loading = False
    plugins: list[Plugin] = []
    known: set[type] = set()
    # Packages before files: a class of a package that a file imports, to extend it, stays the package's.
    for module in sorted(modules, key=lambda module: module.origin.file is not None):
        for cls in module.classes:
            if cls in known:
                continue
            known.add(cls)
            judged = _judged(cls, module.origin, plugins)
            if isinstance(judged, Plugin):
                plugins.append(judged)
            elif judged is not None:
                failures.append(judged)
    if multiprocessing.parent_process() is None:
        for failure in failures:
            warnings.warn(PluginWarning(f"left out: {failure.error}"), stacklevel=3)
    return Registry(tuple(plugins), tuple(failures), tuple(modules))


def _loaded(values: tuple[str, str, str], received: tuple[str, ...] | None) -> tuple[list[LoadedModule], list[Failure]]:
    modules: dict[str, LoadedModule] = {}
    failures: list[Failure] = []
    places = [*environment.places(values)] if received is None else [("", Path(file)) for file in received]
    tried: set[Path] = set()  # a file may be named by itself and by its folder
    for variable, place in places:
        # Not `Path.exists`, which fails at a name that is too long or in a folder that may not be read.
        if not os.path.exists(place):
            words = f"{variable} names '{place}', which is not a folder"
            failures.append(Failure(Origin(file=place), words))
            continue
        for file in python_files(place):
            if file in tried:
                continue
            tried.add(file)
            try:
                module = load_file(file)
                modules.setdefault(module.name, module)
            except InputError as error:
                failures.append(Failure(Origin(file=file), error.message, mentioned=_mentioned(file)))
    for entry in entry_points():
        if environment.is_off(entry.name, values):
            continue
        try:
            module = load_entry_point(entry)
            modules.setdefault(module.name, module)
        except InputError as error:
            package, version = (entry.dist.name, entry.dist.version) if entry.dist else (entry.name, "")
            failures.append(Failure(Origin(None, package, version, "", entry.value), error.message))
    return list(modules.values()), failures


def _mentioned(file: Path) -> frozenset[str]:
    """Words in quotes in a file that could not be loaded: the names of its plugins are among them."""
    try:
        text = file.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return frozenset()
    return frozenset(_QUOTED.findall(text))


def _judged(cls: type, origin: Origin, before: list[Plugin]) -> Plugin | Failure | None:
    """A class as a plugin, or as a failure with the reason; None for a class that is no plugin."""
    kind = kind_of(cls)
    if kind is None or is_ours(cls):
        return None
    name = kind.name_of(cls)
    try:
        return _plugin(kind, name, cls, origin, before) if name else None
    except Exception as error:  # an attribute of another type than the check of its kind expects
        words = f"{kind.name} '{name}' cannot be checked: {failure_words(error, str(origin.file or ''))}"
        return Failure(origin, words, f"class {cls.__name__}", kind.name, name)


def _plugin(kind: Kind, name: str, cls: type, origin: Origin, before: list[Plugin]) -> Plugin | Failure:
    """A class with a name as a plugin, or as a failure with the reason."""
    place = f"class {cls.__name__}"

    def failed(words: str) -> Failure:
        return Failure(origin, words, place, kind.name, name)

    lacking = sorted(getattr(cls, "__abstractmethods__", ()))
    words = f"needs {' and '.join(repr(method) for method in lacking)}" if lacking else None
    words = words or wrong_signature(cls)
    if words:
        return failed(f"{kind.name} '{name}': {words}")
    taken = kind.shipped().get(name)
    if taken is not None:
        where = f"class {taken.__name__} of {taken.__module__}"
        return failed(f"{kind.name} '{name}' has the name of a shipped {kind.name} ({where}): rename yours")
    other = next((plugin for plugin in before if plugin.kind is kind and plugin.name == name), None)
    if other is not None:
        where = f"class {other.cls.__name__} of {other.origin.words}"
        return failed(f"{kind.name} '{name}' has the name of {where}: rename either")
    words = kind.complaint(cls)
    if words:
        return failed(f"{kind.name} '{name}': {words}")
    guard(cls, origin)
    kind.prepare(cls, origin)
    return Plugin(kind, name, cls, origin)


def nameless(module: LoadedModule) -> tuple[str, ...]:
    """Sentences on the classes of a module that would be plugins if they had a name; not those that others extend."""
    sentences = []
    for cls in module.classes:
        kind = kind_of(cls)
        if kind is None or is_ours(cls) or kind.name_of(cls) or cls.__name__.startswith("_"):
            continue
        if not any(other is not cls and issubclass(other, cls) for other in module.classes):
            sentences.append(f"class {cls.__name__} has no name, so nothing can use it: write {kind.naming}")
    return tuple(sentences)
