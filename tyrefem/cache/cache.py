"""A bounded cache, keyed by value."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from threading import Lock
from typing import Any, Generic, TypeVar
from weakref import WeakValueDictionary

Value = TypeVar("Value")


class Cache(Generic[Value]):
    """The most recently used values of a computation, at most ``size`` of them.

    A key is a hashable value with all inputs of the computation. In a key an array is replaced by its `Content`, a
    large object by its `fingerprint`. ``id(...)`` must not be part of a key: after an object is deleted, another one
    may have the same id.

    Threads can share a cache. The lock is not held during a computation, so a computation may use the cache. Two
    threads may compute one value at the same time; both get the value that was stored first. A pickled cache is
    restored empty.

    Parameters
    ----------
    size : largest number of values in the cache.
    shared : also find values that the cache has dropped, while other objects still refer to them. Such values must
        support weak references.

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

    def __init__(self, size: int, *, shared: bool = False) -> None:
        if size < 1:
            raise ValueError(f"a cache holds one value or more, not {size}")
        self.size = size
        #: Number of lookups that found a value, and of those that computed it.
        self.hits = self.misses = 0
        self._values: OrderedDict[Hashable, Value] = OrderedDict()
        self._held: WeakValueDictionary[Hashable, Value] | None = WeakValueDictionary() if shared else None
        self._lock = Lock()

    def get(self, key: Hashable, compute: Callable[[], Value]) -> Value:
        """The value of a key, computed if it is not stored; a full cache then drops the least recently used value."""
        with self._lock:
            known = self._find(key)
            if known is not None:
                self.hits += 1
                return known[0]
            self.misses += 1
        value = compute()
        with self._lock:
            known = self._find(key)
            return self._keep(key, value) if known is None else known[0]

    def clear(self) -> None:
        """Remove all values and counts."""
        with self._lock:
            self._values.clear()
            if self._held is not None:
                self._held.clear()
            self.hits = self.misses = 0

    def _find(self, key: Hashable) -> tuple[Value] | None:
        """The value of a key, now the most recently used; the caller has the lock."""
        if key in self._values:
            self._values.move_to_end(key)
            return (self._values[key],)
        held = None if self._held is None else self._held.get(key)
        return None if held is None else (self._keep(key, held),)

    def _keep(self, key: Hashable, value: Value) -> Value:
        self._values[key] = value
        self._values.move_to_end(key)
        if self._held is not None:
            self._held[key] = value
        while len(self._values) > self.size:
            self._values.popitem(last=False)
        return value

    def __len__(self) -> int:
        return len(self._values)

    def __contains__(self, key: Hashable) -> bool:
        return key in self._values

    def __reduce__(self) -> tuple[Any, ...]:
        return _empty, (self.size, self._held is not None)

    def __repr__(self) -> str:
        return f"Cache of {len(self)} values, {self.size} at most ({self.hits} hits, {self.misses} misses)"


def _empty(size: int, shared: bool) -> Cache[Any]:
    return Cache(size, shared=shared)
