"""Effects lie below studies and the rolling tyre: nothing that they import, however far down, imports effects."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import tyrefem

pytestmark = pytest.mark.fast

ROOT = Path(tyrefem.__file__).parent
MODULES = {
    ".".join(("tyrefem", *path.relative_to(ROOT).with_suffix("").parts)).removesuffix(".__init__"): path
    for path in ROOT.rglob("*.py")
}


def imports(module: str) -> set[str]:
    """Modules of tyrefem that a module imports: at the top, in functions and under TYPE_CHECKING."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(MODULES[module].read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module}: relative import"
            whole = {f"{node.module}.{alias.name}" for alias in node.names}
            names |= {name for name in whole if name in MODULES} or {str(node.module)}
    return names & MODULES.keys()


def is_effect(module: str) -> bool:
    """Is it a module of the effects' package?"""
    return module == "tyrefem.effects" or module.startswith("tyrefem.effects.")


def test_nothing_below_effects_knows_effects() -> None:
    below: set[str] = set()
    waiting = {name for module in filter(is_effect, MODULES) for name in imports(module)} - {
        *filter(is_effect, MODULES)
    }
    assert waiting
    while waiting:
        below |= waiting
        back = {f"{module} -> {name}" for module in waiting for name in imports(module) if is_effect(name)}
        assert not back
        waiting = {name for module in waiting for name in imports(module)} - below


def test_effects_name_neither_study_nor_surroundings() -> None:
    classes = {"Study", "Surroundings", "RollingTyre"}
    for module in filter(is_effect, MODULES):
        tree = ast.parse(MODULES[module].read_text(encoding="utf-8"))
        names = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        assert not names & classes, module
