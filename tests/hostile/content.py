"""What is in a folder, to the byte; what is half-written."""

from __future__ import annotations

import json
from pathlib import Path


def content(folder: Path) -> dict[str, bytes]:
    """Every file under a folder; a link is not followed."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not path.is_symlink() and path.name != ".tyrefem-lock"
    }


def unchanged(before: dict[str, bytes], folder: Path) -> None:
    """Every file that was there is there as it was."""
    now = content(folder)
    assert {name: now.get(name) for name in before} == before


def half_written(folder: Path) -> list[str]:
    """Temporary files, and files that their own format cannot read."""
    leftovers = [str(path) for path in folder.rglob("*") if path.name.startswith(".tyrefem-")]
    for path in folder.rglob("*"):
        if path.suffix == ".json":
            json.loads(path.read_text(encoding="utf-8"))
        if path.suffix == ".png" and not path.read_bytes().endswith(b"IEND\xaeB`\x82"):
            leftovers.append(str(path))
        if path.suffix == ".html" and "</html>" not in path.read_text(encoding="utf-8"):
            leftovers.append(str(path))
    return leftovers


def one_line(err: str) -> None:
    """Every line on stderr is a sentence of ours, and there is no traceback."""
    assert "Traceback" not in err
    assert all(line.startswith("tyrefem: ") for line in err.splitlines()), err
