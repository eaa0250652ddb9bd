"""A kind of plugin, stated by the base class of its plugins: how a class is named, and what else it needs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from tyrefem.plugins.origin import Origin

#: Attribute of a base class that holds its kind.
ATTRIBUTE = "plugin_kind"


def _no_complaint(cls: type) -> str | None:
    return None


def _takes_part(cls: type) -> bool:
    return True


def _nothing(cls: type, origin: Origin) -> None:
    pass


@dataclass(frozen=True, eq=False)
class Kind:
    """A kind of plugin. A base class has it as its ``plugin_kind``.

    Parameters
    ----------
    name, plural : "boundary law", "boundary laws". naming : how a class states its name, for errors.
    name_of : class -> its name, by which files refer to it; empty for a class that only helps others.
    shipped : the classes of this package by name; called only when there is a plugin of this kind.
    complaint : what else is wrong with a class, or None. prepare : called with a class that is accepted.
    computes : does a class take part in a computation? If not, it reads finished answers only, and those that are kept
        hold after an edit of it.
    """

    name: str
    plural: str
    naming: str
    name_of: Callable[[type], str]
    shipped: Callable[[], Mapping[str, type]]
    complaint: Callable[[type], str | None] = _no_complaint
    prepare: Callable[[type, Origin], None] = _nothing
    computes: Callable[[type], bool] = _takes_part

    @property
    def key(self) -> str:
        """Its plural in command lines: "boundary-laws"."""
        return self.plural.replace(" ", "-")


def kind_of(cls: type) -> Kind | None:
    """The kind of a class; None for a class that is no plugin."""
    kind = getattr(cls, ATTRIBUTE, None)
    return kind if isinstance(kind, Kind) else None


def is_ours(cls: type) -> bool:
    """True for a class of this package itself, False for one of a user's file or package."""
    module = cls.__module__
    return module.split(".")[0] == "tyrefem" and not module.startswith("tyrefem.plugins.files.")
