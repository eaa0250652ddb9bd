"""Names that a study only looks up later are followed by `tyrefem check`, and errors say the file's own words."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from tyrefem import library
from tyrefem.cli import main

pytestmark = pytest.mark.fast


@pytest.fixture
def written(here: Path) -> Callable[..., str]:
    """The example validation's study with a text replaced, in the current folder."""

    def write(old: str, new: str) -> str:
        if not (here / "mine").is_dir():
            shutil.copytree(library.shipped() / "studies/example-validation", here / "mine")
        text = (library.shipped() / "studies/example-validation/study.toml").read_text(encoding="utf-8")
        assert old in text
        (here / "mine/study.toml").write_text(text.replace(old, new, 1), encoding="utf-8")
        return "mine/study.toml"

    return write


WRONG = [
    (
        '"drive.load" =',
        '"drive.lod" =',
        "uncertainty.drive.lod: not set in the study or its cards; did you mean 'load'",
    ),
    ('"drive.load" =', '"title" =', "uncertainty.title: 'Example validation"),
    ('"drive.load" = "2 %"', '"boundaries.road.fraction" = "2 %"', "uncertainty.boundaries.road.fraction: not set"),
    (
        'drive = { load = "4000 lbf"',
        'drive = { lod = "4000 lbf"',
        "measured.1.drive: unknown key 'lod'; did you mean 'load'",
    ),
    ('"4000 lbf"', '"4e6 lbf"', "measured.1.drive.load: "),
    ("phases.rolling.speed", "phases.roling.speed", "measured.2.drive.phases.roling: no entry 'roling'"),
    ('table = "run-3.csv"', 'table = "run-33.csv"', "run-33.csv: cannot be read"),
    ('table = "run-3.csv"', 'table = "run-3.csv"\nrun = "hot"', "run-3.csv: measured.run: no run 'hot'"),
    (
        'table = "run-3.csv"',
        'table = "run-3.csv"\nrename = { T1 = "crown-inner" }',
        "run-3.csv: no column 'T1' to rename",
    ),
    (
        "crown-inner =",
        "crown-iner =",
        "column 'crown-inner' (in run-1.csv, run-2.csv, run-3.csv) is no sensor of study",
    ),
    ("[uncertainty]", '[diagnosis]\nexclude = ["sunn"]\n[uncertainty]', "unknown effects 'sunn' (did you mean 'sun'?)"),
]


@pytest.mark.parametrize(("old", "new", "words"), WRONG, ids=[row[1][:24] for row in WRONG])
def test_names_that_lead_nowhere(
    written: Callable[..., str], refused: Callable[..., str], old: str, new: str, words: str
) -> None:
    assert words in refused("check", written(old, new))


def test_a_misspelt_uncertain_number_is_said_before_any_run(
    written: Callable[..., str], refused: Callable[..., str]
) -> None:
    """Every user of the uncertain numbers names the entry of the file."""
    file = written('"drive.load" =', '"drive.lod" =')
    assert f"{file}: uncertainty.drive.lod: not set" in refused("compare", file)


DRIVES = [
    ('ambient = "25 degC"', 'ambient = "25 lbf"', "drive.ambient: 'lbf' is not a unit"),
    ('ambient = "25 degC"', 'ambient = { from = "25 degC", to = "3 m" }', "drive.ambient.to: 'm' is not"),
    ('ambient = "25 degC"', 'ambient = "-300 degC"', "drive.ambient: '-300 degC' is below absolute zero"),
    ('ambient = "25 degC"', 'ambient = "25 degC"\ninitial = "2 m"', "drive.initial: 'm' is not"),
    ('load = "2700 lbf"', 'load = "2700 mph"', "drive.load: 'mph' is not"),
    (
        'pressure = "83 psi"',
        'pressure = "83 psi"\nambiant = "5 degC"',
        "drive: unknown key 'ambiant'; did you mean 'ambient'",
    ),
    ('speed = "0 mph"', 'speed = "0 lbf"', "drive.phases.1.speed: 'lbf' is not"),
    ('speed = "0 mph"', 'speed = "0 mph"\nambient = "2 m"', "drive.phases.1.ambient: 'm' is not"),
]


@pytest.mark.parametrize(("old", "new", "words"), DRIVES, ids=[row[1][:30] for row in DRIVES])
def test_what_is_wrong_in_the_drive_is_said_of_where_it_stands(
    written: Callable[..., str], refused: Callable[..., str], old: str, new: str, words: str
) -> None:
    message = refused("check", written(old, new))
    assert f"study.toml: {words}" in message


def test_an_ambient_in_the_drive_of_one_phase(refused: Callable[..., str]) -> None:
    assert "study.toml: drive.ambient: " in refused("run", "nasa-22x5.5-8pr", "--set", "drive.ambient=25 lbf")


def test_columns_named_otherwise_in_measured_entries(
    here: Path, written: Callable[..., str], capfd: pytest.CaptureFixture[str]
) -> None:
    file = written('table = "run-3.csv"', 'table = "run-3.csv"\nrename = { T1 = "crown-inner" }\nignore = ["room"]')
    table = here / "mine/run-3.csv"
    lines = table.read_text(encoding="utf-8").replace("crown-inner", "T1").splitlines()
    heading = next(number for number, line in enumerate(lines) if line.startswith("time"))
    rows = [
        f"{line},{'room [degC]' if number == heading else '20'}" for number, line in enumerate(lines[heading:], heading)
    ]
    table.write_text("\n".join(rows), encoding="utf-8")
    assert main(["check", file]) == 0
    assert "3 measured runs" in capfd.readouterr().out


def test_a_mark_of_utf_8_before_a_card(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """Windows editors write one."""
    card = (library.shipped() / "materials/nasa-tread.toml").read_bytes()
    (here / "tread.toml").write_bytes(b"\xef\xbb\xbf" + card)
    assert main(["check", "tread.toml"]) == 0
    assert "a material card" in capfd.readouterr().out
