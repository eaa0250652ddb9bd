"""Objects of the package: a class name stands once, and what belongs together is one parameter."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "tyrefem"
#: Parameters of a function at most, without self; a command of the command line has one per flag.
MOST = 8
#: The room whose methods name every option that they hand on, for completion: keyword-only parameters do not count.
NAMING = "api/"
Function = ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda


def modules(package: Path) -> Iterator[tuple[str, ast.Module]]:
    """Path within the package and syntax tree of every module."""
    for file in sorted(package.rglob("*.py")):
        yield file.relative_to(package).as_posix(), ast.parse(file.read_text(encoding="utf-8"))


def repeated_classes(package: Path) -> dict[str, list[str]]:
    """Class name -> the modules that define it, of names that stand more than once."""
    places: defaultdict[str, list[str]] = defaultdict(list)
    for path, tree in modules(package):
        for node in ast.walk(tree):
            if isinstance(node, ast.ClassDef):
                places[node.name].append(path)
    return {name: paths for name, paths in places.items() if len(paths) > 1}


def count_of_parameters(function: Function, *, keywords: bool = True) -> int:
    """Parameters of any kind, ``*args`` and ``**options`` included; ``self`` and ``cls`` are not counted.

    ``keywords``: count keyword-only parameters.
    """
    given = function.args
    named = [*given.posonlyargs, *given.args]
    bound = bool(named) and named[0].arg in ("self", "cls")
    only_keywords = len(given.kwonlyargs) if keywords else 0
    return len(named) + only_keywords + (given.vararg is not None) + (given.kwarg is not None) - bound


def long_functions(package: Path) -> set[str]:
    """``module: name`` of functions outside the command line that take more than `MOST`."""
    return {
        f"{path}: {getattr(node, 'name', 'lambda')}"
        for path, tree in modules(package)
        if not path.startswith("cli/")
        for node in ast.walk(tree)
        if isinstance(node, Function) and count_of_parameters(node, keywords=not path.startswith(NAMING)) > MOST
    }


def test_each_class_name_stands_once() -> None:
    assert repeated_classes(PACKAGE) == {}


def test_no_function_takes_more_than_eight_parameters() -> None:
    assert long_functions(PACKAGE) == set()


@pytest.mark.parametrize("count", [MOST, MOST + 1])
def test_a_second_class_and_a_ninth_parameter_are_seen(tmp_path: Path, count: int) -> None:
    names = ", ".join(f"p{number}" for number in range(count - 2))
    (tmp_path / "tyre.py").write_text(f"class Tyre:\n    def press(self, {names}, *, load, **options): ...\n")
    (tmp_path / "rim.py").write_text("class Tyre: ...\nclass Rim: ...\n")
    (tmp_path / "api").mkdir()
    (tmp_path / "api" / "verbs.py").write_text(
        f"def roll({names}, last, *, load, slip): ...\ndef many({names}, a, b): ...\n"
    )
    assert repeated_classes(tmp_path) == {"Tyre": ["rim.py", "tyre.py"]}
    assert long_functions(tmp_path) == ({"tyre.py: press", "api/verbs.py: many"} if count > MOST else set())
