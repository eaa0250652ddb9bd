"""Values that are worked out once and remembered: bounded, keyed by value, safe on threads.

Knows nothing of what it remembers.

A pure function of a few hashable values takes `functools.lru_cache` with a size. Everything else takes a `Cache`:
values that depend on arrays or meshes, values that must be dropped, values that belong to one object. An object may
keep what follows from its own fields in a `functools.cached_property`. Nobody writes into the `__dict__` of another
object. `tests/architecture/test_caches.py` checks these rules.
"""

from tyrefem.cache.cache import Cache
from tyrefem.cache.content import Content
from tyrefem.cache.fingerprint import fingerprint

__all__ = ["Cache", "Content", "fingerprint"]
