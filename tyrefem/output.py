"""Files that are either complete or not there: written under a temporary name, then moved into place."""

from __future__ import annotations

import json
import math
import os
import secrets
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from tyrefem.errors import InputError


def _temporary(path: Path) -> Path:
    """A free name in the same folder (so that moving is atomic), with the same suffix."""
    return path.with_name(f".{path.stem}.{secrets.token_hex(4)}{path.suffix}")


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
    InputError : the folder or the file cannot be written.

    >>> import tempfile
    >>> target = Path(tempfile.mkdtemp()) / "out" / "summary.json"
    >>> with atomic_path(target) as temporary:
    ...     _ = temporary.write_text("{}")
    >>> target.read_text(), [file.name for file in target.parent.iterdir()]
    ('{}', ['summary.json'])
    """
    path = Path(path)
    temporary = _temporary(path)
    with _cannot_be_written(path, temporary):
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            yield temporary
            os.replace(temporary, path)
        finally:
            with suppress(OSError):
                temporary.unlink(missing_ok=True)


@contextmanager
def atomic_folder(folder: str | Path) -> Iterator[Path]:
    """A temporary folder; if the block ends well its files are moved into ``folder``, else it is removed.

    Files of the same name are replaced one by one; other files in ``folder`` stay.

    Raises
    ------
    InputError : the folder cannot be written, or a file is in the place of a folder.
    """
    folder = Path(folder)
    temporary = _temporary(folder)
    with _cannot_be_written(folder, temporary):
        folder.mkdir(parents=True, exist_ok=True)
        temporary.mkdir()
        try:
            yield temporary
            for file in sorted(temporary.rglob("*")):
                target = folder / file.relative_to(temporary)
                if file.is_dir():
                    target.mkdir(exist_ok=True)
                else:
                    os.replace(file, target)
        finally:
            shutil.rmtree(temporary, ignore_errors=True)


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
    with atomic_path(path) as temporary:
        temporary.write_text(json.dumps(jsonable(data), indent=1) + "\n", encoding="utf-8")
    return path
