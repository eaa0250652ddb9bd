"""Tests that are parametrised with the unstructured mesher ask for its libraries."""

from __future__ import annotations

import pytest


@pytest.fixture(autouse=True)
def gmsh_where_named(request: pytest.FixtureRequest) -> None:
    """Skip (or fail, see tests/conftest.py) a case whose parameters name gmsh on a machine that cannot load it."""
    callspec = getattr(request.node, "callspec", None)
    if callspec is not None and "gmsh" in map(str, callspec.params.values()):
        request.getfixturevalue("needs_gmsh")
