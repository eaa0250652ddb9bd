"""One version everywhere: package, changelog, citation, tag of the commit. The citation file is valid."""

from __future__ import annotations

import re
import shutil
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest

import tyrefem

pytestmark = pytest.mark.fast

ROOT = Path(__file__).resolve().parents[2]
CITATION = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
SETTINGS: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT: dict[str, Any] = SETTINGS["project"]
#: Files of the repository that the source archive has without being named, or does without.
NOT_NAMED = {"pyproject.toml", ".gitignore"}


def of_citation(key: str) -> str:
    """The value of a key at the top of the citation file."""
    lines = re.findall(rf"^{key}: (.+)$", CITATION, re.MULTILINE)
    assert len(lines) == 1, key
    return str(lines[0]).strip('"')


def test_the_citation_is_of_this_version_and_licence() -> None:
    assert of_citation("cff-version") == "1.2.0"
    assert of_citation("version") == tyrefem.__version__
    assert of_citation("license") == PROJECT["license"]
    for key in ("message", "title"):
        assert of_citation(key)
    assert re.search(r"^authors:\n  - name: ", CITATION, re.MULTILINE)


def test_the_citation_obeys_its_schema() -> None:
    """The required keys of https://citation-file-format.github.io 1.2.0, and no key that it does not have."""
    allowed = {
        "abstract", "authors", "cff-version", "commit", "contact", "date-released", "doi", "identifiers", "keywords",
        "license", "license-url", "message", "preferred-citation", "references", "repository", "repository-artifact",
        "repository-code", "title", "type", "url", "version",
    }  # fmt: skip
    keys = set(re.findall(r"^([\w-]+):", CITATION, re.MULTILINE))
    assert {"authors", "cff-version", "message", "title"} <= keys <= allowed


def test_the_version_stands_in_one_place() -> None:
    assert PROJECT["dynamic"] == ["version"]
    assert "version" not in PROJECT
    assert re.fullmatch(r"\d+\.\d+\.\d+((a|b|rc)\d+)?(\.dev\d+)?", tyrefem.__version__)


def test_the_changelog_begins_with_this_version() -> None:
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    newest = re.search(r"^## \[(.+?)\]", text, re.MULTILINE)
    assert newest is not None
    assert newest[1] == tyrefem.__version__


def test_a_tag_of_this_commit_is_its_version() -> None:
    if shutil.which("git") is None or not (ROOT / ".git").exists():
        pytest.skip("no git repository")
    done = subprocess.run(
        ["git", "tag", "--points-at", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=False, timeout=60
    )
    releases = [tag for tag in done.stdout.split() if re.match(r"v\d", tag)]
    assert releases in ([], [f"v{tyrefem.__version__}"])


def test_every_supported_python_is_named() -> None:
    named = {line.rpartition(":: ")[2] for line in PROJECT["classifiers"] if ":: Python :: 3." in line}
    assert named == {"3.11", "3.12", "3.13"}
    assert PROJECT["requires-python"] == ">=3.11"


def test_the_source_archive_has_all_that_the_repository_has() -> None:
    if shutil.which("git") is None or not (ROOT / ".git").exists():
        pytest.skip("no git repository")
    git = ["git", "ls-tree", "--name-only", "HEAD"]
    tracked = subprocess.run(git, cwd=ROOT, capture_output=True, text=True, check=True, timeout=60).stdout.split()
    included = SETTINGS["tool"]["hatch"]["build"]["targets"]["sdist"]["include"]
    assert set(included) == set(tracked) - NOT_NAMED
