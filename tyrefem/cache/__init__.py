"""Values that are worked out once and remembered: bounded, keyed by value, safe on threads.

Knows nothing of what it remembers.
"""

from tyrefem.cache.cache import Cache
from tyrefem.cache.fingerprint import fingerprint

__all__ = ["Cache", "fingerprint"]
