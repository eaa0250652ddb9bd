"""What every test may ask for: system libraries that a bare machine does not have."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from hypothesis import settings

# The same examples at every run; HYPOTHESIS_PROFILE=explore looks at new ones.
settings.register_profile("reproducible", derandomize=True, deadline=None)
settings.register_profile("explore", deadline=None, max_examples=1000)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "reproducible"))

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
