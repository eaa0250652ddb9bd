"""Results of a sweep on disk: one file that only grows, so that a killed sweep can resume."""

from __future__ import annotations

import json
import math
import os
import re
import sys
import warnings
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tyrefem.errors import InputError, ResultWarning
from tyrefem.interruption import interruption_delayed
from tyrefem.output import begin_writing, end_writing, jsonable
from tyrefem.variants.block_lines import HEAD, HEAD_OF_BLOCK, BlockInFile, block_line, numbers_of
from tyrefem.variants.blocks import OutcomeBlock, PackedOutcomes
from tyrefem.variants.outcome_table import OutcomeTable
from tyrefem.variants.outcomes import Outcome, outcome_of

#: File of the lines, in the sweep's folder.
NAME = "variants.jsonl"
#: Single outcomes of a resumed file are packed in memory when they are so many.
TOGETHER = 4096
#: New blocks within the first so many bytes of the file stay in memory, too.
HELD = 2**25


@dataclass(eq=False)
class Store:
    """The finished variants of one plan.

    The file has a line for each of the following; it is flushed to disk after every `add`. An incomplete last line,
    of a killed sweep, is dropped with a warning.

    - ``{"plan": digest}``, first: the plan.
    - ``{"names": [answer, ...], "texts": [...]}``: names of answers, and which are texts; blocks refer to these lines
      by their number.
    - ``{"bytes": length, "variants": "0-63", "by": ..., "names": number, "columns": base64}``: an
      `OutcomeBlock`. When the file is opened, only its head is read.
    - ``{"variant": name, "answers": {...}}`` or ``{"variant": name, "failure": "..."}``: a single outcome.
    - ``{"note": name, "value": ...}``: a value that belongs to all variants.

    Parameters
    ----------
    folder : the sweep's folder. digest : of the plan.
    """

    folder: Path
    digest: str
    #: Outcomes of numbered variants; single outcomes of variants with other names.
    outcomes: OutcomeTable = field(default_factory=OutcomeTable)
    by_name: dict[str, Outcome] = field(default_factory=dict)
    #: Notes by name, e.g. the certificate of a reduced model.
    notes: dict[str, Any] = field(default_factory=dict)
    #: Names of answers, and those of texts among them, in the order of the file.
    _names: dict[tuple[tuple[str, ...], tuple[str, ...]], int] = field(default_factory=dict)
    _end: int = 0
    _file: Any = None

    @property
    def path(self) -> Path:
        """The file."""
        return self.folder / NAME

    def __len__(self) -> int:
        return len(self.outcomes) + len(self.by_name)

    def open(self, *, restart: bool = False) -> int:
        """Open the file, read which variants are finished, and return their number.

        Raises
        ------
        InputError : the folder holds another sweep, or a damaged file, or cannot be written.
        """
        begin_writing(self.path.absolute())
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            if restart:
                self.path.unlink(missing_ok=True)
            if self.path.exists():
                self._read()
            self._file = open(self.path, "ab")  # noqa: SIM115 - kept open, closed by `close`
            self._file.truncate(self._end)
            if not self._end:
                self._write(_line({"plan": self.digest}))
        except OSError as error:
            self.close()
            raise InputError(f"cannot be written: {error.strerror or error}", file=self.path) from None
        except InputError:
            self.close()
            raise
        return len(self)

    def _read(self) -> None:
        """Read all complete lines, of blocks only the heads."""
        size, singles = self.path.stat().st_size, dict[int, Outcome]()
        with open(self.path, "rb") as file:
            while self._end < size:
                file.seek(self._end)
                head = self._head(file) if self._end else None
                try:
                    length = self._read_block(file, head) if head else self._read_single(file, singles)
                except InputError:
                    raise
                except (ValueError, KeyError, TypeError, IndexError):
                    raise self._unreadable() from None
                if not length:
                    break
                self._end += length
                if len(singles) >= TOGETHER:
                    self.outcomes.update(singles)
                    singles.clear()
        self.outcomes.update(singles)
        if self._end < size and self._end:
            warnings.warn(
                f"{self.path}: the last record is incomplete and is dropped; its variants are computed again",
                ResultWarning,
                stacklevel=4,
            )

    def _head(self, file: Any) -> re.Match[bytes] | None:
        """The head of the block at the end of what is read; None: no block, or an incomplete line."""
        start = file.read(HEAD)
        if not start.startswith(b'{"bytes"'):
            return None
        # A head with many separate numbers is longer.
        return HEAD_OF_BLOCK.match(start) or HEAD_OF_BLOCK.match(start + file.readline())

    def _unreadable(self) -> InputError:
        if not self._end:
            words = "is not a file of finished variants: move it away, or replace it with --restart --force"
            return InputError(words, file=self.path)
        return InputError(
            f"the record at byte {self._end} is damaged; delete the finished variants with --restart", file=self.path
        )

    def _read_block(self, file: Any, head: re.Match[bytes]) -> int:
        """Add the block of a head, without its content; returns the length of its line, 0: it is incomplete."""
        length, start = int(head[1]), self._end
        file.seek(start + length - 1)
        last = file.read(1)
        if not last:
            return 0
        if last != b"\n":
            raise ValueError("another length")
        numbers = numbers_of(head[2].decode())
        if len(self.outcomes.without(numbers)) == len(numbers):
            names, texts = list(self._names)[int(head[4])]
            by: Any = head[3].decode()
            self.outcomes.add(
                OutcomeBlock(numbers, names, texts, by, BlockInFile(self.path, start + head.end(), start + length))
            )
        return length

    def _read_single(self, file: Any, singles: dict[int, Outcome]) -> int:
        """Read a line that is no block; returns its length, 0: it is incomplete."""
        file.seek(self._end)
        line = file.readline()
        if not line.endswith(b"\n"):
            return 0
        entry = json.loads(line, object_pairs_hook=_shared)
        if not self._end:
            self._check_plan(entry)
        elif "note" in entry:
            self.notes[str(entry["note"])] = entry["value"]
        elif "variant" in entry:
            name, outcome = entry["variant"], outcome_of(entry)
            if isinstance(name, int):
                singles.setdefault(name, outcome)
            else:
                self.by_name.setdefault(name, outcome)
        else:
            self._names.setdefault((tuple(entry["names"]), tuple(entry["texts"])), len(self._names))
        return len(line)

    def _check_plan(self, entry: Any) -> None:
        if not isinstance(entry, dict):
            raise self._unreadable()
        if entry.get("plan") != self.digest:
            raise InputError(
                "holds the variants of another sweep (another study, version, plugin or plan); choose another folder"
                " with --out, or delete them with --restart",
                file=self.path,
            )

    def add(self, outcomes: Mapping[int, Outcome] | PackedOutcomes) -> None:
        """Store outcomes of numbered variants; a second outcome of the same variant is ignored."""
        new = self.outcomes.new(outcomes)
        # Ctrl-C must not come between the file and the memory.
        with interruption_delayed():
            self._add(new)

    def _add(self, new: PackedOutcomes) -> None:
        lines: list[bytes] = []
        stored: list[tuple[OutcomeBlock, int, int]] = []
        place = self._end
        for block in new.blocks:
            names = block.names, block.texts
            if names not in self._names:
                self._names[names] = len(self._names)
                lines.append(_line({"names": list(block.names), "texts": list(block.texts)}))
                place += len(lines[-1])
            line, begin = block_line(block, self._names[names])
            stored.append((block, place + begin, place + len(line)))
            lines.append(line)
            place += len(line)
        lines += [_line({"variant": number, **outcome.entry}) for number, outcome in new.singles.items()]
        self._write(b"".join(lines))
        for block, begin, end in stored:
            content = block.content if end < HELD else BlockInFile(self.path, begin, end)
            # The names of all such blocks are the same object.
            shared = list(self._names)[self._names[block.names, block.texts]]
            self.outcomes.add(OutcomeBlock(block.numbers, *shared, block.by, content))
        self.outcomes.update(new.singles)

    def add_by_name(self, outcomes: Mapping[str, Outcome]) -> None:
        """Store outcomes of variants with other names than numbers; a second outcome of the same name is ignored."""
        new = {name: outcome for name, outcome in outcomes.items() if name not in self.by_name}
        with interruption_delayed():
            self._write(b"".join(_line({"variant": name, **outcome.entry}) for name, outcome in new.items()))
            self.by_name |= new

    def note(self, name: str, value: Any) -> None:
        """Store a value that belongs to all variants."""
        with interruption_delayed():
            self._write(_line({"note": name, "value": value}))
            self.notes[name] = value

    def _write(self, lines: bytes) -> None:
        try:
            self._file.write(lines)
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            raise InputError(f"cannot be written: {error.strerror or error}", file=self.path) from None
        self._end += len(lines)

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


def _line(entry: Mapping[str, Any]) -> bytes:
    return (json.dumps(jsonable(entry)) + "\n").encode()


def _shared(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A mapping with names shared in memory between variants; null becomes NaN."""
    return {sys.intern(name): math.nan if value is None else value for name, value in pairs}
