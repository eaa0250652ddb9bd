"""No test runs with other tuning constants than the ones that ship: what a test varies is a parameter."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

pytestmark = pytest.mark.fast

TESTS = Path(__file__).resolve().parents[1]


def is_constant(name: object) -> bool:
    """Is it spelt like a module's constant, ``LARGEST_BYTES``?"""
    return isinstance(name, str) and name.rsplit(".", 1)[-1].strip("_").isupper() and name.isascii()


def imported(tree: ast.AST) -> set[str]:
    """Names under which a file knows modules and objects of the package."""
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "tyrefem":
            names |= {alias.asname or alias.name for alias in node.names}
        if isinstance(node, ast.Import):
            names |= {(alias.asname or alias.name).split(".")[0] for alias in node.names if "tyrefem" in alias.name}
    return names


def root(node: ast.expr) -> str | None:
    """The name at which a chain of attributes begins."""
    while isinstance(node, ast.Attribute):
        node = node.value
    return node.id if isinstance(node, ast.Name) else None


def patched(source: str) -> list[str]:
    """``line: name`` of every constant of the package that a file sets."""
    tree = ast.parse(source)
    ours = imported(tree)
    return [f"{line}: {name}" for line, name in sorted({*_assigned(tree, ours), *_by_setattr(tree, ours)})]


def _assigned(tree: ast.AST, ours: set[str]) -> Iterator[tuple[int, str]]:
    for node in ast.walk(tree):
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        for target in targets:
            place = target.value if isinstance(target, ast.Subscript) else target
            if isinstance(place, ast.Attribute) and is_constant(place.attr) and root(place) in ours:
                yield place.lineno, place.attr


def _by_setattr(tree: ast.AST, ours: set[str]) -> Iterator[tuple[int, str]]:
    for function in ast.walk(tree):
        if not isinstance(function, ast.FunctionDef | ast.Module):
            continue
        for call in ast.walk(function):
            if not isinstance(call, ast.Call) or not call.args:
                continue
            called = call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")
            if called not in ("setattr", "setitem", "object", "patch"):
                continue
            words = [arg.value for arg in call.args[:2] if isinstance(arg, ast.Constant) and isinstance(arg.value, str)]
            about = root(call.args[0]) in ours or any(word.startswith("tyrefem.") for word in words)
            if called == "setitem" and isinstance(call.args[0], ast.Attribute):
                words = [call.args[0].attr]
            if not words and isinstance(function, ast.FunctionDef):
                # The name is a variable: any constant's name that the function holds may be it.
                words = [node.value for node in ast.walk(function) if isinstance(node, ast.Constant)]
            yield from ((call.lineno, word) for word in words if about and is_constant(word))


@pytest.mark.parametrize(
    "line",
    [
        'monkeypatch.setattr(lines, "LARGEST_BYTES", 10)',
        'monkeypatch.setattr("tyrefem.measured.lines.LARGEST_BYTES", 10)',
        "lines.LARGEST_BYTES = 10",
        'monkeypatch.setitem(lines.DELIMITERS, "tab", 1)',
        'lines.DELIMITERS["tab"] = 1',
        '[setattr(lines, name, value) for name, value in {"LARGEST_BYTES": 10}.items()]',
    ],
)
def test_every_way_of_patching_is_seen(line: str) -> None:
    assert patched(f"from tyrefem.measured import lines\ndef test(monkeypatch):\n    {line}\n")


@pytest.mark.parametrize(
    "line",
    ['monkeypatch.setattr(lines, "decode", fail)', "size = lines.LARGEST_BYTES", 'monkeypatch.setenv("HOME", "x")'],
)
def test_outside_failures_may_be_simulated(line: str) -> None:
    assert not patched(f"from tyrefem.measured import lines\ndef test(monkeypatch):\n    {line}\n")


def test_no_test_sets_a_constant_of_the_package() -> None:
    files = sorted(TESTS.rglob("*.py"))
    assert len(files) > 100
    patches = {str(file.relative_to(TESTS)): patched(file.read_text(encoding="utf-8")) for file in files}
    assert {name: places for name, places in patches.items() if places} == {}
