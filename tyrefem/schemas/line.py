"""The comment line that tells an editor a file's schema, and the editor's settings for a folder."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from pathlib import Path

#: How the line begins; Taplo and the editors that use it read it.
BEGINS = "#:schema "
#: Folder of the schemas beside ``geometry``, ``materials`` and ``studies``.
FOLDER = "schemas"
#: The editor's settings, beside that folder.
SETTINGS = ".taplo.toml"


def schema_line(kind: str, file: Path) -> str:
    """The line for a new file of a kind; empty where no folder above it, three at most, has the schemas."""
    place = Path(os.path.abspath(file)).parent
    for folder in (place, *place.parents[:3]):
        schema = folder / FOLDER / f"{kind}.json"
        if schema.is_file():
            return f"{BEGINS}{Path(os.path.relpath(schema, place)).as_posix()}\n"
    return ""


def without_line(text: str) -> str:
    """A file's text without the line.

    >>> without_line("#:schema ../schemas/material.json\\ntitle = 'x'")
    "title = 'x'"
    """
    first, _, rest = text.partition("\n")
    return rest if first.startswith(BEGINS) else text


def settings_text(patterns: Mapping[str, Iterable[str]], folder: str) -> str:
    """Settings for Taplo: kind of file -> patterns of its files; ``folder`` holds the schemas.

    >>> print(settings_text({"rig": ["**/rig.toml"]}, "schemas"))
    # Written by: tyrefem schema. Which schema a file has, for Taplo and the editors that use it.
    <BLANKLINE>
    [[rule]]
    include = ["**/rig.toml"]
    schema = { path = "schemas/rig.json" }
    <BLANKLINE>
    """
    lines = ["# Written by: tyrefem schema. Which schema a file has, for Taplo and the editors that use it.", ""]
    for kind, files in patterns.items():
        names = ", ".join(f'"{pattern}"' for pattern in files)
        # A text of JSON is one of TOML.
        path = json.dumps(f"{folder}/{kind}.json", ensure_ascii=False)
        lines += ["[[rule]]", f"include = [{names}]", f"schema = {{ path = {path} }}", ""]
    return "\n".join(lines)
