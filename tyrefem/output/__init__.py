"""Files that are either complete or not there: written under a temporary name, then moved into place.

Knows nothing of what is in the files.
"""

from __future__ import annotations

import importlib.metadata
import json
import math
import os
import platform
import secrets
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import tyrefem
from tyrefem.errors import InputError
from tyrefem.interruption import held_back


def versions() -> dict[str, str]:
    """Versions of this package, of Python and of the libraries that decide the numbers."""
    packages = {"tyrefem": tyrefem.__version__, "python": platform.python_version()}
    return packages | {name: importlib.metadata.version(name) for name in ("numpy", "scipy", "scikit-fem", "pint")}


#: Start of the names under which files are written until they are complete.
TEMPORARY = ".tyrefem-"


class WriteGuard:
    """Who may refuse a file before it is written, and learns of it afterwards. This one lets everything pass."""

    def before_writing(self, path: Path) -> None:
        """Called before ``path`` is replaced; raises `InputError` to refuse."""

    def after_writing(self, path: Path) -> None:
        """Called when ``path`` is complete."""

    def takes_summary(self, path: Path, data: dict[str, Any]) -> bool:
        """Does the guard write this JSON file itself, with more in it?"""
        return False


_NOBODY = WriteGuard()


#: The command in work and the files that it has read: one command at a time in a process.
_guard = _NOBODY
_read: dict[Path, None] = {}


#: Folders that complete files were moved into, in this order; an interruption names the last.
_written: dict[Path, None] = {}


#: What a folder says of itself, whether or not there is a result in it.
SUMMARY = "summary.json"


@contextmanager
def guarded(guard: WriteGuard | None) -> Iterator[None]:
    """Every file that is written in this block is first shown to ``guard``; None: to nobody."""
    global _guard
    before, _guard = _guard, guard or _NOBODY
    try:
        yield
    finally:
        _guard = before


@contextmanager
def reading() -> Iterator[None]:
    """The files read in this block are the inputs of one command, and `written_to` is about what it writes."""
    before = dict(_read)
    _read.clear()
    _written.clear()
    try:
        yield
    finally:
        _read.clear()
        _read.update(before)


def note_input(path: str | Path) -> None:
    """A file of the user's is read: no command writes it."""
    _read[Path(path).absolute()] = None


def inputs_read() -> tuple[Path, ...]:
    """The files read so far by this command."""
    return tuple(_read)


def written_to() -> Path | None:
    """The folder that this command has last moved a complete file into; None: nothing is written yet."""
    # Temporary folders are gone.
    return next((folder for folder in reversed(_written) if folder.is_dir()), None)


def _note_written(path: Path) -> None:
    if path.name != SUMMARY:
        _written.pop(path.parent, None)
        _written[path.parent] = None


def begin_writing(path: Path) -> None:
    """A file is going to be written in place, or taken up from an earlier try.

    Raises
    ------
    InputError : it is not this command's to write.
    """
    _guard.before_writing(path)


def end_writing(path: Path) -> None:
    """A file written in place is complete."""
    _guard.after_writing(path)


def place_of_output(path: str | Path) -> Path:
    """The whole path of a folder for results.

    Raises
    ------
    InputError : a file or a link to nothing is in its place, or in the place of a folder above it.
    """
    whole = Path(os.path.abspath(path))
    place = whole
    while not os.path.lexists(place):
        place = place.parent
    if not place.exists():
        raise InputError("is a link to nothing: mend or remove it", file=place, field="--out")
    if not place.is_dir():
        raise InputError("a file is in the place of this folder", file=place, field="--out")
    return whole


def _temporary(path: Path) -> Path:
    """A free name in the same folder (so that moving is atomic), with the same suffix."""
    return path.with_name(f"{TEMPORARY}{secrets.token_hex(4)}{path.suffix}")


def remove_temporary(folder: Path) -> None:
    """Remove what a killed command left half-written in ``folder``; nobody may be writing there."""
    for path in folder.glob(f"{TEMPORARY}{'[0-9a-f]' * 8}*"):
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)


@contextmanager
def _cannot_be_written(path: Path, temporary: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        if error.filename is None or str(error.filename).startswith((str(temporary), str(path.parent))):
            raise InputError(f"cannot be written: {error.strerror or error}", file=path) from error
        raise


@contextmanager
def atomic_path(path: str | Path) -> Iterator[Path]:
    """A temporary path beside ``path``; it becomes ``path`` if the block ends well, else it is removed.

    The folder is made if missing. A reader never sees half a file, and an older file survives a failure.

    Raises
    ------
    InputError : the folder or the file cannot be written, or is not this command's to write.

    >>> import tempfile
    >>> target = Path(tempfile.mkdtemp()) / "out" / "summary.json"
    >>> with atomic_path(target) as temporary:
    ...     _ = temporary.write_text("{}")
    >>> target.read_text(), [file.name for file in target.parent.iterdir()]
    ('{}', ['summary.json'])
    """
    path = Path(os.path.abspath(path))
    temporary = _temporary(path)
    with _cannot_be_written(path, temporary):
        _guard.before_writing(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            yield temporary
            with held_back():
                os.replace(temporary, path)
                _note_written(path)
                _guard.after_writing(path)
        finally:
            with held_back(), suppress(OSError):
                temporary.unlink(missing_ok=True)


@contextmanager
def atomic_folder(folder: str | Path) -> Iterator[Path]:
    """A temporary folder; if the block ends well its files are moved into ``folder``, else it is removed.

    Files of the same name are replaced one by one; other files in ``folder`` stay.

    Raises
    ------
    InputError : the folder cannot be written, or a file is in the place of a folder.
    """
    folder = Path(os.path.abspath(folder))
    temporary = folder / f"{TEMPORARY}{secrets.token_hex(4)}"
    with _cannot_be_written(folder, temporary):
        folder.mkdir(parents=True, exist_ok=True)
        temporary.mkdir()
        try:
            yield temporary
            files = sorted(path for path in temporary.rglob("*") if path.is_file())
            for file in files:
                _guard.before_writing(folder / file.relative_to(temporary))
            # All of them or none: a file of this run beside one of the last would tell of neither.
            with held_back():
                for file in files:
                    _move(file, folder / file.relative_to(temporary))
        finally:
            with held_back():
                shutil.rmtree(temporary, ignore_errors=True)


def _move(file: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    if target.suffix == ".json" and _guard.takes_summary(target, json.loads(file.read_text(encoding="utf-8"))):
        return
    os.replace(file, target)
    _note_written(target)
    _guard.after_writing(target)


def jsonable(value: Any) -> Any:
    """Plain data that JSON can hold: numpy scalars made Python's, NaN and infinity made null."""
    if isinstance(value, Mapping):
        return {str(key): jsonable(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [jsonable(entry) for entry in value]
    if hasattr(value, "tolist"):
        return jsonable(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value if isinstance(value, str | int | float | bool | None) else str(value)


def write_json(data: dict[str, Any], path: Path) -> Path:
    """Write JSON whole or not at all."""
    plain = jsonable(data)
    if not _guard.takes_summary(Path(os.path.abspath(path)), plain):
        with atomic_path(path) as temporary:
            temporary.write_text(json.dumps(plain, indent=1) + "\n", encoding="utf-8")
    return path
