"""A user's own folders of cards, and the paths by which a study can be named."""

from __future__ import annotations

import json
import shlex
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from terminal import BARE, NASA, SHORT

import tyrefem as tf
from tyrefem import library
from tyrefem.cli import main

pytestmark = pytest.mark.fast


@pytest.fixture
def user_library(here: Path) -> Path:
    """A study of the user's own beside a tread compound of the user's own, of twice the conductivity."""
    shutil.copytree(library.shipped() / "studies" / NASA, here / "mystudy")
    text = (here / "mystudy/study.toml").read_text(encoding="utf-8")
    (here / "mystudy/study.toml").write_text(text.replace('"nasa-tread"', '"my-tread"'), encoding="utf-8")
    (here / "materials").mkdir()
    card = (library.shipped() / "materials/nasa-tread.toml").read_text(encoding="utf-8")
    (here / "materials/my-tread.toml").write_text(card.replace('"5e-4 cal/cm/s/K"', '"1e-3 cal/cm/s/K"'))
    return here


@pytest.mark.parametrize("written", ["./mystudy", "mystudy/study.toml", "mystudy", "./mystudy/study.toml"])
def test_paths_of_a_study(user_library: Path, written: str) -> None:
    assert main(["run", written, *SHORT, *BARE, "--out", "out"]) == 0
    summary = json.loads((user_library / "out/summary.json").read_text(encoding="utf-8"))
    assert summary["study"] == "mystudy"
    assert tf.study(written).materials["tread"].conductivity.value == pytest.approx(2 * 0.20934, rel=1e-3)


def test_absolute_path_from_elsewhere(user_library: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir("/")
    assert main(["check", str(user_library / "mystudy")]) == 0


def test_folder_named_by_the_environment(
    user_library: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str], refused: Callable[..., str],
) -> None:  # fmt: skip
    elsewhere = tmp_path_factory.mktemp("elsewhere")
    shutil.move(user_library / "materials", elsewhere / "materials")
    assert "materials.tread: no material named 'my-tread'" in refused("run", "./mystudy")
    monkeypatch.setenv("TYREFEM_PATH", f"{tmp_path_factory.mktemp('empty')}:{elsewhere}")
    assert main(["check", "mystudy"]) == 0
    assert main(["list", "materials"]) == 0
    assert "my-tread" in capfd.readouterr().out


def test_new_cards_are_found_by_name(user_library: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "section", "mine"]) == 0
    assert main(["new", "study", "wet-road", "--from", "example-validation"]) == 0
    # A study brings the tables that it names.
    assert {file.name for file in (user_library / "studies/wet-road").iterdir()} == {
        "study.toml", "run-1.csv", "run-2.csv", "run-3.csv",
    }  # fmt: skip
    capfd.readouterr()
    assert main(["list", "studies"]) == 0
    assert "wet-road" in capfd.readouterr().out
    assert main(["check", "studies/wet-road"]) == 0
    assert tf.study("wet-road").replace({"section": "mine"}).section.name == "mine"
    # A shipped study may use a card of the current folder too.
    assert main(["run", NASA, *SHORT, *BARE, "--set", "section=mine"]) == 0


def test_new_never_overwrites(
    user_library: Path, refused: Callable[..., str], capfd: pytest.CaptureFixture[str]
) -> None:
    for kind, file in (
        ("study", "studies/a/study.toml"),
        ("section", "geometry/a.toml"),
        ("material", "materials/a.toml"),
    ):
        assert main(["new", kind, "a"]) == 0
        (user_library / file).write_text("mine", encoding="utf-8")
        capfd.readouterr()
        assert "exists already; nothing was written" in refused("new", kind, "a")
        assert (user_library / file).read_text(encoding="utf-8") == "mine"


@pytest.mark.parametrize("name", ["../a", "a/b", "", ".hidden", "-x", "a b", "a.toml", "a\n"])
def test_new_refuses_what_is_no_name(refused: Callable[..., str], name: str) -> None:
    assert "is not allowed as a card's name" in refused("new", "study", "--", name)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["section", "CON"], "name: 'CON' can be no file on Windows"),
        (["study", "x."], "name: 'x.' can be no file on Windows"),
        (["study", "x", "--from", ""], "--from: is empty"),
        (["study", "205/60R15", "--from", "passenger-205-55r16"], "--from: a size is drawn, not copied"),
        (["section", "205/60R15", "--rim", "-6 in"], "--rim: -6 in is outside what is possible here: at least 0 in"),
        (
            ["section", "205/60R15", "--rim", "6 in", "--set", "rim_width=7 in"],
            "'rim_width' is given twice beside",
        ),
        (["section", "205/60R15", "--set", "plies=1", "--set", "parameters.plies=2"], "--set: 'plies' is given twice"),
    ],
)
def test_new_refuses_options_that_contradict(refused: Callable[..., str], words: list[str], message: str) -> None:
    assert message in refused("new", *words)


def test_new_of_an_unknown_kind_or_card(refused: Callable[..., str]) -> None:
    assert "did you mean 'material'?" in refused("new", "materiall", "x")
    assert "no section named 'nasa'" in refused("new", "section", "x", "--from", "nasa")


@pytest.mark.parametrize(
    ("words", "out", "argument"),
    [
        (["205/55R16"], "cards/wide tyre.toml", "cards/wide tyre.toml"),
        (["205/55R16"], "wide/study.toml", "wide"),
        (["mine"], "other.toml", "other.toml"),
    ],
)
def test_the_next_command_that_new_prints_finds_the_card(
    words: list[str], out: str, argument: str, user_library: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert main(["new", "study", *words, "--out", out]) == 0
    last = capfd.readouterr().out.splitlines()[-1]
    assert shlex.split(last.rpartition("tyrefem ")[2])[1:] == [argument]
    assert main(["check", argument]) == 0
