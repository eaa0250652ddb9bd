"""What an earlier question left in a sweep's folder: files of ours go, a user's own and finished variants stay."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from tyrefem.output import jsonable
from tyrefem.results_folder import BOOKKEEPING

#: `summary.json` lists the other files under this name; nothing that is not like one of ours is ever removed.
FILES = "files"
LIKE_OURS = re.compile(r"(pictures/)?[^/\\]+\.(csv|parquet|png|html)")
#: What is the folder's, or words, and no result.
NOT_RESULTS = (*BOOKKEEPING, "words")
#: What makes a question another one.
QUESTION = ("study", "asked", "input", "versions")


def earlier(folder: Path) -> dict[str, Any]:
    """The summary that a folder has; empty: none, or not of a sweep."""
    try:
        found = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) and isinstance(found.get(FILES), list) else {}


def clear(folder: Path, before: Mapping[str, Any], summary: Mapping[str, Any], written: Sequence[str]) -> list[str]:
    """Remove what ``before`` lists and is neither written again nor still true; the names of ours that are there.

    Of the same question everything stays while it is not finished, and page and pictures where they are not drawn
    again and nothing has changed.
    """
    listed = [name for name in before.get(FILES, []) if isinstance(name, str) and LIKE_OURS.fullmatch(name)]
    left = [name for name in listed if name not in written and (folder / name).is_file()]
    now = json.loads(json.dumps(jsonable(summary)))
    same = all(before.get(key) == now[key] for key in QUESTION)
    kept = [
        name
        for name in left
        if same and (not now["complete"] or (name.endswith((".png", ".html")) and _results(before) == _results(now)))
    ]
    for name in left:
        if name not in kept:
            # A file that may not be removed, or a folder that is not empty, stays.
            with suppress(OSError):
                (folder / name).unlink()
                if "/" in name:
                    (folder / name).parent.rmdir()
    return [*written, *kept]


def _results(summary: Mapping[str, Any]) -> dict[str, Any]:
    """A summary without what differs each time that the same is written."""
    found = {key: value for key, value in summary.items() if key not in NOT_RESULTS}
    sample = {key: value for key, value in found.pop("sample", {}).items() if key not in ("seconds", "taken_up")}
    return found | {"sample": sample}
