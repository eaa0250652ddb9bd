"""The kinds of TOML files that a person writes, told apart by their keys, with the command that reads each."""

from __future__ import annotations

import os
import shlex
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tyrefem.errors import InputError


@dataclass(frozen=True)
class FileKind:
    """A kind of file.

    Parameters
    ----------
    name : the kind, with its article. command : command that reads such a file.
    keys : sets of keys; a file with all keys of one set is of this kind. without : keys that it never has.
    """

    name: str
    command: str
    keys: tuple[frozenset[str], ...]
    without: frozenset[str] = frozenset()

    def has(self, data: Mapping[str, Any]) -> bool:
        """Whether a file's data are of this kind."""
        return not self.without & set(data) and any(keys <= set(data) for keys in self.keys)


#: A laser rig and a thermal card have layers or films too: the first kind that fits counts.
KINDS = {
    "study": FileKind("a study", "tyrefem run", (frozenset({"drive"}),)),
    "rig": FileKind("a laser rig", "tyrefem rig simulate", (frozenset({"laser"}),)),
    "thermal": FileKind("a thermal card", "tyrefem thermal-card", (frozenset({"bodies", "films"}),)),
    "sweep": FileKind("a sweep", "tyrefem sweep", (frozenset({"study"}),), frozenset({"section"})),
    "section": FileKind("a section", "tyrefem show section", (frozenset({"layers"}), frozenset({"line"}))),
    "material": FileKind(
        "a material card", "tyrefem show material", (frozenset({"loss_tangent"}), frozenset({"conductivity"}))
    ),
}
#: Kinds that may be a folder with this file in it.
FILES = {"study": "study.toml", "rig": "rig.toml", "thermal": "thermal.toml", "sweep": "sweep.toml"}


def kind_of(data: Mapping[str, Any]) -> str | None:
    """The kind of a file's data; None if no kind fits.

    >>> kind_of({"laser": {}, "layers": []}), kind_of({"title": "x"})
    ('rig', None)
    """
    return next((kind for kind, entry in KINDS.items() if entry.has(data)), None)


def expect_kind(kind: str, data: Mapping[str, Any], path: Path) -> None:
    """Raise `InputError` for a file of another kind; it names the command that reads the file."""
    other = kind_of(data)
    if other not in (None, kind):
        raise InputError(is_another(kind, str(other), path), file=path)


def is_another(kind: str, other: str, path: Path) -> str:
    """The message for a file of another kind than the command reads."""
    return f"is {KINDS[other].name}, not {KINDS[kind].name}; try: {KINDS[other].command} {shlex.quote(str(path))}"


def other_file(kind: str, folders: Collection[Path]) -> tuple[str, Path] | None:
    """Kind and path of the first file in some folders that is of another kind than ``kind``; None: no such file."""
    return next(
        (
            (other, folder / name)
            for folder in folders
            for other, name in FILES.items()
            if other != kind and os.path.isfile(folder / name)
        ),
        None,
    )
