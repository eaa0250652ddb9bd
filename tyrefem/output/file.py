"""A single result file: a picture, a mesh, a model. It replaces only files of this tool."""

from __future__ import annotations

import os
import zipfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from tyrefem.errors import InputError
from tyrefem.output import WriteGuard, guarded, inputs_read, place_of_output
from tyrefem.output.origin import ResultsOrigin

#: Picture formats, by the file's suffix.
PICTURES = (".png", ".pdf", ".svg")
#: Mark in every single file that is written: in a picture's metadata, or a comment of an archive or a mesh.
MARK = b"tyrefem"
#: Suffix -> the mark with what stands about it. The word alone also stands in files that people write.
MARKS = {
    ".png": b"Software\0" + MARK,
    ".pdf": b"/Creator (" + MARK + b")",
    ".svg": b"<dc:title>" + MARK + b"</dc:title>",
    ".msh": b"$Comments\n" + MARK + b"\n$EndComments",
    ".vtu": b"<!-- " + MARK + b" -->",
    ".vtk": MARK + b", by meshio",
    ".html": b'<meta name="generator" content="' + MARK + b'">',
}
#: Suffixes of zip archives: their comment is the mark.
ARCHIVES = (".npz", ".fmu")
#: Number of bytes at a file's start and end that are searched for the mark.
SEARCHED = 1 << 16


@contextmanager
def results_file(
    path: str | Path,
    suffixes: Sequence[str],
    *,
    also: Iterable[str | Path] = (),
    origin: ResultsOrigin | None = None,
    force: bool = False,
    renews: bool = False,
) -> Iterator[Path]:
    """The file that a command writes, checked before any computing.

    Parameters
    ----------
    suffixes : allowed ones, e.g. ``(".png", ".pdf")``. also : further files that the command writes.
    origin : the study that makes the file: it is written beside the finished file.
    force : replace a file that was not made by this tool.
    renews : also replace files that have been read: Python has their data in memory.

    Raises
    ------
    InputError : another suffix, a folder or a broken link of that name, a folder that cannot be written, a foreign
        file, an input of this command.
    """
    path = Path(path)
    if path.is_dir():
        raise InputError("is a folder; a file is wanted", file=path, field="--out")
    if path.suffix.lower() not in suffixes:
        raise InputError(f"'{path}' must end with {' or '.join(suffixes)}", field="--out")
    guard = _FileGuard(renews=renews)
    beside = () if origin is None else origin.names(path.parent)
    for file in (path, *map(Path, also)):
        guard.check(Path(os.path.abspath(file)), made_by_this_tool, force=force)
    for name in beside:
        assert origin is not None
        guard.check(Path(os.path.abspath(path.parent / name)), origin.wrote, force=force)
    with guarded(guard):
        yield path
        if origin is not None:
            origin.write(path.parent)


class _FileGuard(WriteGuard):
    """Refuses to overwrite files that this command has read, but unless it ``renews`` them."""

    def __init__(self, *, renews: bool) -> None:
        self._renews = renews

    def check(self, path: Path, ours: Callable[[Path], bool], *, force: bool) -> None:
        """Raise an error if a file cannot be written, or is there and not ``ours``."""
        place_of_output(path.parent)
        above = path.parent
        while not above.exists():
            above = above.parent
        if not os.access(above, os.W_OK):
            raise InputError("cannot be written: no permission", file=above, field="--out")
        if path.is_symlink() and not path.exists():
            raise InputError("is a link to nothing: mend or remove it", file=path, field="--out")
        self.before_writing(path)
        if path.exists() and not force and not ours(path):
            message = "exists and was not made by tyrefem, or has changed since; replace it with --force"
            raise InputError(message, file=path, field="--out")

    def before_writing(self, path: Path) -> None:
        """Raise an error for an input."""
        for file in () if self._renews else inputs_read():
            with suppress(OSError):
                if os.path.samefile(path, file):
                    raise InputError("is an input of this command and would be overwritten", file=path, field="--out")


def made_by_this_tool(path: Path) -> bool:
    """True if the file has this tool's mark, in the form of its kind of file."""
    suffix = path.suffix.lower()
    if suffix in ARCHIVES:
        with suppress(OSError, zipfile.BadZipFile), zipfile.ZipFile(path) as archive:
            return archive.comment == MARK
    mark = MARKS.get(suffix)
    if mark is None:
        return False
    with suppress(OSError), path.open("rb") as stream:
        first = stream.read(SEARCHED)
        stream.seek(max(path.stat().st_size - SEARCHED, 0))
        return mark in first or mark in stream.read()
    return False


def mark_archive(path: Path) -> None:
    """Add the mark to a zip archive, as its comment."""
    with zipfile.ZipFile(path, "a") as archive:
        archive.comment = MARK
