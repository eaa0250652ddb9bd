"""No module reaches up by a module's name as text: `import_module("tyrefem.api")` is an import, too."""

from __future__ import annotations

import ast
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

pytestmark = pytest.mark.fast

ROOT = Path(__file__).resolve().parents[2]
CONTRACTS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"]
LAYERS: list[str] = next(contract["layers"] for contract in CONTRACTS if contract["type"] == "layers")
#: Room -> its floor, counted from the top.
FLOOR = {room: number for number, layer in enumerate(LAYERS) for room in layer.split(" | ")}


def named_rooms(text: str) -> Iterator[str]:
    """Rooms that the strings of a module name as ``tyrefem.ROOM...``, ``any`` for ``f"tyrefem.{name}"``.

    Docstrings may name anything.
    """
    tree = ast.parse(text)
    bare = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in bare:
            package, _, rest = node.value.partition(".")
            room = rest.partition(".")[0]
            if package == "tyrefem" and (room in FLOOR or node.value == "tyrefem."):
                yield room or "any"


def upward(room: str, text: str) -> list[str]:
    """Rooms above ``room``, or beside it, that a module of it names."""
    return [named for named in named_rooms(text) if named != room and FLOOR.get(named, -1) <= FLOOR[room]]


@pytest.mark.parametrize("room", FLOOR)
def test_no_module_names_an_upper_room_as_text(room: str) -> None:
    files = [ROOT / "tyrefem" / f"{room}.py", *(ROOT / "tyrefem" / room).rglob("*.py")]
    texts = {file: file.read_text(encoding="utf-8") for file in files if file.is_file()}
    assert texts
    wrong = {file.relative_to(ROOT).as_posix(): upward(room, text) for file, text in texts.items()}
    assert not any(wrong.values()), {file: rooms for file, rooms in wrong.items() if rooms}


@pytest.mark.parametrize(
    ("text", "rooms"),
    [
        ('_WHERE = {"identify": "tyrefem.api"}', ["api"]),
        ('import importlib\nimportlib.import_module("tyrefem.reports.rig")', ["reports"]),
        ('def up(name):\n    return f"tyrefem.diagnose.{name}"', ["diagnose"]),
        ('def up(name):\n    return f"tyrefem.{name}"', ["any"]),
        ('"""Equations as in tyrefem.api."""\nLOW = "tyrefem.errors"', []),
    ],
    ids=["in a table", "in a call", "in parts", "room unknown", "downwards"],
)
def test_a_name_of_an_upper_room_is_seen(text: str, rooms: list[str]) -> None:
    assert upward("heating_test", text) == rooms
