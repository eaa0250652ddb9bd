"""A user's folder of plugins."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tyrefem.contracts import TEMPLATES, template


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder that the environment names; the working folder is another."""
    place = tmp_path / "plugins"
    place.mkdir()
    monkeypatch.setenv("TYREFEM_PLUGINS", str(place))
    monkeypatch.setenv("TYREFEM_EFFECTS", "")
    monkeypatch.chdir(tmp_path)
    return place


@pytest.fixture
def write(folder: Path) -> Callable[..., Path]:
    """Write the template of a kind into the folder, changed by (old, new) texts."""

    def written(kind: str, *changes: tuple[str, str], name: str | None = None) -> Path:
        text = template(kind, name or TEMPLATES[kind])
        for old, new in changes:
            assert old in text, old
            text = text.replace(old, new)
        file = folder / f"{(name or TEMPLATES[kind]).replace('-', '_')}.py"
        file.write_text(text, encoding="utf-8")
        return file

    return written
