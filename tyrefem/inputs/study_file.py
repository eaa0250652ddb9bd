"""Writing a study as a file that can be run."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from tyrefem import library
from tyrefem.quantity import written
from tyrefem.sizes import completed_materials


def write_study(
    data: Mapping[str, Any], folder: Path | None, path: Path, *, head: Callable[[str], str] | None = None
) -> Path:
    """Write a study's data as TOML, after the lines that ``head`` gives for this text; return the path.

    Paths relative to ``folder`` become absolute if ``path`` is in another folder.
    """
    import tomli_w

    from tyrefem.output import atomic_path

    content = dict(data) if path.parent.resolve() == folder else _portable(data, folder, path.parent)
    with atomic_path(path) as temporary:
        text = tomli_w.dumps(written(content))
        temporary.write_text((head(text) if head else "") + text, encoding="utf-8", newline="\n")
    return path


def _portable(data: Mapping[str, Any], folder: Path | None, other: Path) -> dict[str, Any]:
    content: dict[str, Any] = copy.deepcopy(dict(data))
    whole = (folder or Path()).resolve()
    for holder, key in [(content, "cases"), (content.get("mesh", {}), "file")]:
        if isinstance(holder.get(key), str):
            holder[key] = str(whole / holder[key])
    for entry in content.get("measured", []):
        entry["table"] = str(whole / entry["table"])
    content["section"] = library.located("section", content["section"], folder, other)
    materials = content.get("materials", {})
    for region, reference in completed_materials(content["section"], materials).items():
        elsewhere = library.located("material", reference, folder, other)
        # Cards by the rules of a size stay unwritten where the rules' name leads to them.
        if elsewhere != reference:
            materials[region] = elsewhere
    content["materials"] = materials
    return content
