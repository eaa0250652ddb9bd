"""What is installed from the wheel, outside the checkout, is what the checkout is."""

from __future__ import annotations

import email
import json
import os
import subprocess
import sys
import tarfile
import zipfile
from collections import defaultdict
from collections.abc import Iterable, Iterator
from importlib.metadata import Distribution, distribution
from pathlib import Path
from typing import Any

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

import tyrefem as tf
from tyrefem import library

CHECKOUT = Path(__file__).resolve().parents[2]
STUDY = "nasa-22x5.5-8pr"


def run(*command: str | Path, cwd: Path) -> subprocess.CompletedProcess[str]:
    """A process that knows nothing of the checkout."""
    hidden = ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV", library.SEARCH_PATH)
    environment = {key: value for key, value in os.environ.items() if key not in hidden}
    done = subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True, timeout=900, check=False)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-4000:]
    return done


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The source archive, and the wheel built from it."""
    folder = tmp_path_factory.mktemp("dist")
    run(sys.executable, "-m", "build", "--outdir", folder, CHECKOUT, cwd=folder)
    return {"sdist": next(folder.glob("*.tar.gz")), "wheel": next(folder.glob("*.whl"))}


def depended_on(wheel: Path) -> Iterator[Distribution]:
    """The distributions that a wheel requires without extras, and those that they require, as they are installed."""
    with zipfile.ZipFile(wheel) as archive:
        name = next(name for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
        message = email.message_from_bytes(archive.read(name))
    waiting = [Requirement(text) for text in message.get_all("Requires-Dist", [])]
    seen: set[tuple[str, str]] = set()
    while waiting:
        requirement = waiting.pop()
        for extra in ("", *requirement.extras):
            key = canonicalize_name(requirement.name), extra
            if key in seen or not (requirement.marker is None or requirement.marker.evaluate({"extra": ""})):
                continue
            seen.add(key)
            there = distribution(requirement.name)
            if not extra:
                yield there
            for further in map(Requirement, there.requires or ()):
                if further.marker is None or further.marker.evaluate({"extra": extra}):
                    further.marker = None
                    waiting.append(further)


def link(libraries: Iterable[Distribution], site: Path) -> None:
    """Link what installed distributions have; what several share is a folder of links."""
    tops = defaultdict(list)
    for there in libraries:
        for file in there.files or ():
            if ".." not in file.parts and file.parts[0] != "__pycache__":
                tops[file.parts[0]].append((there, file))
    for top, entries in tops.items():
        if len({there for there, _ in entries}) == 1:
            (site / top).symlink_to(Path(str(entries[0][0].locate_file(top))).resolve())
            continue
        for there, file in entries:
            (site / file).parent.mkdir(parents=True, exist_ok=True)
            (site / file).symlink_to(Path(str(there.locate_file(file))).resolve())


@pytest.fixture(scope="session")
def installed(built: dict[str, Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The ``bin`` folder of an empty environment with the wheel and what it depends on.

    The libraries are links to those of the tests: to unpack them again takes longer than all the tests of this file.
    """
    folder = tmp_path_factory.mktemp("environment")
    run(sys.executable, "-m", "venv", folder, cwd=folder)
    commands = folder / ("Scripts" if os.name == "nt" else "bin")
    site = run(commands / "python", "-c", "import sysconfig; print(sysconfig.get_path('purelib'))", cwd=folder).stdout
    link(depended_on(built["wheel"]), Path(site.strip()))
    install = ("install", "-q", "--no-compile", "--no-deps", "--no-index", "--disable-pip-version-check")
    run(commands / "python", "-m", "pip", *install, built["wheel"], cwd=folder)
    return commands


def wheel_names(built: dict[str, Path]) -> set[str]:
    with zipfile.ZipFile(built["wheel"]) as wheel:
        return set(wheel.namelist())


def test_wheel_holds_every_module_template_and_card(built: dict[str, Path]) -> None:
    names = wheel_names(built)
    package = {
        f"tyrefem/{file.relative_to(CHECKOUT / 'tyrefem').as_posix()}"
        for file in (CHECKOUT / "tyrefem").rglob("*")
        if file.suffix in (".py", ".html", ".j2", ".css", ".typed") and "__pycache__" not in file.parts
    }
    cards = {
        f"tyrefem/shipped/{folder}/{file.relative_to(CHECKOUT / folder).as_posix()}"
        for folder in library.FOLDERS.values()
        for file in (CHECKOUT / folder).rglob("*")
        if file.suffix in (".toml", ".csv", ".md")
    }
    assert "tyrefem/py.typed" in package
    assert {f"tyrefem/shipped/studies/{STUDY}/study.toml", "tyrefem/shipped/studies/nasa-campaign/cases.csv"} <= cards
    schemas = {f"tyrefem/shipped/schemas/{file.name}" for file in (CHECKOUT / "schemas").glob("*.json")}
    assert schemas
    assert package | cards | schemas <= names


def test_wheel_holds_nothing_else(built: dict[str, Path]) -> None:
    tops = {name.split("/")[0] for name in wheel_names(built)}
    assert tops == {"tyrefem", f"tyrefem-{tf.__version__}.dist-info"}
    with zipfile.ZipFile(built["wheel"]) as wheel:
        metadata = wheel.read(f"tyrefem-{tf.__version__}.dist-info/METADATA").decode()
    assert "License-Expression: BSD-3-Clause" in metadata
    required = [line for line in metadata.splitlines() if line.startswith("Requires-Dist:") and "extra ==" not in line]
    assert not [line for line in required if "gmsh" in line]


def test_twine_finds_nothing_wrong(built: dict[str, Path], tmp_path: Path) -> None:
    said = run(sys.executable, "-m", "twine", "check", "--strict", built["wheel"], built["sdist"], cwd=tmp_path).stdout
    assert said.count("PASSED") == 2


def test_wheel_and_archive_have_the_version_of_the_package(built: dict[str, Path]) -> None:
    assert built["wheel"].name.split("-")[1] == tf.__version__
    assert built["sdist"].name == f"tyrefem-{tf.__version__}.tar.gz"


def test_source_archive_can_be_tested(built: dict[str, Path]) -> None:
    with tarfile.open(built["sdist"]) as archive:
        names = {name.split("/", 1)[-1] for name in archive.getnames()}
    here = Path(__file__).relative_to(CHECKOUT).as_posix()
    assert {
        here,
        "pyproject.toml",
        "LICENSE",
        "README.md",
        "CHANGELOG.md",
        "CITATION.cff",
        "docs/dependencies.md",
    } <= names


def test_installed_program_gives_the_checkout_numbers(installed: Path, tmp_path: Path) -> None:
    run(installed / "tyrefem", "run", STUDY, "--no-pictures", "--set", "mesh.size=12 mm", cwd=tmp_path)
    written: dict[str, Any] = json.loads((tmp_path / "results" / STUDY / "summary.json").read_text(encoding="utf-8"))
    ours = tf.study(STUDY, {"mesh.size": "12 mm"}).run().summary()
    assert written["hottest"]["temperature_degC"] == pytest.approx(ours["hottest"]["temperature_degC"], abs=1e-6)
    assert written["hottest"]["region"] == ours["hottest"]["region"]
    assert (tmp_path / "results" / STUDY / f"vtk/{STUDY}.pvd").is_file()


def test_installed_program_lists_the_shipped_studies(installed: Path, tmp_path: Path) -> None:
    listed = run(installed / "tyrefem", "list", "studies", cwd=tmp_path).stdout
    assert {line.split()[0] for line in listed.splitlines()} == {
        path.parent.name for path in (CHECKOUT / "studies").glob("*/study.toml")
    }
    where = "import tyrefem, pathlib; print(pathlib.Path(tyrefem.__file__).parents[4])"
    assert Path(run(installed / "python", "-c", where, cwd=tmp_path).stdout.strip()) == installed.parent


def test_requirements_of_the_installed_environment_agree(installed: Path, tmp_path: Path) -> None:
    # Ends with 1, which `run` refuses, where a requirement is missing or of another version.
    run(installed / "python", "-m", "pip", "check", cwd=tmp_path)
