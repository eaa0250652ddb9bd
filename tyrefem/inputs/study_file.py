"""Writing a study as a file that can be run."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from tyrefem import library
from tyrefem.quantity import written


def write_study(
    data: Mapping[str, Any], folder: Path | None, path: Path, *, head: Callable[[str], str] | None = None
) -> Path:
    """Write a study's data as TOML, after the lines that ``head`` gives for this text; return the path.

    Paths relative to ``folder`` become absolute if ``path`` is in another folder.
    """
    import tomli_w

    from tyrefem.output import atomic_path

    content = dict(data) if path.parent.resolve() == folder else _portable(data, folder)
    with atomic_path(path) as temporary:
        text = tomli_w.dumps(written(content))
        temporary.write_text((head(text) if head else "") + text, encoding="utf-8", newline="\n")
    return path


def _portable(data: Mapping[str, Any], folder: Path | None) -> dict[str, Any]:
    content: dict[str, Any] = copy.deepcopy(dict(data))
    whole = (folder or Path()).resolve()
    for holder, key in [(content, "cases"), (content.get("mesh", {}), "file")]:
        if isinstance(holder.get(key), str):
            holder[key] = str(whole / holder[key])
    for entry in content.get("measured", []):
        entry["table"] = str(whole / entry["table"])
    content["section"] = library.located("section", content["section"], folder)
    content["materials"] = {
        region: library.located("material", reference, folder)
        for region, reference in content.get("materials", {}).items()
    }
    return content
