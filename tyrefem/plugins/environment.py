"""Which plugins the user names: environment variables, which worker processes inherit."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

#: Folders of the user's files, separated as in PATH; a single file may stand there too. The second is the older name.
FOLDERS, EFFECTS = "TYREFEM_PLUGINS", "TYREFEM_EFFECTS"
#: Entry points of installed packages that are not loaded: names, separated by commas, or "all".
OFF = "TYREFEM_PLUGINS_OFF"


def state() -> tuple[str, str, str]:
    """The values of the variables."""
    return os.environ.get(FOLDERS, ""), os.environ.get(EFFECTS, ""), os.environ.get(OFF, "")


def places(values: tuple[str, str, str]) -> Iterator[tuple[str, Path]]:
    """Variable and path of every folder or file that is named, each once."""
    known = set()
    for variable, value in zip((FOLDERS, EFFECTS), values, strict=False):
        for text in filter(None, value.split(os.pathsep)):
            path = Path(text)
            with suppress(RuntimeError):  # no such user's home: the path is not there, which is told
                path = path.expanduser()
            if os.path.realpath(path) not in known:
                known.add(os.path.realpath(path))
                yield variable, path


def is_off(entry: str, values: tuple[str, str, str]) -> bool:
    """True if an entry point is switched off.

    >>> is_off("laws", ("", "", "other, laws")), is_off("laws", ("", "", ""))
    (True, False)
    """
    names = [name.strip() for name in values[2].split(",")]
    return "all" in names or entry in names


_received: tuple[tuple[str, str, str], tuple[str, ...]] | None = None


def received() -> tuple[str, ...] | None:
    """Files that came with a study from another machine, in place of the user's folders; None without any."""
    return _received[1] if _received is not None and _received[0] == state() else None


def receive_files(files: tuple[str, ...]) -> None:
    """Use these files in place of the folders that the environment names, as long as it stays as it is."""
    global _received
    _received = (state(), files)
