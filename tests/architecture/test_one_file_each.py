"""A new effect, law, question, command or card is one new file: a copy of a shipped one, renamed, works at once."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
#: New file -> the file it is a copy of, and what is renamed in it.
COPIES: dict[str, tuple[str, dict[str, str]]] = {
    "tyrefem/effects/moon.py": ("tyrefem/effects/sun.py", {'"sun"': '"moon"', "class Sun": "class Moon"}),
    "tyrefem/mechanics/laws/twin.py": (
        "tyrefem/mechanics/laws/arcs.py", {'"arcs"': '"twin"', "class TwoArcStrains": "class TwinStrains"},
    ),
    "tyrefem/boundaries/gust.py": (
        "tyrefem/boundaries/outside_air.py",
        {
            "class OutsideAirLaw(Law)": "class GustLaw(Law)", "(OutsideAirLaw)": "(GustLaw)", '"nasa"': '"gust"',
            '"constant"': '"even-gust"', '"table"]': '"gust-table"]', "class Nasa": "class Gust",
            "class ConstantAirFilm": "class EvenGust", "class AirFilmTable": "class GustTable",
        },
    ),
    "tyrefem/sweep/spread.py": (
        "tyrefem/sweep/tornado.py",
        {
            "class TornadoQuestion": "class SpreadQuestion", "class Tornado(": "class Spread(",
            "Tornado.name": "Spread.name", "Tornado(": "Spread(", "-> Tornado:": "-> Spread:",
            'name = "tornado"': 'name = "spread"\n    drawn = False',
        },
    ),
    "tyrefem/cli/twin.py": ("tyrefem/cli/isolability.py", {"app.command()": 'app.command("twin")'}),
    "materials/twin-rubber.toml": ("materials/nasa-tread.toml", {}),
    "geometry/twin-section.toml": ("geometry/nasa-22x5.5-8pr.toml", {}),
}  # fmt: skip
ASKED = """
import json, tyrefem as tf
from tyrefem import library
from tyrefem.effects import catalogue
from tyrefem.mechanics.strain_laws import strain_laws
coarse = {"mesh.size": "12 mm", "mesh.element": "P1", "drive.duration": "60 s"}
study = tf.study("nasa-22x5.5-8pr", coarse)
def hottest(changes):
    return study.replace(changes).run().peaks["tyre"].temperature
found = study.sweep(spread={"tolerances": {"drive.load": "5 %"}})
found.save("swept")
print(json.dumps({
    "as it is": hottest({}),
    "effect": hottest({"effects": [{"name": "moon", "absorbed": "500 W/m**2"}]}),
    "strain law": hottest({"mechanics.strain": "twin"}),
    "boundary law": hottest({"boundaries.outside_air": {"law": "even-gust", "coefficient": "100 W/m**2/K"}}),
    "question": [part.name for part in found.parts],
    "section": hottest({"section": "twin-section"}),
    "material": hottest({"materials.tread": "twin-rubber"}),
}))
"""


def run(folder: Path, *arguments: str) -> str:
    """What Python says with the package of a folder."""
    # Options for the outer pytest are not for an inner one: a second -q hides the names of tests.
    environment = {name: value for name, value in os.environ.items() if name != "PYTEST_ADDOPTS"}
    environment["PYTHONPATH"] = str(folder)
    done = subprocess.run(
        [sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False,
        timeout=300,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr + done.stdout
    return done.stdout


@pytest.fixture(scope="module")
def extended(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the repository with one more file of each kind."""
    folder = tmp_path_factory.mktemp("extended")
    ignored = shutil.ignore_patterns("__pycache__")
    for name in ("tyrefem", "geometry", "materials", "studies", "tests"):
        shutil.copytree(ROOT / name, folder / name, ignore=ignored)
    shutil.copy(ROOT / "pyproject.toml", folder)
    for new, (shipped, renamed) in COPIES.items():
        text = (ROOT / shipped).read_text(encoding="utf-8")
        for old, name in renamed.items():
            assert old in text, f"{shipped} has no {old!r}"
            text = text.replace(old, name)
        (folder / new).write_text(text, encoding="utf-8")
    return folder


def test_each_new_file_works_by_existing(extended: Path) -> None:
    answers = json.loads(run(extended, "-c", ASKED))
    usual = answers["as it is"]
    assert answers["boundary law"] < usual < answers["effect"]
    for same in ("strain law", "section", "material"):
        assert answers[same] == usual, same
    assert answers["question"] == ["spread"]
    assert {path.name for path in (extended / "swept").iterdir()} >= {"spread.csv", "spread.parquet", "sweep.html"}
    assert "tyrefem twin" in run(extended, "-m", "tyrefem", "twin", "--help")


def test_the_contracts_find_them(extended: Path) -> None:
    tests = ("tests/effects/test_every_effect.py", "tests/cards/test_shipped_cards.py")
    collected = run(extended, "-m", "pytest", "--collect-only", "-q", "-p", "no:cacheprovider", *tests)
    for name in ("moon", "twin-rubber", "twin-section"):
        assert f"[{name}]" in collected, name
    commands = run(extended, "-m", "pytest", "--collect-only", "-q", "-p", "no:cacheprovider", "tests/hostile")
    assert "twin" in commands


def test_a_new_effect_is_tested_like_the_others(extended: Path) -> None:
    run(
        extended,
        "-m",
        "pytest",
        "-q",
        "-x",
        "-p",
        "no:cacheprovider",
        "-k",
        "moon",
        "tests/effects/test_every_effect.py",
    )
