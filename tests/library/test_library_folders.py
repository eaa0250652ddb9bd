"""Where a name is looked for, and in which order."""

from __future__ import annotations

from pathlib import Path

import pytest

from tyrefem import library
from tyrefem.errors import InputError

pytestmark = pytest.mark.fast


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    monkeypatch.delenv(library.SEARCH_PATH, raising=False)
    return tmp_path / "here"


def card(folder: Path, name: str = "mine") -> Path:
    path = folder / "materials" / f"{name}.toml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f'title = "{folder.name}"\n', encoding="utf-8")
    return path


def test_nearer_folders_win(tmp_path: Path, here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    near = tmp_path / "project/studies/cold"
    monkeypatch.setenv(library.SEARCH_PATH, f"{tmp_path / 'first'}:{tmp_path / 'second'}")
    # From the last to be asked to the first: each new card hides the one before.
    for folder in (tmp_path / "second", tmp_path / "first", here, tmp_path / "project", near.parent, near):
        made = card(folder)
        assert library.find("material", "mine", near).resolve() == made
    assert library.find("material", "mine").resolve() == here / "materials/mine.toml"


def test_own_card_hides_a_shipped_one_of_the_same_name(here: Path) -> None:
    assert library.find("material", "nasa-tread") == library.shipped() / "materials/nasa-tread.toml"
    assert library.find("material", "nasa-tread") != card(here, "nasa-tread")
    assert library.find("material", "nasa-tread").resolve() == here / "materials/nasa-tread.toml"


def test_path_is_taken_from_the_study_then_from_here(tmp_path: Path, here: Path) -> None:
    near = tmp_path / "study"
    ours = card(here)
    assert library.find("material", "materials/mine.toml", near).resolve() == ours
    beside = card(near)
    assert library.find("material", "materials/mine.toml", near) == beside
    assert library.find("material", str(ours), near) == ours


def test_a_study_is_a_folder_or_its_file(here: Path) -> None:
    (here / "mine").mkdir()
    (here / "mine/study.toml").write_text("", encoding="utf-8")
    for written in ("mine", "./mine", "mine/", "mine/study.toml"):
        assert library.find("study", written).resolve() == here / "mine/study.toml"


@pytest.mark.parametrize("name", ["x", "x/y", "x.toml", "~nobody-by-that-name/x", "a\0b/c", "y" * 5000 + "/x", "."])
def test_what_is_not_there_is_refused(name: str) -> None:
    for kind in library.FOLDERS:
        with pytest.raises(InputError, match=f"no {kind} "):
            library.find(kind, name)


def test_nearest_name_is_offered() -> None:
    with pytest.raises(InputError, match="did you mean 'nasa-tread'"):
        library.find("material", "nasa-thread")


def test_a_card_laid_over_another() -> None:
    plain, path, name = library.load("material", "nasa-tread")
    over, same, _ = library.load("material", {"base": "nasa-tread", "density": {"value": "1.1 g/cm**3"}})
    assert (path, name) == (same, "nasa-tread")
    assert over["density"] == plain["density"] | {"value": "1.1 g/cm**3"}
    assert {**over, "density": plain["density"]} == plain


@pytest.mark.parametrize("reference", [3, True, None, [], "", {}, {"base": 3}, {"base": ["nasa-tread"]}])
def test_what_is_no_reference(reference: object) -> None:
    with pytest.raises(InputError):
        library.load("material", reference)
