"""A folder with small inputs, and what may never happen to it."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from every_command import workplace


@pytest.fixture(scope="session")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The inputs as they were written; not to be worked in."""
    return workplace(tmp_path_factory.mktemp("hostile") / "inputs")


@pytest.fixture
def here(inputs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of its own with the inputs; the current one."""
    place = tmp_path / "here"
    shutil.copytree(inputs, place)
    monkeypatch.chdir(place)
    monkeypatch.delenv("TYREFEM_PATH", raising=False)
    return place
