"""Caches are explicit, bounded and keyed by value; nobody writes into an object that is another's."""

from __future__ import annotations

import ast
import functools
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2] / "tyrefem"
#: Methods in which an object may set its own fields past `frozen`.
OWN = {"__init__", "__post_init__", "__setstate__"}
#: Methods of a dictionary that change it.
CHANGES = {"update", "setdefault", "pop", "clear", "popitem", "__setitem__", "__delitem__"}
#: What makes an empty container that a module could use as a cache.
CONTAINERS = {"dict", "list", "set", "OrderedDict", "defaultdict", "WeakKeyDictionary", "WeakValueDictionary", "local"}
#: Rooms that are still to be done.
OPEN: tuple[str, ...] = ()
#: File -> why a rule does not hold there.
ALLOWED = {
    "conduction/direct_sensitivity.py: id(": "compares loads within one call, while all of them live",
    "reduced/balance.py: id(": "functions of a batch's films at one time, within one call, while all of them live",
    "reduced/sampled_source.py: id(": "tables laws within one constructor, while all of them live",
    "reports/materials.py: id(": "names the entries of cards within one call, while all of them live",
    "mechanics/stored_cycles.py: id(": "names the cycles of a schedule within one call, while all of them live",
    "output/__init__.py: _read = {}": "the files that the command in work has read",
    "output/__init__.py: _written = {}": "the folders that the command in work has written to",
    "variants/answers.py: _FUNCTIONS = []": "the functions that answer, registered when modules are read",
    "variants/answers.py: _OF_INPUTS = {}": "those of them that need no run",
    "variants/task.py: _folders = []": "the temporary folder of this process, one",
    "diagnose/forward/evaluations.py: _MODEL = {}": "the latest forward model of a worker process, one",
    "diagnose/blind/kept_cases.py: _WORK = []": "what the cases of a worker process share, given when it starts",
    "processes.py: _STARTED = set()": "the workers that this process has started, until they have ended",
    "compare/packed_drive.py: _TYRES = {}": "the drives of a comparison, taken out when it ends",
    "cards/__init__.py: cache(_plausible)": "one value for every class of card",
    "cards/__init__.py: cache(_allowed)": "one value for every class of card",
    "cards/__init__.py: cache(_plain_numbers)": "one value for every class of card",
    "cards/__init__.py: cache(_units)": "one value for every class of card",
    "effects/effect.py: cache(parameters)": "one value for every class of effect",
    "effects/effect.py: cache(overrides)": "one value for every class of effect and port",
}


def faults(file: str, source: str) -> Iterator[str]:
    """What breaks a rule in a module, in the words of `ALLOWED`."""
    tree = ast.parse(source)
    for node in tree.body:
        yield from _container(node)
    yield from (fault for part in ast.walk(tree) for fault in _fault(part))
    yield from _own_writes(tree, None)


def _container(node: ast.stmt) -> Iterator[str]:
    """A module's own dictionary or list that is empty when the module is read."""
    if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
        return
    target = node.targets[0] if isinstance(node, ast.Assign) else node.target
    value = node.value
    empty = isinstance(value, ast.Dict | ast.List) and not (value.keys if isinstance(value, ast.Dict) else value.elts)
    made = isinstance(value, ast.Call) and not value.args and _name(value.func) in CONTAINERS
    if empty or made:
        yield f"{ast.unparse(target)} = {ast.unparse(value).split('.')[-1]}"


def _fault(node: ast.AST) -> Iterator[str]:
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "id":
        yield "id("
    if isinstance(node, ast.Attribute) and node.attr == "__dict__" and _name(node.value) not in ("self", "cls"):
        yield ast.unparse(node)
    if isinstance(node, ast.FunctionDef) and [arg.arg for arg in node.args.args if arg.arg != "self"]:
        for mark in node.decorator_list:
            unbounded = isinstance(mark, ast.Call) and any(ast.unparse(word.value) == "None" for word in mark.keywords)
            if _name(mark) == "cache" or (isinstance(mark, ast.Call) and _name(mark.func) == "lru_cache" and unbounded):
                yield f"cache({node.name})"


def _own_writes(node: ast.AST, function: str | None) -> Iterator[str]:
    """`object.__setattr__` and writes into `self.__dict__` outside of what builds the object."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        function = node.name
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        if node.func.attr == "__setattr__" and (function not in OWN or _name(node.args[0]) != "self"):
            yield f"{ast.unparse(node.func)}({ast.unparse(node.args[0])}"
        if _is_dict(node.func.value) and node.func.attr in CHANGES and function not in OWN:
            yield ast.unparse(node.func)
    stored = isinstance(node, ast.Subscript) and isinstance(node.ctx, ast.Store | ast.Del)
    if stored and _is_dict(node.value) and function not in OWN:  # type: ignore[attr-defined]
        yield ast.unparse(node)
    for child in ast.iter_child_nodes(node):
        yield from _own_writes(child, function)


def _is_dict(node: ast.AST) -> bool:
    called = isinstance(node, ast.Call) and _name(node.func) == "vars"
    return called or (isinstance(node, ast.Attribute) and node.attr == "__dict__")


def _name(node: ast.AST) -> str:
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


@functools.cache
def all_faults() -> set[str]:
    files = {str(path.relative_to(ROOT)): path for path in sorted(ROOT.rglob("*.py"))}
    return {
        f"{file}: {fault}"
        for file, path in files.items()
        if not file.startswith(OPEN)
        for fault in faults(file, path.read_text(encoding="utf-8"))
    }


def test_no_hidden_cache_and_no_write_into_another_object() -> None:
    assert all_faults() - set(ALLOWED) == set()


def test_every_exception_is_still_needed() -> None:
    assert set(ALLOWED) - all_faults() == set()


@pytest.mark.parametrize(
    ("source", "fault"),
    [
        ("def f(section):\n    section.__dict__.setdefault('_walls', {})", "section.__dict__"),
        ("def f(study):\n    study.section.__dict__['x'] = 1", "study.section.__dict__"),
        ("def f(study):\n    vars(study)['x'] = 1", "vars(study)['x']"),
        ("def f(self):\n    self.__dict__['x'] = 1", "self.__dict__['x']"),
        ("def f(self):\n    return self.__dict__.pop('x')", "self.__dict__.pop"),
        ("def f(tyre):\n    object.__setattr__(tyre, 'like', None)", "object.__setattr__(tyre"),
        ("def f(self):\n    object.__setattr__(self, 'like', None)", "object.__setattr__(self"),
        ("def f(known, x):\n    return known[id(x)]", "id("),
        ("import functools\n@functools.cache\ndef f(x):\n    return x", "cache(f)"),
        ("import functools\n@functools.lru_cache(maxsize=None)\ndef f(x):\n    return x", "cache(f)"),
        ("_SEEN: dict[str, int] = {}", "_SEEN = {}"),
        ("from weakref import WeakKeyDictionary\n_SEEN = WeakKeyDictionary()", "_SEEN = WeakKeyDictionary()"),
    ],
)
def test_a_hidden_cache_is_seen(source: str, fault: str) -> None:
    assert fault in set(faults("module.py", source))


@pytest.mark.parametrize(
    "source",
    [
        "class A:\n    def __setstate__(self, state):\n        self.__dict__.update(state)",
        "class A:\n    def __post_init__(self):\n        object.__setattr__(self, 'x', 1)",
        "class A:\n    def __getstate__(self):\n        return dict(self.__dict__)",
        "import functools\n@functools.cache\ndef f():\n    return 1",
        "import functools\n@functools.lru_cache(maxsize=8)\ndef f(x):\n    return x",
        "NAMES = {'a': 1}",
    ],
)
def test_what_an_object_does_with_itself_is_allowed(source: str) -> None:
    assert set(faults("module.py", source)) == set()
