"""Results of a sweep on disk: a line per variant, appended whole, so that a killed sweep can resume."""

from __future__ import annotations

import json
import math
import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tyrefem.errors import InputError
from tyrefem.output import begin_writing, end_writing, jsonable

#: File of the lines, in the sweep's folder.
NAME = "variants.jsonl"
#: Key of a variant in the store: its number in a plan, or its changes.
Name = int | str


@dataclass(eq=False)
class Store:
    """The finished variants of one plan.

    The first line identifies the plan. The others are ``{"variant": name, "answers": {...}}``, ``{"variant": name,
    "failure": "..."}`` or ``{"note": name, "value": ...}``. A line is written at once and flushed to disk; an
    incomplete last line of a killed sweep is removed.

    Parameters
    ----------
    folder : the sweep's folder. digest : of the plan.
    """

    folder: Path
    digest: str
    done: dict[Name, dict[str, Any]] = field(default_factory=dict)
    #: Notes by name, e.g. the certificate of a reduced model.
    notes: dict[str, Any] = field(default_factory=dict)
    _file: Any = None

    @property
    def path(self) -> Path:
        """The file."""
        return self.folder / NAME

    def open(self, *, restart: bool = False) -> int:
        """Open the file, read the finished variants, and return their number.

        Raises
        ------
        InputError : the folder holds another sweep, or cannot be written.
        """
        begin_writing(self.path.absolute())
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            if restart:
                self.path.unlink(missing_ok=True)
            whole = self._read() if self.path.exists() else 0
            self._file = open(self.path, "ab")  # noqa: SIM115 - kept open, closed by `close`
            self._file.truncate(whole)
            if not whole:
                self._write({"plan": self.digest})
        except OSError as error:
            self.close()
            raise InputError(f"cannot be written: {error.strerror or error}", file=self.path) from None
        except InputError:
            self.close()
            raise
        return len(self.done)

    def _read(self) -> int:
        """Read all complete lines; returns their length in bytes."""
        content = self.path.read_bytes()
        whole = content.rfind(b"\n") + 1
        lines = content[:whole].splitlines()
        if not lines:
            return 0
        try:
            first, *others = [json.loads(line, object_pairs_hook=_shared) for line in lines]
            done = {entry["variant"]: entry for entry in others if "note" not in entry}
            notes = {str(entry["note"]): entry["value"] for entry in others if "note" in entry}
        except (ValueError, KeyError, TypeError):
            raise InputError("is not a file of finished variants", file=self.path) from None
        if first.get("plan") != self.digest:
            raise InputError(
                "holds the variants of another sweep (another study, version or plan); choose another folder with"
                " --out, or delete them with --restart",
                file=self.path,
            )
        self.done, self.notes = done, notes
        return whole

    def add(self, outcomes: Mapping[Name, Mapping[str, Any]]) -> None:
        """Store outcomes; a second outcome of the same variant is ignored."""
        entries = {n: {"variant": n, **outcome} for n, outcome in outcomes.items() if n not in self.done}
        self._write(*entries.values())
        self.done |= entries

    def note(self, name: str, value: Any) -> None:
        """Store a value that belongs to all variants."""
        self._write({"note": name, "value": value})
        self.notes[name] = value

    def _write(self, *entries: Mapping[str, Any]) -> None:
        try:
            self._file.write("".join(json.dumps(jsonable(entry)) + "\n" for entry in entries).encode())
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            raise InputError(f"cannot be written: {error.strerror or error}", file=self.path) from None

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            # A full disk was already reported at the write.
            with suppress(OSError):
                self._file.close()
            self._file = None
            end_writing(self.path.absolute())

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return iter(self.done.values())


def _shared(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A mapping with names shared in memory between variants; null becomes NaN."""
    return {sys.intern(name): math.nan if value is None else value for name, value in pairs}
