"""Plugins that a result's ``summary.json`` names and this process does not have."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from tyrefem.plugins.registry import registry


def words_of_missing(rows: Iterable[Mapping[str, Any]]) -> str:
    """What a result used and how to have it here, a sentence; empty if nothing is missing.

    ``rows``: entries of ``plugins`` of a ``summary.json`` (`tyrefem.plugins.named.rows_of_plugins`).
    """
    here = {(plugin.kind.name, plugin.name) for plugin in registry().plugins}
    missing = [row for row in rows if (row.get("kind"), row.get("name")) not in here]
    if not missing:
        return ""
    used = ", ".join(f"the {row.get('kind')} '{row.get('name')}' of {_origin(row)}" for row in missing)
    folders = dict.fromkeys(str(Path(row["file"]).parent) for row in missing if row.get("file"))
    packages = dict.fromkeys(str(row["package"]) for row in missing if row.get("package"))
    todo = [f"set TYREFEM_PLUGINS={os.pathsep.join(folders)}, or tyrefem.plugins.use in Python"] if folders else []
    todo += [f"install {' and '.join(packages)}"] if packages else []
    return f"the result used {used}, which this process has not: {', and '.join(todo)}"


def _origin(row: Mapping[str, Any]) -> str:
    return str(row["file"]) if row.get("file") else f"package {row.get('package')} {row.get('version', '')}".strip()
