"""What is installed along with tyrefem: named in the documentation, and free of the GPL."""

from __future__ import annotations

import importlib.metadata as metadata
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
from packaging.requirements import Requirement

pytestmark = pytest.mark.fast

CHECKOUT = Path(__file__).resolve().parents[2]
PROJECT: dict[str, Any] = tomllib.loads((CHECKOUT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS: dict[str, list[str]] = PROJECT["optional-dependencies"]


def named(requirements: list[str]) -> set[str]:
    return {Requirement(text).name.lower() for text in requirements}


def with_all_below(names: set[str]) -> set[str]:
    """The packages and everything they require here."""
    closure, waiting = set(), set(names)
    while waiting:
        name = waiting.pop()
        closure.add(name)
        for text in metadata.requires(name) or []:
            needed = Requirement(text)
            if needed.marker is None or needed.marker.evaluate({"extra": ""}):
                waiting |= {needed.name.lower().replace("_", "-")} - closure
    return closure


def licence(name: str) -> str:
    """All that a package says of its licence, without the licence's own text."""
    meta = metadata.metadata(name)
    classifiers = [line for line in meta.get_all("Classifier") or [] if line.startswith("License")]
    lines = (meta.get("License") or "").strip().splitlines()
    return " ".join([meta.get("License-Expression") or "", *lines[:1], *classifiers])


def test_default_installation_is_free_of_the_gpl() -> None:
    packages = with_all_below(named(PROJECT["dependencies"]))
    assert {"numpy", "vtk", "pydantic-core"} <= packages
    assert {name: licence(name) for name in packages if re.search(r"GPL|General Public", licence(name))} == {}
    # The same words do find it where it is.
    assert re.search(r"GPL", licence("gmsh"))
    assert re.search(r"GPL", licence("pygmsh"))


def test_documentation_names_every_dependency() -> None:
    text = (CHECKOUT / "docs/dependencies.md").read_text(encoding="utf-8")
    default, _, rest = text.partition("## Extras")
    extras, _, _ = rest.partition("## What comes with them")
    written = dict.fromkeys(re.findall(r"^\| ([a-z][\w-]*) \|", default, re.MULTILINE), "-")
    for name, extra in re.findall(r"^\| ([a-z][\w-]*) \|.*\| ([\w, ]+) \|$", extras, re.MULTILINE):
        written[name] = f"{written[name]}, {extra}" if name in written else extra
    wanted = dict.fromkeys(named(PROJECT["dependencies"]), "-")
    for extra in EXTRAS:
        for name in named(EXTRAS[extra]):
            wanted[name] = f"{wanted[name]}, {extra}" if name in wanted else extra
    assert written == wanted
