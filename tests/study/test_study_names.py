"""The name of a study file: its own, or that of its folder for a file named study.toml."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import tyrefem as tf
from tyrefem import library


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a study, in which a person works."""
    folder = tmp_path / "my-tyre"
    folder.mkdir()
    shutil.copy(library.shipped() / "studies/nasa-22x5.5-8pr/study.toml", folder / "study.toml")
    monkeypatch.chdir(folder)
    return folder


@pytest.mark.parametrize("path", ["study.toml", "./study.toml", "../my-tyre/study.toml"])
def test_a_study_in_the_present_folder_has_its_name(path: str, here: Path) -> None:
    assert tf.study(path).name == here.name


def test_another_file_has_its_own_name(here: Path) -> None:
    (here / "study.toml").rename(here / "mine.toml")
    assert tf.study("mine.toml").name == "mine"


def test_a_study_at_the_root_of_a_disk_has_a_name(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The root's name is empty; a file there cannot be made in a test."""
    resolve = Path.resolve
    monkeypatch.setattr(Path, "resolve", lambda path, strict=False: Path("/") if path == Path() else resolve(path))
    assert tf.study("study.toml").name == "study"
