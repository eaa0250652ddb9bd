"""`tyrefem schema` and the line that `tyrefem new` writes."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import pytest

import tyrefem
from tyrefem.cli import main
from tyrefem.schemas.files import study_schema
from tyrefem.schemas.line import SETTINGS

EFFECT = '''
from typing import Annotated, ClassVar
from tyrefem.effects import Effect, Prior

class Frost(Effect):
    """T_a -> T_a - colder_by."""

    name: ClassVar[str] = "frost"
    family: ClassVar[str] = "boundary"
    sentence: ClassVar[str] = "It freezes."
    source: ClassVar[str] = "estimate: winter"
    colder_by: Annotated[float, Prior("delta_degC", "taken from the ambient", 5.0, 0.0, 40.0)] = 0.0

    def sink_addend(self, tyre, surface, t):
        return -self.colder_by
'''


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def with_schemas(here: Path) -> Path:
    """A folder that has schemas; their content does not matter."""
    (here / "schemas").mkdir()
    for kind in ("study", "section", "material"):
        (here / "schemas" / f"{kind}.json").write_text("{}", encoding="utf-8")
    return here


def test_rules_that_a_person_added_to_the_settings_stay(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["schema"]) == 0
    edited = (here / SETTINGS).read_text(encoding="utf-8") + "\n[formatting]\nindent_tables = true\n"
    (here / SETTINGS).write_text(edited, encoding="utf-8")
    capsys.readouterr()
    assert main(["schema"]) == 0
    assert "is your own and was kept" in capsys.readouterr().out
    assert (here / SETTINGS).read_text(encoding="utf-8") == edited
    assert main(["schema", "--force"]) == 0
    assert "formatting" not in (here / SETTINGS).read_text(encoding="utf-8")
    # For another folder, unchanged settings are written again.
    assert main(["schema", "--out", "other"]) == 0
    assert 'path = "other/study.json"' in (here / SETTINGS).read_text(encoding="utf-8")


def test_it_writes_schemas_and_settings(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["schema"]) == 0
    kinds = {"study", "section", "material", "sweep", "rig", "thermal", "answers"}
    assert {file.stem for file in (here / "schemas").iterdir()} >= kinds
    assert json.loads((here / "schemas/study.json").read_text(encoding="utf-8"))["title"] == "A tyrefem study"
    assert 'path = "schemas/study.json"' in (here / SETTINGS).read_text(encoding="utf-8")
    assert "Even Better TOML" in capsys.readouterr().out
    assert main(["schema"]) == 0  # its own files may be written again
    # Nothing of the machine: a project keeps the folder.
    summary = json.loads((here / "schemas/summary.json").read_text(encoding="utf-8"))
    assert summary["versions"] == {"tyrefem": tyrefem.__version__}


def test_settings_have_a_folder_of_any_name(here: Path) -> None:
    for folder in ('my "tyres" \\ ü', "other"):
        assert main(["schema", "--out", folder]) == 0
        rules = tomllib.loads((here / SETTINGS).read_text(encoding="utf-8"))["rule"]
        assert rules[0]["schema"]["path"] == f"{folder}/study.json"


def test_settings_reach_schemas_on_another_drive(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def relpath(*_: object) -> str:
        raise ValueError("path is on mount 'D:', start on mount 'C:'")

    monkeypatch.setattr("os.path.relpath", relpath)
    assert main(["schema", "--out", "drive"]) == 0
    rules = tomllib.loads((here / SETTINGS).read_text(encoding="utf-8"))["rule"]
    assert (here / "drive" / "study.json").as_posix() in [rule["schema"]["path"] for rule in rules]


def test_settings_of_the_user_are_kept(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / SETTINGS).write_text("[formatting]\n", encoding="utf-8")
    assert main(["schema", "--out", "of/tyres"]) == 0
    assert main(["schema", "--out", "of"]) == 0
    assert (here / SETTINGS).read_text(encoding="utf-8") == "[formatting]\n"
    assert 'path = "of/study.json"' in capsys.readouterr().out


def test_a_schema_of_somebody_else_is_not_replaced(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "schemas").mkdir()
    (here / "schemas/study.json").write_text("{}", encoding="utf-8")
    assert main(["schema"]) == 2
    assert "study.json" in capsys.readouterr().err
    assert not (here / SETTINGS).exists()


@pytest.mark.parametrize(
    ("words", "file", "line"),
    [
        (["study", "mine"], "studies/mine/study.toml", "#:schema ../../schemas/study.json"),
        (["material", "mine"], "materials/mine.toml", "#:schema ../schemas/material.json"),
        (["section", "mine"], "geometry/mine.toml", "#:schema ../schemas/section.json"),
        (["section", "205/60R15"], "geometry/205-60r15.toml", "#:schema ../schemas/section.json"),
    ],
)
def test_a_new_file_names_its_schema(words: list[str], file: str, line: str, with_schemas: Path) -> None:
    assert main(["new", *words]) == 0
    lines = (with_schemas / file).read_text(encoding="utf-8").splitlines()
    assert lines[0] == line
    assert not [other for other in lines[1:] if other.startswith("#:schema")]


def test_without_schemas_a_new_file_names_none(here: Path) -> None:
    assert main(["new", "material", "mine"]) == 0
    assert "#:schema" not in (here / "materials/mine.toml").read_text(encoding="utf-8")


def test_own_effects_and_cards_are_in_the_schema(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (here / "drafts").mkdir()
    (here / "drafts/frost.py").write_text(EFFECT, encoding="utf-8")
    monkeypatch.setenv("TYREFEM_EFFECTS", str(here / "drafts"))
    assert main(["new", "material", "mine"]) == 0
    made: dict[str, Any] = study_schema()
    effect = made["definitions"]["Frost"]["properties"]
    assert effect["colder_by"]["title"] == "Colder by [K]"
    assert "frost" in made["properties"]["effects"]["items"]["properties"]["name"]["enum"]
    assert "mine" in made["properties"]["materials"]["additionalProperties"]["anyOf"][0]["enum"]
