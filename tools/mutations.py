"""Do the tests notice a wrong formula? Breaks central formulas one by one, and runs the tests that must fail.

    python tools/mutations.py            all of them, a few minutes
    python tools/mutations.py bead road  those whose name has one of the words

``mutations.toml`` beside this file has the formulas. The package is copied to a temporary folder; nothing here is
changed. First all named tests must pass on the copy as it is; then each formula is broken alone, and one of its tests
must fail ("killed"). Exit code 1: a mutant survived, so a test of physics is missing. Exit code 2: a formula is no
longer in its file exactly once.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TABLE = ROOT / "tools" / "mutations.toml"
#: What the tests need of the repository.
COPIED = ("tyrefem", "tests", "tools", "docs", "studies", "materials", "geometry", "pyproject.toml", "README.md")
#: s, of the tests of one mutant: a broken integrator may never end.
PATIENCE = 600.0


class StaleMutationError(Exception):
    """The formula was reworded, or stands twice: `mutations.toml` must be brought up to date."""


@dataclass(frozen=True)
class Mutation:
    """A formula, what it is changed to, and the tests (paths from the root) of which one must fail then."""

    name: str
    file: str
    original: str
    mutated: str
    tests: tuple[str, ...]

    def applied(self, text: str) -> str:
        """The file's text with the wrong formula.

        Raises
        ------
        StaleMutationError : the original is not there exactly once.
        """
        count = text.count(self.original)
        if count != 1:
            raise StaleMutationError(f"{self.name}: {self.file} has {self.original!r} {count} times, not once")
        return text.replace(self.original, self.mutated)


def read_mutations(table: Path = TABLE) -> list[Mutation]:
    """All mutations of a table."""
    rows = tomllib.loads(table.read_text(encoding="utf-8"))["mutation"]
    return [Mutation(**{**row, "tests": tuple(row["tests"])}) for row in rows]


def copy_of(root: Path, folder: Path) -> Path:
    """The package and its tests in a folder of their own."""
    ignored = shutil.ignore_patterns("__pycache__", "*.pyc")
    for name in COPIED:
        if (root / name).is_dir():
            shutil.copytree(root / name, folder / name, ignore=ignored)
        else:
            shutil.copy(root / name, folder / name)
    return folder


def failing_test(folder: Path, tests: tuple[str, ...]) -> str | None:
    """The first test that fails in a copy, by its name; None: all pass."""
    # The folder's package, whatever is installed.
    environment = {**os.environ, "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "--tb=no", *tests]
    try:
        done = subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, check=False, timeout=PATIENCE
        )
    except subprocess.TimeoutExpired:
        return f"(no end after {PATIENCE:g} s)"
    if done.returncode == 0:
        return None
    failures = [line.split(" ", 1)[1] for line in done.stdout.splitlines() if line.startswith(("FAILED ", "ERROR "))]
    if not failures:
        raise RuntimeError(f"pytest ended with {done.returncode}:\n{done.stdout}\n{done.stderr}")
    return failures[0].split(" - ")[0].split("/", 2)[-1]


def check(mutations: list[Mutation], folder: Path) -> dict[str, str | None]:
    """Name of the mutation -> the test that noticed it; None: it survived."""
    noticed: dict[str, str | None] = {}
    for mutation in mutations:
        file = folder / mutation.file
        text = file.read_text(encoding="utf-8")
        file.write_text(mutation.applied(text), encoding="utf-8")
        try:
            noticed[mutation.name] = failing_test(folder, mutation.tests)
        finally:
            file.write_text(text, encoding="utf-8")
        test = noticed[mutation.name]
        print(f"{'survived' if test is None else 'killed  '}  {mutation.name}  {test or ''}", flush=True)
    return noticed


def main(arguments: list[str] | None = None) -> int:
    """Run the check; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("words", nargs="*", help="words of the names of the mutations to try (default: all)")
    words = parser.parse_args(arguments).words
    mutations = [one for one in read_mutations() if not words or any(word in one.name for word in words)]
    if not mutations:
        parser.error(f"no mutation has one of the words {', '.join(words)}")
    try:
        for mutation in mutations:
            mutation.applied((ROOT / mutation.file).read_text(encoding="utf-8"))
    except StaleMutationError as error:
        print(error, file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as temporary:
        folder = copy_of(ROOT, Path(temporary))
        unbroken = failing_test(folder, tuple(dict.fromkeys(test for one in mutations for test in one.tests)))
        if unbroken is not None:
            print(f"fails before anything is broken: {unbroken}", file=sys.stderr)
            return 2
        noticed = check(mutations, folder)
    survivors = sum(test is None for test in noticed.values())
    print(f"{len(noticed) - survivors} of {len(noticed)} noticed")
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
