"""A study written into another folder runs there as it did at home."""

from __future__ import annotations

import shutil
from pathlib import Path

import tyrefem as tf
from tyrefem import library


def own_library(root: Path) -> Path:
    """A user's folder with a study, a material card of its own and a measured table."""
    shutil.copytree(library.find("study", "example-validation").parent, root / "studies" / "mine")
    (root / "materials").mkdir()
    shutil.copyfile(library.find("material", "nasa-tread"), root / "materials" / "my-tread.toml")
    return root / "studies" / "mine"


def test_saved_study_finds_tables_and_cards(tmp_path: Path) -> None:
    study = tf.study(own_library(tmp_path / "home")).replace({"materials.tread": "my-tread", "output.every": "60 s"})
    saved = tf.study(study.save(tmp_path / "elsewhere" / "deep" / "study.toml"))
    assert [entry.table.read_text() for entry in saved.measured] == [e.table.read_text() for e in study.measured]
    assert saved.materials == study.materials
    assert saved.data["materials"]["carcass"] == "nasa-carcass"


def test_saved_beside_itself_keeps_relative_names(tmp_path: Path) -> None:
    study = tf.study(own_library(tmp_path))
    again = tf.study(study.save(study.folder / "again.toml"))
    assert again.data == study.data
