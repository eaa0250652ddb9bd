"""A folder with the results of one run of one command, in which the user's files are safe.

``summary.json`` in the folder lists the files that the command wrote, each with a checksum. All other files, and
files changed since then, are the user's: commands replace or remove them only with ``--force``. A file that the
command has read is never overwritten. At the end, files of an earlier run that this run did not write are removed.
While a command writes, ``complete`` is false.
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
import warnings
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from tyrefem.errors import InputError, ResultWarning
from tyrefem.interruption import interruption_delayed
from tyrefem.output import (
    SUMMARY,
    TEMPORARY,
    WriteGuard,
    atomic_path,
    command_arguments,
    guarded,
    inputs_read,
    jsonable,
    place_of_output,
    remove_temporary,
    versions,
    write_json,
)
from tyrefem.output.origin import ResultsOrigin

#: Keys of ``summary.json`` that belong to the folder, not to the result.
COMMAND, COMPLETE, FILES, CHECKSUMS, WRITING = "command", "complete", "files", "checksums", "writing"
ARGUMENTS, FILES_READ, VERSIONS = "arguments", "files_read", "versions"
BOOKKEEPING = (COMMAND, ARGUMENTS, FILES_READ, COMPLETE, FILES, CHECKSUMS, WRITING)
#: Errors of a file system that has no locks.
NO_LOCKS = (errno.ENOLCK, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOSYS)
#: Largest number of foreign files in an error.
NAMED = 5


def checksum(path: Path) -> str:
    """Checksum of a file's content: 64 bits of BLAKE2."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, lambda: hashlib.blake2b(digest_size=8)).hexdigest()


@contextmanager
def results_folder(
    folder: str | Path,
    command: str,
    names: Sequence[str],
    *,
    origin: ResultsOrigin | None,
    inputs: Iterable[str | Path] = (),
    force: bool = False,
    keeps: Sequence[str] = (),
    renews: bool = False,
) -> Iterator[Path]:
    """Open a folder for the results of one command, with all checks before any computing.

    Parameters
    ----------
    folder : created if missing, and removed again if it stays empty.
    command : that writes, e.g. ``"run"``.
    names : files that it may write, relative to the folder, with ``*`` for parts that are not known yet.
    origin : the study that makes the results: its file is written beside them, and ``summary.json`` if the command
        writes none. None: the results come from no study.
    inputs : files that the command reads, besides those already read.
    force : replace foreign files of these names, and another command's results.
    keeps : names of files with finished work for a later attempt: the folder is marked at once, and they stay.
    renews : also replace files that have been read: Python has their data in memory.

    Raises
    ------
    InputError : the folder cannot be written, is in use, holds another command's results, a foreign file of one of
        these names, or an input of this command.
    """
    place = place_of_output(folder)
    made = [path for path in (place, *place.parents) if not path.exists()]
    try:
        with _locked(place):
            files = tuple(map(Path, inputs))
            guard = ResultsFolder(place, command, names, files, origin=origin, force=force, keeps=keeps, renews=renews)
            guard.check()
            try:
                with guarded(guard):
                    guard.mark(keeps)
                    yield Path(folder)
                with interruption_delayed():
                    with guarded(guard):
                        guard.write_origin()
                    guard.finish()
            except BaseException:
                with interruption_delayed():
                    with suppress(OSError, InputError), guarded(guard):
                        guard.write_origin()
                    with suppress(OSError, InputError):
                        guard.restore()
                    with suppress(OSError):
                        guard.remove_half_written()
                raise
    finally:
        with interruption_delayed():
            for path in made:
                with suppress(OSError):
                    path.rmdir()


@contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """Lock the folder for this process until the process ends, even by a crash.

    Some network file systems have no locks: there results are written without one.
    """
    from filelock import FileLock, Timeout  # imports asyncio

    lock, unlocked = FileLock(folder / f"{TEMPORARY}lock"), False
    try:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with interruption_delayed():
                lock.acquire(timeout=0)
        except (OSError, NotImplementedError) as error:
            unlocked = _without_locks(lock.lock_file)
            if not unlocked and isinstance(error, Timeout):
                raise InputError(
                    "another command is writing into this folder; wait for it, or choose another folder",
                    file=folder,
                    field="--out",
                ) from None
            if not unlocked:
                # The lock of another user's command that was killed is still there.
                place = Path(lock.lock_file) if os.path.lexists(lock.lock_file) else folder
                reason = getattr(error, "strerror", None) or error
                raise InputError(f"cannot be written: {reason}", file=place, field="--out") from None
            message = f"{folder}: its file system has no locks; only one command at a time may write into this folder"
            warnings.warn(message, ResultWarning, stacklevel=2)
        yield
    finally:
        with interruption_delayed():
            if lock.is_locked or unlocked:
                with suppress(OSError):
                    os.unlink(lock.lock_file)
            if lock.is_locked:
                lock.release()


def _without_locks(file: str) -> bool:
    """Whether the file system has no locks. Some versions of filelock take that for the lock of another command."""
    try:
        import fcntl
    except ImportError:  # Windows
        return False
    try:
        with open(file, "rb") as stream:
            fcntl.flock(stream, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError as error:
        return error.errno in NO_LOCKS
    return False


class ResultsFolder(WriteGuard):
    """A folder used by one command: owners of its files, and written files. Made by `results_folder`."""

    def __init__(
        self,
        folder: Path,
        command: str,
        names: Sequence[str],
        inputs: Sequence[Path],
        *,
        origin: ResultsOrigin | None,
        force: bool,
        keeps: Sequence[str],
        renews: bool,
    ) -> None:
        self.folder = folder
        self.command = command
        self.names = (SUMMARY, *names, *(origin.names(folder) if origin else ()), *keeps)
        self._origin = origin
        self.force = force
        self._keeps = tuple(keeps)
        self._renews = renews
        self._inputs = tuple(inputs)
        self._earlier_summary_text = self._summary_text()
        self._earlier = _summary_content(self._earlier_summary_text)
        self._written: dict[str, str] = {}
        self._being_written: list[str] = []
        self._read: dict[str, str] = {}
        self._summary: dict[str, Any] = {}
        self.remove_half_written()
        #: Unchanged files of an earlier run of this tool, with their checksums.
        self._listed = self._listed_before()

    def remove_half_written(self) -> None:
        """Remove incomplete files: of a killed command, or of this one where Ctrl-C met the writing itself."""
        for parent in {Path(name).parent.as_posix() for name in self.names}:
            for place in self.folder.glob(parent) if parent != "." else [self.folder]:
                remove_temporary(place)

    # -- before any computing ----------------------------------------------------------------------------------------

    def check(self) -> None:
        """Raise an error if a file of the user would be lost."""
        present = self._matching(self.names)
        for name in present:
            self._refuse_input(self.folder / name)
            if (self.folder / name).is_dir():
                raise InputError("a folder is in the place of this file", file=self.folder / name, field="--out")
        if self.force:
            return
        other = self._earlier.get(COMMAND, self.command)
        if other != self.command:
            raise InputError(
                f"holds the results of 'tyrefem {other}'; choose another folder, or replace them with --force",
                file=self.folder,
                field="--out",
            )
        foreign = [name for name in present if not self._is_among(name, self._listed)]
        if foreign:
            listed = ", ".join(foreign[:NAMED]) + (", ..." if len(foreign) > NAMED else "")
            raise InputError(
                f"'tyrefem {self.command}' would overwrite files that it did not write, or that have changed since:"
                f" {listed}; choose another folder, or replace with --force",
                file=self.folder,
                field="--out",
            )

    def mark(self, names: Sequence[str]) -> None:
        """Record in ``summary.json`` that the folder is incomplete, and the files being written."""
        new = [name for name in names if name not in self._being_written]
        if new:
            self._being_written += new
            self._write_summary(complete=False)

    # -- while it writes ---------------------------------------------------------------------------------------------

    def before_writing(self, path: Path) -> None:
        """Raise an error for an input or a foreign file; mark the folder as incomplete."""
        self._refuse_input(path)
        name = self._name(path)
        if name is None:
            return
        known = name == SUMMARY or name in self._written or _matches(name, self._being_written)
        if os.path.lexists(path) and not (known or self.force or self._is_among(name, self._listed)):
            raise InputError(
                f"was not written by 'tyrefem {self.command}', or has changed since; see --force", file=path
            )
        self.mark([next((each for each in self.names if fnmatchcase(name, each)), name)])

    def after_writing(self, path: Path) -> None:
        """Record a complete file."""
        name = self._name(path)
        if name is not None and name != SUMMARY:
            self._written[name] = checksum(path)

    def writes_summary(self, path: Path, data: dict[str, Any]) -> bool:
        """Write ``summary.json``: the result's part, the list of files and whether they are complete."""
        if self._name(path) != SUMMARY:
            return False
        self._summary = data
        self._write_summary(complete=False)
        return True

    # -- at the end --------------------------------------------------------------------------------------------------

    def write_origin(self) -> None:
        """Write what made the results, if there are any: files and summary that the command has not written itself."""
        if self._origin is None or not self._has_results():
            return
        if not set(self._origin.names(self.folder)) <= set(self._written):
            self._origin.write(self.folder)
        self._summary = self._summary or jsonable(self._origin.summary())

    def _has_results(self) -> bool:
        """Whether a file was written that is no work kept for a later attempt."""
        return bool(self._summary) or any(not _matches(name, self._keeps) for name in self._written)

    def finish(self) -> None:
        """Remove remaining files of the earlier run, and mark the folder as complete."""
        if not self._being_written and not self._summary:
            return
        kept = {str(name) for name in self._summary.get(FILES, [])}
        for name in sorted(set(self._listed) - set(self._written) - kept - {SUMMARY}):
            if not _matches(name, self._keeps):
                if not self._is_among(name, self._written):
                    self._remove(self.folder / name)
                del self._listed[name]
        self._write_summary(complete=bool(self._summary.get(COMPLETE, True)))

    def restore(self) -> None:
        """After a failure or an interruption: restore the folder, or mark it as incomplete."""
        if self._written or self._summary:
            self._write_summary(complete=False)
        elif self._being_written and self._earlier_summary_text is None:
            (self.folder / SUMMARY).unlink(missing_ok=True)
        elif self._being_written:
            with atomic_path(self.folder / SUMMARY) as temporary:
                temporary.write_text(str(self._earlier_summary_text), encoding="utf-8")

    def _write_summary(self, *, complete: bool) -> None:
        self._refuse_input(self.folder / SUMMARY)
        sums = {**self._listed, **self._written}
        sums = {name: sums[name] for name in sorted(sums) if name != SUMMARY and (self.folder / name).is_file()}
        # Until there are new results, the earlier ones stand with what made them.
        earlier = {key: entry for key, entry in self._earlier.items() if key not in BOOKKEEPING}
        data = {
            VERSIONS: versions(),
            **(self._summary or ({} if complete else earlier)),
            COMMAND: self.command,
            ARGUMENTS: list(command_arguments()),
            FILES_READ: self._sums_of_inputs(),
            COMPLETE: complete,
            FILES: list(sums),
            CHECKSUMS: sums,
            **({} if complete else {WRITING: self._being_written}),
        }
        with guarded(None):
            write_json(data, self.folder / SUMMARY)

    def _sums_of_inputs(self) -> dict[str, str]:
        """Checksums of the files that the command has read, by path; each is read once."""
        for file in (*self._inputs, *inputs_read()):
            place = os.path.abspath(file)
            if place not in self._read:
                with suppress(OSError):
                    self._read[place] = checksum(Path(place))
        return dict(sorted(self._read.items()))

    # -- what is whose -----------------------------------------------------------------------------------------------

    def _summary_text(self) -> str | None:
        with suppress(OSError, UnicodeDecodeError):
            return (self.folder / SUMMARY).read_text(encoding="utf-8")
        return None

    def _listed_before(self) -> dict[str, str]:
        sums, writing = self._earlier.get(CHECKSUMS), self._earlier.get(WRITING)
        sums = sums if isinstance(sums, dict) else {}
        being_written = self._matching(map(str, writing)) if isinstance(writing, list) else []
        now = {name: self._checksum(name) for name in {*sums, *being_written, *([SUMMARY] if self._earlier else [])}}
        return {
            name: value for name, value in now.items()
            if value is not None and (name == SUMMARY or name in being_written or value == sums[name])
        }  # fmt: skip

    def _checksum(self, name: str) -> str | None:
        if Path(name).is_absolute() or ".." in Path(name).parts:
            return None
        with suppress(OSError):
            return checksum(self.folder / name)
        return None

    def _matching(self, names: Iterable[str]) -> list[str]:
        """Files of these names in the folder, and broken links of these names."""
        patterns = [name for name in names if name and not Path(name).is_absolute() and ".." not in Path(name).parts]
        matching = {path.relative_to(self.folder).as_posix() for each in patterns for path in self.folder.glob(each)}
        return sorted(matching | {each for each in patterns if os.path.lexists(self.folder / each)})

    def _name(self, path: Path) -> str | None:
        """A file's name relative to the folder; None: it is in another folder."""
        with suppress(ValueError):
            return Path(os.path.abspath(path)).relative_to(self.folder).as_posix()
        return None

    def _is_among(self, name: str, others: Collection[str]) -> bool:
        """Whether a file is one of these, perhaps in other capital letters: on Windows and macOS that is one file."""
        if name in others:
            return True
        alike = [other for other in others if other.casefold() == name.casefold()]
        with suppress(OSError):
            return any(os.path.samefile(self.folder / name, self.folder / other) for other in alike)
        return False

    def _is_input(self, path: Path) -> bool:
        with suppress(OSError):
            place = path.stat()
            for file in (*self._inputs, *inputs_read()):
                with suppress(OSError):
                    if os.path.samestat(file.stat(), place):
                        return True
        return False

    def _refuse_input(self, path: Path) -> None:
        if not self._renews and self._is_input(path):
            raise InputError("is an input of this command and would be overwritten; choose another --out", file=path)

    def _remove(self, path: Path) -> None:
        if self._is_input(path):
            return
        with suppress(OSError):
            path.unlink()
            for parent in path.relative_to(self.folder).parents[:-1]:
                (self.folder / parent).rmdir()


def _matches(name: str, patterns: Iterable[str]) -> bool:
    return any(fnmatchcase(name, each) for each in patterns)


def _summary_content(text: str | None) -> dict[str, Any]:
    """The content of a ``summary.json`` that `ResultsFolder` wrote; empty: none, or a foreign one."""
    try:
        data = json.loads(text or "")
    except ValueError:
        return {}
    return data if isinstance(data, dict) and isinstance(data.get(COMMAND), str) else {}
