"""What every test may ask for: system libraries that a bare machine does not have."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from long_files import LONG

# The objects of a collection last: to look for garbage among half a million of them takes a quarter of its time.
gc.disable()
# Child processes that may not keep bytecode would compile the package each time: a quarter of a short command.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
# Side by side, one thread of linear algebra each: more would only wait for each other.
if "PYTEST_XDIST_WORKER" in os.environ:
    for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(_name, "1")
    # Likewise one process where a command takes one per core: its workers would import everything anew. Tests of
    # workers say how many.
    os.cpu_count = lambda: 1

# The same examples at every run; HYPOTHESIS_PROFILE=explore looks at new ones.
settings.register_profile("reproducible", derandomize=True, deadline=None)
settings.register_profile("explore", deadline=None, max_examples=1000)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "reproducible"))


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Long files first."""
    first = {str(Path(__file__).parent / name): place for place, name in enumerate(LONG)}
    items.sort(key=lambda item: first.get(str(item.path), len(first)))


def pytest_collection_finish() -> None:
    """What has been collected stays; the tests leave garbage again."""
    gc.freeze()
    gc.enable()


#: Of a `repr`: lines and letters at most.
LINES, LETTERS = 20, 2500

_RENDER = (
    "import pyvista; plotter = pyvista.Plotter(off_screen=True, window_size=(64, 64)); "
    "plotter.add_mesh(pyvista.Sphere()); assert plotter.screenshot(return_img=True).any()"
)


def _needs(what: str, code: str) -> None:
    """Run code in a child process (a library that cannot draw ends its own); skip, or fail where it must work."""
    tried = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False)
    if tried.returncode == 0:
        return
    lines = tried.stderr.strip().splitlines()
    reason = f"{what} does not work here: {lines[-1] if lines else f'ended with {tried.returncode}'}"
    if os.environ.get("TYREFEM_REQUIRE_LIBRARIES"):
        pytest.fail(reason)
    pytest.skip(reason)


@pytest.fixture(scope="session")
def needs_gmsh() -> None:
    """The unstructured mesher can be loaded; else skip, or fail where TYREFEM_REQUIRE_LIBRARIES is set."""
    _needs("gmsh", "import gmsh, pygmsh")


@pytest.fixture(scope="session")
def needs_rendering() -> None:
    """pyvista can draw off screen; else skip, or fail where TYREFEM_REQUIRE_LIBRARIES is set."""
    _needs("off-screen rendering", _RENDER)


@pytest.fixture(scope="session")
def needs_compiler() -> None:
    """There is a C compiler; else skip, or fail where TYREFEM_REQUIRE_LIBRARIES is set."""
    _needs("a C compiler", "import shutil; assert shutil.which('cc'), 'cc is not installed'")


@pytest.fixture(scope="session")
def needs_chromium() -> None:
    """A browser prints pages; else skip, or fail where TYREFEM_REQUIRE_LIBRARIES is set."""
    _needs("chromium", "import shutil; assert shutil.which('chromium'), 'chromium is not installed'")


@pytest.fixture(scope="session")
def speaks_briefly() -> Callable[[object], set[type]]:
    """A check that the `repr` of an object and of all that its public attributes lead to is short; gives the types."""

    def check(thing: object) -> set[type]:
        types = set()
        for path, reached in _reached(thing, type(thing).__name__, 2, set()):
            text = repr(reached)
            assert text.count("\n") < LINES, f"{path}: {text.count(chr(10)) + 1} lines"
            assert len(text) <= LETTERS, f"{path}: {len(text)} letters"
            types.add(type(reached))
        return types

    return check


def _reached(thing: Any, path: str, depth: int, seen: set[type]) -> Iterator[tuple[str, Any]]:
    """An object and what its public attributes hold that is the package's own; every type once below the first."""
    yield path, thing
    seen.add(type(thing))
    names = [*dir(type(thing)), *getattr(thing, "__dict__", {})]
    for name in dict.fromkeys(name for name in names if depth and not name.startswith(("_", "model_"))):
        try:
            value = getattr(thing, name)
        except ValueError:  # what this object cannot say, as a table of no variants
            continue
        for place, part in _parts(value):
            if type(part) not in seen:
                yield from _reached(part, f"{path}.{name}{place}", depth - 1, seen)


def _parts(value: Any) -> Iterator[tuple[str, Any]]:
    """The package's own objects in a value: itself, or the first of a mapping or a list."""
    if type(value).__module__.startswith("tyrefem"):
        yield "", value
    elif isinstance(value, Mapping | list | tuple):
        entries = value.items() if isinstance(value, Mapping) else enumerate(value)
        for key, entry in list(entries)[:3]:
            yield from ((f"[{key!r}]{place}", part) for place, part in _parts(entry))
