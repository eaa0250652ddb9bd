"""The numbers of an array as a key of a cache."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

#: Number of bytes at either end of the numbers in the hash, which must be fast: lookups occur at every step of a run.
SAMPLE = 128


@dataclass(frozen=True)
class Content:
    """All numbers of an array with their type and shape: equal for equal arrays only.

    A lookup copies and compares the numbers, which takes about as long as their sum. Arrays that are large, or looked
    up once per run, are better represented by their `tyrefem.cache.fingerprint`.

    >>> import numpy as np
    >>> Content.of(np.arange(4)) == Content.of(np.arange(4))
    True
    >>> Content.of(np.arange(4)) == Content.of(np.arange(4).reshape(2, 2))
    False
    """

    kind: str
    shape: tuple[int, ...]
    numbers: bytes

    @classmethod
    def of(cls, array: Any) -> Content:
        """The present content of an array."""
        array = np.asarray(array)
        return cls(array.dtype.str, array.shape, array.tobytes())

    def __hash__(self) -> int:
        return hash((self.kind, self.shape, self.numbers[:SAMPLE], self.numbers[-SAMPLE:]))
