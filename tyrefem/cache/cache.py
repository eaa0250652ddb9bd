"""A bounded cache, keyed by value."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from threading import Lock
from typing import Any, Generic, TypeVar

Value = TypeVar("Value")


class Cache(Generic[Value]):
    """The most recently used values of a computation, at most ``size`` of them.

    A key is a hashable value that holds all that the computation depends on. Arrays and meshes enter a key by their
    `fingerprint`. Never use ``id(...)`` in a key: the memory of an object that is gone serves another one.

    Threads share a cache safely. The lock is free during a computation, so a computation may use the cache itself.
    Two threads may compute one value at the same time; both get the value that was stored first. A pickled cache comes
    back empty.

    Parameters
    ----------
    size : greatest number of values.

    Raises
    ------
    ValueError : a size below one.

    >>> squares = Cache[int](size=2)
    >>> [squares.get(n, lambda: n * n) for n in (3, 4, 3, 5, 3)]
    [9, 16, 9, 25, 9]
    >>> len(squares), squares.hits, squares.misses
    (2, 2, 3)
    >>> 4 in squares
    False
    """

    def __init__(self, size: int) -> None:
        if size < 1:
            raise ValueError(f"a cache holds one value or more, not {size}")
        self.size = size
        #: How often a value was there, and how often it had to be computed.
        self.hits = self.misses = 0
        self._values: OrderedDict[Hashable, Value] = OrderedDict()
        self._lock = Lock()

    def get(self, key: Hashable, compute: Callable[[], Value]) -> Value:
        """The value of a key, computed if it is not there; the least recently used value then makes room."""
        with self._lock:
            if key in self._values:
                self.hits += 1
                self._values.move_to_end(key)
                return self._values[key]
            self.misses += 1
        value = compute()
        with self._lock:
            value = self._values.setdefault(key, value)
            self._values.move_to_end(key)
            while len(self._values) > self.size:
                self._values.popitem(last=False)
        return value

    def clear(self) -> None:
        """Forget all values and counts."""
        with self._lock:
            self._values.clear()
            self.hits = self.misses = 0

    def __len__(self) -> int:
        return len(self._values)

    def __contains__(self, key: Hashable) -> bool:
        return key in self._values

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.size,)

    def __repr__(self) -> str:
        return f"Cache of {len(self)} values, {self.size} at most ({self.hits} hits, {self.misses} misses)"
