"""A study written into another folder runs there as it did at home."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

import tyrefem as tf
from tyrefem import library
from tyrefem.reports.explore_data import changes_of_file
from tyrefem.reports.inputs import study_text
from tyrefem.variants.task import bundle


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


def hiding_card(folder: Path, name: str, loss_tangent: str) -> Path:
    """A user's card in a folder, with the name of a shipped one and another tan delta."""
    text = library.find("material", name).read_text(encoding="utf-8")
    card = folder / "materials" / f"{name}.toml"
    card.parent.mkdir(parents=True)
    card.write_text(re.sub(r"(\[loss_tangent\][^[]*?value = )[\d.]+", rf"\g<1>{loss_tangent}", text), encoding="utf-8")
    return card


def test_saved_shipped_study_keeps_its_cards_where_others_hide_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = tf.study("nasa-22x5.5-8pr")
    hiding_card(tmp_path, "nasa-tread", "0.6")
    monkeypatch.chdir(tmp_path)
    saved = tf.study(study.save(tmp_path / "out" / "study.toml"))
    assert saved.materials == study.materials
    assert saved.data["materials"]["carcass"] == "nasa-carcass"
    # Also in the processes of a sweep, a comparison or an export.
    assert bundle(study).unpacked(tmp_path).materials == study.materials


def test_study_of_a_size_keeps_the_cards_near_it(tmp_path: Path) -> None:
    home = tmp_path / "home"
    home.mkdir()
    (home / "study.toml").write_text(
        'title = "by size"\nsection = "205/60R15"\n'
        '[drive]\nspeed = "20 m/s"\nload = "4 kN"\npressure = "2.2 bar"\nduration = "60 s"\n',
        encoding="utf-8",
    )
    ours = hiding_card(home, "rubber-tread-passenger", "0.3")
    study = tf.study(home)
    assert study.material_data["tread"][1] == ours
    saved = tf.study(study.save(tmp_path / "elsewhere" / "study.toml"))
    assert saved.materials == study.materials
    assert list(saved.data["materials"]) == ["tread"]
    (tmp_path / "worker").mkdir()
    assert bundle(study).unpacked(tmp_path / "worker").materials == study.materials


def test_study_inside_the_folder_of_a_clone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a clone the shipped library is the whole checkout, so a user's folder may stand in it."""
    clone = tmp_path / "clone"
    for folder in library.FOLDERS.values():
        (clone / folder).mkdir(parents=True, exist_ok=True)
    for card in (library.shipped() / "materials").glob("nasa-*.toml"):
        shutil.copyfile(card, clone / "materials" / card.name)
    home = clone / "work" / "mine"
    shutil.copytree(library.find("study", "nasa-22x5.5-8pr").parent, home)
    shutil.copyfile(library.find("section", "nasa-22x5.5-8pr"), home / "section.toml")
    monkeypatch.setattr(library, "shipped", lambda: clone)
    monkeypatch.chdir(tmp_path)
    study = tf.study(home, {"section": "section.toml"})
    (clone / "worker").mkdir()
    for other in (tf.study(study.save(clone / "out" / "study.toml")), bundle(study).unpacked(clone / "worker")):
        assert other.section.outer_diameter == study.section.outer_diameter
        assert other.data["materials"]["tread"] == "nasa-tread"


def test_its_own_file_is_known_after_a_change_of_the_working_directory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A script that goes into the folder for its results: the study read by a relative path is not the one there."""
    quick = {"mesh.size": "20 mm", "mesh.through": 1, "drive.duration": "10 s", "output.every": "10 s"}
    home, other = tmp_path / "home", tmp_path / "other"
    own = tf.study("nasa-22x5.5-8pr", quick).save(home / "study.toml")
    own.write_text(f"# mine\n{own.read_text(encoding='utf-8')}", encoding="utf-8")
    other.mkdir()
    monkeypatch.chdir(home)
    study = tf.study("study.toml")
    monkeypatch.chdir(other)
    assert study_text(study) == (own.read_text(encoding="utf-8"), True)
    assert changes_of_file(study.replace({"drive.speed": "25 mph"})) == {"drive.speed": "25 mph"}
    result = study.run()
    result.save(other)
    assert tf.study(other / "study.toml").data == study.data
    result.save(home)
    result.save(home, force=True)
    assert own.read_text(encoding="utf-8").startswith("# mine\n")


def test_a_record_is_read_after_a_change_of_the_working_directory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("verdict", "summary"):
        (tmp_path / name).mkdir()
        (tmp_path / name / f"{name}.json").write_text(
            '{"command": "press", "verdict": "no gap", "study": "tyre", "sets": []}', encoding="utf-8"
        )
    (tmp_path / "summary" / "harmonics.csv").write_text("n\n1\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    pressed, diagnosed = tf.load("summary"), tf.load("verdict")
    monkeypatch.chdir("/")
    assert pressed.table("harmonics")["n"].tolist() == [1]
    assert pressed.summary["study"] == diagnosed.summary["study"] == "tyre"
