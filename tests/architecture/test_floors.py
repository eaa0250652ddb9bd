"""A package imports only from the layers below its own, in functions and for typing too."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

pytestmark = pytest.mark.fast

ROOT = Path(__file__).resolve().parents[2]
CONTRACTS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"]
LAYERS: list[str] = next(contract["layers"] for contract in CONTRACTS if contract["type"] == "layers")
ROOMS = [room for layer in LAYERS for room in layer.split(" | ")]
#: At most so many modules stand beside the rooms.
MOST_AT_THE_ROOT = 10


def lint(folder: Path) -> subprocess.CompletedProcess[str]:
    """import-linter on the package in a folder, with this project's contracts."""
    code = "import sys; sys.path.insert(0, '.'); from importlinter.cli import lint_imports_command as c; c()"
    return subprocess.run(
        [sys.executable, "-c", code, "--config", str(ROOT / "pyproject.toml"), "--no-cache"],
        cwd=folder, capture_output=True, text=True, check=False, timeout=120,
    )  # fmt: skip


def test_every_room_knows_only_the_rooms_below_it() -> None:
    done = lint(ROOT)
    assert done.returncode == 0, done.stdout
    assert f"{len(CONTRACTS)} kept, 0 broken" in done.stdout


@pytest.mark.parametrize(
    ("room", "line"),
    [
        ("conduction/field.py", "from tyrefem.inputs import study"),
        ("measured/run.py", "def up():\n    from tyrefem.compare import comparison"),
        ("inputs/drive.py", "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from tyrefem import simulation"),
    ],
    ids=["at the top", "in a function", "for typing"],
)
def test_an_import_turned_round_is_seen(tmp_path: Path, room: str, line: str) -> None:
    shutil.copytree(ROOT / "tyrefem", tmp_path / "tyrefem", ignore=shutil.ignore_patterns("__pycache__"))
    file = tmp_path / "tyrefem" / room
    file.write_text(f"{file.read_text(encoding='utf-8')}\n{line}\n", encoding="utf-8")
    done = lint(tmp_path)
    assert done.returncode != 0
    assert "BROKEN" in done.stdout


def test_the_root_is_small() -> None:
    assert len(list((ROOT / "tyrefem").glob("*.py"))) <= MOST_AT_THE_ROOT


def test_every_room_says_what_it_is_for() -> None:
    for room in ROOMS:
        file = ROOT / "tyrefem" / room / "__init__.py"
        if file.is_file():
            docstring = re.search(r'^"""(.*?)"""', file.read_text(encoding="utf-8"), re.S)
            assert docstring is not None, room
            assert len(docstring[1].strip().splitlines()) >= 2, f"{room} does not say what it may not know"


def test_the_page_draws_the_floors_as_they_are() -> None:
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    floors = page.partition("## The layers")[2].partition("\n## ")[0]
    drawn = re.findall(r"^\| \d+ \| (.+?) \|", floors, re.M)
    named = [re.findall(r"`([\w]+)`", cell) for cell in drawn]
    assert named == [layer.split(" | ") for layer in LAYERS]


def test_the_page_names_the_rooms_of_the_diagnosis_in_their_order() -> None:
    layers = next(contract["layers"] for contract in CONTRACTS if contract.get("containers") == ["tyrefem.diagnose"])
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    rooms = page.partition("## The packages of the diagnosis")[2].partition("\n## ")[0]
    assert re.findall(r"`([\w]+)`", "".join(re.findall(r"^\| (`.+?) \|", rooms, re.M))) == layers
