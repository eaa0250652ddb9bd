"""Names in the package are the field's words: a name says what a thing holds, in one vocabulary."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "tyrefem"
#: Words that say nothing of what a thing holds, or that are metaphors.
REFUSED = {"one", "found", "said", "asked", "own", "told", "bench", "lab", "lean", "strangers", "truth", "rivals"}


def names(tree: ast.AST) -> Iterator[str]:
    """Names that a module gives: functions, classes, parameters, variables, attributes, names of imports."""
    for node in ast.walk(tree):
        match node:
            case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name) | ast.ClassDef(name=name):
                yield name
            case ast.arg(arg=name):
                yield name
            case ast.Name(id=name, ctx=ast.Store()) | ast.Attribute(attr=name, ctx=ast.Store()):
                yield name
            case ast.alias(asname=str(name)) | ast.ExceptHandler(name=str(name)):
                yield name
            case ast.MatchAs(name=str(name)) | ast.MatchStar(name=str(name)):
                yield name


def refused(text: str) -> set[str]:
    """Refused words among the names that a module gives; underscores in front do not count."""
    return {name for name in names(ast.parse(text)) if name.strip("_").lower() in REFUSED}


def test_names_say_what_things_hold() -> None:
    bad = {
        path.relative_to(PACKAGE).as_posix(): refused(path.read_text(encoding="utf-8"))
        for path in PACKAGE.rglob("*.py")
    }
    assert len(bad) > 200
    assert {path: words for path, words in bad.items() if words} == {}


def test_modules_have_such_names_too() -> None:
    assert not [path for path in PACKAGE.rglob("*.py") if path.stem.strip("_") in REFUSED]


@pytest.mark.parametrize(
    "text",
    ["def asked(): ...", "class Lab: ...", "def f(one): ...", "found = 1", "self.own = 1", "import json as bench",
     "for told in (1, 2): ...", "lambda rivals: 0", "x = [_own for _own in ()]"],
)  # fmt: skip
def test_a_refused_name_is_seen(text: str) -> None:
    assert len(refused(text)) == 1


def test_a_use_of_a_foreign_name_is_not_counted() -> None:
    assert refused("import design\ndesign.asked(1)\none_sided = design.found") == set()
