"""Results of a sweep on disk: a line per variant, appended whole, so that a killed sweep goes on where it was."""

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
#: What a variant is kept under: its number in a plan, or what it changes.
Name = int | str


@dataclass(eq=False)
class Store:
    """The finished variants of one plan.

    The first line says which plan; every other one is ``{"variant": name, "answers": {...}}`` or ``{"variant": name,
    "failure": "..."}``, or a ``{"note": name, "value": ...}``. A line is written in one piece and forced to disk; what
    a kill tore off is cut away.

    Parameters
    ----------
    folder : the sweep's folder. digest : of the plan.
    """

    folder: Path
    digest: str
    done: dict[Name, dict[str, Any]] = field(default_factory=dict)
    #: What else was noted, by name: the certificate of a reduced model.
    notes: dict[str, Any] = field(default_factory=dict)
    _file: Any = None

    @property
    def path(self) -> Path:
        """The file."""
        return self.folder / NAME

    def open(self, *, restart: bool = False) -> int:
        """Take up what is there; the number of finished variants.

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
        """Read every whole line; the number of bytes that they take."""
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
                " --out, or begin anew with --restart",
                file=self.path,
            )
        self.done, self.notes = done, notes
        return whole

    def add(self, outcomes: Mapping[Name, Mapping[str, Any]]) -> None:
        """Keep the outcomes of some variants; a second one of the same variant is left out."""
        entries = {n: {"variant": n, **outcome} for n, outcome in outcomes.items() if n not in self.done}
        self._write(*entries.values())
        self.done |= entries

    def note(self, name: str, value: Any) -> None:
        """Keep something that belongs to all variants."""
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
        """No more lines."""
        if self._file is not None:
            # What a full disk did not take was refused when it was written.
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
    """A mapping whose names are kept in memory once, for all variants; a null was written for NaN."""
    return {sys.intern(name): math.nan if value is None else value for name, value in pairs}
