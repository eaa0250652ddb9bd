"""Computed values that are kept: bounded, keyed by value, safe on threads.

The caches are independent of what they hold.

A pure function of a few hashable values uses `functools.lru_cache` with a size. All other cases use a `Cache`: values
that depend on arrays or meshes, values that must be dropped, values that belong to one object. An object may keep
values computed from its fields in a `functools.cached_property`. No code writes into the `__dict__` of another
object. `tests/architecture/test_caches.py` checks these rules.
"""

from tyrefem.cache.cache import Cache
from tyrefem.cache.content import Content
from tyrefem.cache.fingerprint import fingerprint
from tyrefem.cache.read_only import read_only

__all__ = ["Cache", "Content", "fingerprint", "read_only"]
