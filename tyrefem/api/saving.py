"""Results saved from Python as the command saves them: with their study, and without loss of a user's file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from tyrefem.errors import InputError
from tyrefem.output import as_path
from tyrefem.output.file import results_file
from tyrefem.output.folder import results_folder

if TYPE_CHECKING:
    from tyrefem.inputs.origin import StudyOrigin


@contextmanager
def saving(
    folder: str | Path, command: str, files: Sequence[str], origin: StudyOrigin | None, *, force: bool
) -> Iterator[Path]:
    """Open the folder as the command does: a user's files, and results of other commands, are replaced only by force.

    Raises
    ------
    InputError : the folder cannot be written; files in it are not of this command.
    """
    folder = as_path(folder, "folder")
    with _words_of_python(), results_folder(folder, command, files, origin=origin, force=force, renews=True) as place:
        yield place


@contextmanager
def saving_file(path: str | Path, suffixes: Sequence[str], origin: StudyOrigin, *, force: bool) -> Iterator[Path]:
    """Open a single file as the command does, with its study beside it; only by force it replaces a user's file.

    Raises
    ------
    InputError : the file cannot be written, or was not made by this tool.
    """
    path = as_path(path, "path")
    with _words_of_python(), results_file(path, suffixes, origin=origin, force=force, renews=True) as place:
        yield place


@contextmanager
def _words_of_python() -> Iterator[None]:
    """Errors of this block name the arguments of Python, not the options of a command."""
    try:
        yield
    except InputError as error:
        field = None if error.field == "--out" else error.field
        raise InputError(error.message.replace("--force", "force=True"), field=field, file=error.file) from None
