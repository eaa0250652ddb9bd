"""Files that are either complete or absent: written under a temporary name, then moved.

The package is independent of the content of the files.
"""

from __future__ import annotations

import functools
import json
import math
import os
import platform
import secrets
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import tyrefem
from tyrefem.errors import InputError, OutputError
from tyrefem.interruption import interruption_delayed


def versions() -> dict[str, str]:
    """Versions of this package, of Python and of the libraries that influence the results."""
    packages = {"tyrefem": tyrefem.__version__, "python": platform.python_version()}
    return packages | {name: _version(name) for name in ("numpy", "scipy", "scikit-fem", "pint")}


@functools.lru_cache(maxsize=8)
def _version(name: str) -> str:
    """Version of an installed library. Its metadata, with whole licences, take milliseconds to read."""
    import importlib.metadata

    return importlib.metadata.version(name)


#: Prefix of the temporary names of incomplete files.
TEMPORARY = ".tyrefem-"


class WriteGuard:
    """May refuse a file before it is written, and is informed afterwards. This base class allows all files."""

    def before_writing(self, path: Path) -> None:
        """Called before ``path`` is replaced; raises `InputError` to refuse it."""

    def after_writing(self, path: Path) -> None:
        """Called when ``path`` is complete."""

    def writes_summary(self, path: Path, data: dict[str, Any]) -> bool:
        """True if the guard writes this JSON file itself, with additional data."""
        return False


_NO_GUARD = WriteGuard()


#: The guard of the running command, or of what this thread saves: threads may save results side by side.
_guard: ContextVar[WriteGuard] = ContextVar("guard", default=_NO_GUARD)
#: The files that the running command has read: one command at a time in a process.
_read: dict[Path, None] = {}
#: The words of the command line of the running command.
_arguments: tuple[str, ...] = ()


#: Folders of complete files, in the order of writing; the message of an interruption names the last.
_written: dict[Path, None] = {}


#: Name of the file that describes a folder, with or without a result.
SUMMARY = "summary.json"


@contextmanager
def guarded(guard: WriteGuard | None) -> Iterator[None]:
    """Check every file written in this block with ``guard``; None: without checks."""
    before = _guard.get()
    _guard.set(guard or _NO_GUARD)
    try:
        yield
    finally:
        _guard.set(before)


def unguarded() -> bool:
    """True if no command guards the user's files: a call from Python."""
    return _guard.get() is _NO_GUARD


@contextmanager
def reading(arguments: Sequence[str] = ()) -> Iterator[None]:
    """Record the files read in this block as inputs of one command, and the folders that it writes for `written_to`.

    ``arguments``: the words of its command line.
    """
    global _arguments
    before, words = dict(_read), _arguments
    _read.clear()
    _written.clear()
    _arguments = tuple(arguments)
    try:
        yield
    finally:
        _arguments = words
        _read.clear()
        _read.update(before)


def note_input(path: str | Path) -> None:
    """Record a user's file as input: no command may overwrite it."""
    _read[Path(path).absolute()] = None


def inputs_read() -> tuple[Path, ...]:
    """The files that this command has read so far."""
    return tuple(_read)


def command_arguments() -> tuple[str, ...]:
    """The words of the running command's line, without the name of the program; none from Python."""
    return _arguments


def written_to() -> Path | None:
    """The folder of the latest complete file of this command; None: no file yet."""
    # Temporary folders no longer exist.
    return next((folder for folder in reversed(_written) if folder.is_dir()), None)


def _note_written(path: Path) -> None:
    if path.name != SUMMARY:
        _written.pop(path.parent, None)
        _written[path.parent] = None


def begin_writing(path: Path) -> None:
    """Announce a file that is written in place, or continued from an earlier attempt.

    Raises
    ------
    InputError : the command may not write this file.
    """
    _guard.get().before_writing(path)


def end_writing(path: Path) -> None:
    """Report a file written in place as complete."""
    _guard.get().after_writing(path)


def as_path(path: str | Path, field: str) -> Path:
    """The path that a caller from Python gives as the argument ``field``.

    Raises
    ------
    InputError : neither text nor path, empty, or with a zero character.

    >>> as_path("out", "folder").name
    'out'
    """
    if not isinstance(path, str | os.PathLike) or isinstance(os.fspath(path), bytes):
        raise InputError(f"must be a path, as text or Path, not {path!r:.60}", field=field)
    if not os.fspath(path):
        raise InputError("is empty; give a path, '.' for this folder", field=field)
    if "\0" in os.fspath(path):
        raise InputError(f"a path has no zero character: {os.fspath(path)!r:.60}", field=field)
    return Path(path)


def place_of_output(path: str | Path) -> Path:
    """The absolute path of a folder for results.

    Raises
    ------
    InputError : the path, or a folder above it, is a file or a broken link; Windows has no such drive.
    """
    whole = Path(os.path.abspath(path))
    place = whole
    while not os.path.lexists(place):
        if place.parent == place:
            raise InputError("there is no such drive", file=place, field="--out")
        place = place.parent
    if not place.exists():
        raise InputError("is a link to nothing: mend or remove it", file=place, field="--out")
    if not place.is_dir():
        raise InputError("a file is in the place of this folder", file=place, field="--out")
    return whole


def _temporary(path: Path) -> Path:
    """An unused name in the same folder (for an atomic move), with the same suffix."""
    return path.with_name(f"{TEMPORARY}{secrets.token_hex(4)}{path.suffix}")


def remove_temporary(folder: Path) -> None:
    """Remove incomplete files of a killed command from ``folder``; no other command may be writing there."""
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
            raise OutputError(f"cannot be written: {error.strerror or error}", file=path) from error
        raise


@contextmanager
def atomic_path(path: str | Path) -> Iterator[Path]:
    """A temporary path beside ``path``: moved to ``path`` if the block succeeds, else removed.

    Missing folders are created. A reader never sees an incomplete file, and an older file survives a failure.

    Raises
    ------
    InputError : the folder or the file cannot be written (`OutputError`), or the command may not write this file.

    >>> import tempfile
    >>> target = Path(tempfile.mkdtemp()) / "out" / "summary.json"
    >>> with atomic_path(target) as temporary:
    ...     _ = temporary.write_text("{}")
    >>> target.read_text(), [file.name for file in target.parent.iterdir()]
    ('{}', ['summary.json'])
    """
    path = Path(os.path.abspath(path))
    if not path.name:
        raise InputError("is a folder; a file is wanted", file=path)
    temporary = _temporary(path)
    with _cannot_be_written(path, temporary):
        _guard.get().before_writing(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            yield temporary
            with interruption_delayed():
                os.replace(temporary, path)
                _note_written(path)
                _guard.get().after_writing(path)
        finally:
            with interruption_delayed(), suppress(OSError):
                temporary.unlink(missing_ok=True)


@contextmanager
def atomic_folder(folder: str | Path) -> Iterator[Path]:
    """A temporary folder: its files are moved into ``folder`` if the block succeeds, else it is removed.

    Files of the same name are replaced individually; other files in ``folder`` stay.

    Raises
    ------
    InputError : the folder cannot be written, or a file has the name of a folder.
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
                _guard.get().before_writing(folder / file.relative_to(temporary))
            # All files or none: files of two runs together would belong to neither.
            with interruption_delayed():
                for file in files:
                    _move(file, folder / file.relative_to(temporary))
        finally:
            with interruption_delayed():
                shutil.rmtree(temporary, ignore_errors=True)


def _move(file: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    if target.suffix == ".json" and _guard.get().writes_summary(target, json.loads(file.read_text(encoding="utf-8"))):
        return
    os.replace(file, target)
    _note_written(target)
    _guard.get().after_writing(target)


def jsonable(value: Any) -> Any:
    """Plain data for JSON: numpy scalars become Python's, NaN and infinity become null."""
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
    """Write JSON completely or not at all."""
    plain = jsonable(data)
    if not _guard.get().writes_summary(Path(os.path.abspath(path)), plain):
        with atomic_path(path) as temporary:
            temporary.write_text(json.dumps(plain, indent=1) + "\n", encoding="utf-8")
    return path
