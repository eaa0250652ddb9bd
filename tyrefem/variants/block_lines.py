"""The line of a block in the file of a sweep's finished variants: a head, and the content as base64."""

from __future__ import annotations

import base64
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tyrefem.errors import InputError
from tyrefem.variants.blocks import Numbers, OutcomeBlock

#: Bytes of a line that are read first: the head of a block with successive numbers is shorter.
HEAD = 160
#: Head of a block: its length in bytes, so that its content need not be read.
HEAD_OF_BLOCK = re.compile(
    rb'\{"bytes": +(\d+), "variants": "([-,0-9]+)", "by": "(full|reduced)", "names": (\d+), "columns": "'
)
#: Width of the length in a head.
WIDTH = 9


@dataclass(frozen=True)
class BlockInFile:
    """Content of a block in a file: from the byte ``begin`` to its line's end at ``end``.

    Raises
    ------
    InputError : the file is gone. ValueError : it is damaged there.
    """

    path: Path
    begin: int
    end: int

    def __call__(self) -> bytes:
        try:
            with open(self.path, "rb") as file:
                file.seek(self.begin)
                text = file.read(self.end - self.begin)
            return base64.b64decode(text.removesuffix(b'"}\n'), validate=True)
        except OSError as error:
            raise InputError(f"cannot be read: {error.strerror or error}", file=self.path) from None


def block_line(block: OutcomeBlock, names: int) -> tuple[bytes, int]:
    """The line of a block, and the place in it where the content begins."""
    content = block.content if isinstance(block.content, bytes) else block.content()
    variants = _ranges(block.numbers)
    rest = f', "variants": "{variants}", "by": "{block.by}", "names": {names}, "columns": "'.encode()
    begin = len('{"bytes": ') + WIDTH + len(rest)
    text = base64.b64encode(content) + b'"}\n'
    return f'{{"bytes": {begin + len(text):{WIDTH}d}'.encode() + rest + text, begin


def _ranges(numbers: Numbers) -> str:
    """Increasing numbers as text.

    >>> _ranges(np.array([0, 1, 2, 7, 9, 10]))
    '0-2,7,9-10'
    """
    parts = np.split(numbers, np.flatnonzero(np.diff(numbers) > 1) + 1)
    return ",".join(str(part[0]) if len(part) == 1 else f"{part[0]}-{part[-1]}" for part in parts)


def numbers_of(ranges: str) -> Numbers:
    """The numbers of a text of `_ranges`.

    >>> numbers_of("0-2,7").tolist()
    [0, 1, 2, 7]
    """
    ends = [part.split("-") for part in ranges.split(",")]
    return np.concatenate([np.arange(int(part[0]), int(part[-1]) + 1, dtype=np.intp) for part in ends])
