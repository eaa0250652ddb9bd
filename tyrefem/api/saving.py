"""A folder of results from Python, as the command writes it: with ``study.toml`` and ``summary.json``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from tyrefem.errors import InputError
from tyrefem.inputs.origin import StudyOrigin
from tyrefem.inputs.study import StudyData
from tyrefem.output.folder import results_folder


@contextmanager
def saving(folder: str | Path, command: str, files: Sequence[str], study: StudyData, *, force: bool) -> Iterator[Path]:
    """Open the folder as the command does: a user's files, and results of other commands, are replaced only by force.

    Raises
    ------
    InputError : the folder cannot be written; files in it are not of this command.
    """
    try:
        with results_folder(folder, command, files, origin=StudyOrigin(study), force=force) as place:
            yield place
    except InputError as error:
        field = None if error.field == "--out" else error.field
        raise InputError(error.message.replace("--force", "force=True"), field=field, file=error.file) from None
