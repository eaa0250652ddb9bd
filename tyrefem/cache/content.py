"""The numbers of an array as a cache's key."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

#: So many bytes at either end of the numbers make the hash: a cache is asked at every step of a run.
SAMPLE = 128


@dataclass(frozen=True)
class Content:
    """All numbers of an array with their type and shape: equal for equal arrays only.

    A lookup copies and compares the numbers, which takes about as long as a sum over them. What is large, or looked up
    once per run, enters a key by its `tyrefem.cache.fingerprint`.

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
        """The content of an array as it is now."""
        array = np.asarray(array)
        return cls(array.dtype.str, array.shape, array.tobytes())

    def __hash__(self) -> int:
        return hash((self.kind, self.shape, self.numbers[:SAMPLE], self.numbers[-SAMPLE:]))
