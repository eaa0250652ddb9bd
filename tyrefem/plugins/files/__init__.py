"""The user's files as modules of this package, so that a worker process finds the classes of pickled objects.

The folder is empty: `tyrefem.plugins.loading` makes the modules from the files that the user names.
"""

from __future__ import annotations

from tyrefem.plugins.registry import registry

registry()
