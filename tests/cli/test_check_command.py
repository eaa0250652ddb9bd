"""`tyrefem check` of every kind of file, good and bad."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tyrefem import library
from tyrefem.api import study
from tyrefem.cards.file_kinds import FILES
from tyrefem.cli import main
from tyrefem.compare.study_check import check_study
from tyrefem.errors import InputError

GOOD = {
    "geometry/nasa-22x5.5-8pr.toml": "a section, ",
    "materials/nasa-carcass.toml": "a material card, ",
    "studies/nasa-taxi-takeoff/study.toml": "a study of ",
    "studies/nasa-taxi-takeoff": "a study of ",
    "studies/nasa-campaign": "a campaign of 19 cases",
    "studies/nasa-campaign/cases.csv": "a table of 19 cases",
    "studies/example-validation": "3 measured runs",
    "studies/example-validation/run-1.csv": "a measured table, 1 run, ",
}


@pytest.mark.parametrize("file", GOOD)
def test_good_files(file: str, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(library.shipped() / file)]) == 0
    out, err = capfd.readouterr()
    assert GOOD[file] in out
    assert err == ""


def test_a_study_tells_how_its_tables_are_read(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    card = (library.shipped() / "studies/nasa-22x5.5-8pr/study.toml").read_text(encoding="utf-8")
    (tmp_path / "study.toml").write_text(card + '\n[[measured]]\ntable = "log.csv"\n', encoding="utf-8")
    (tmp_path / "log.csv").write_text("time [s],crown-inner [degC]\n0,25\n10,OL\n20,26\n", encoding="utf-8")
    assert main(["check", str(tmp_path)]) == 0
    out = capfd.readouterr().out
    assert "1 measured run; log.csv: no reading in 1 cell of 'crown-inner [degC]' (OL)" in out


def test_every_shipped_card_is_good(capfd: pytest.CaptureFixture[str]) -> None:
    cards = [path for kind in library.FOLDERS for path in library.names(kind).values()]
    assert len(cards) > 8
    assert [str(path) for path in cards if main(["check", str(path)]) != 0] == []


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("name,Lab 3\ntime [s],crown [degC]\n0,25\n", "a measured table, 1 run, 1 reading of crown"),
        ("name,Lab 3\n\ntime;crown [degC]\n2024-05-01T12:30:01;25\n", "a measured table, 1 run"),
        ("Zeit;crown\nmin;°C\n0;25\n", "crown; units are those of line 2; times are those of 'Zeit [min]'"),
        ('"name","drive.load [lbf]","note"\n"t","1","time"\n', "a table of 1 case"),
    ],
)
def test_a_loggers_table_is_no_table_of_cases(
    here: Path, capfd: pytest.CaptureFixture[str], table: str, words: str
) -> None:
    (here / "table.csv").write_text(table, encoding="utf-8")
    assert main(["check", "table.csv"]) == 0
    assert words in capfd.readouterr().out


def test_a_table_with_other_names_of_columns(
    here: Path, refused: Callable[..., str], capfd: pytest.CaptureFixture[str]
) -> None:
    (here / "logger.csv").write_text("Dauer,T1 [degC],room [degC]\n0:00,20,20\n0:30,21,20\n", encoding="utf-8")
    renamed = ["--rename", "Dauer=time [mm:ss]", "--rename", "T1=crown", "--ignore", "room"]
    assert main(["check", "logger.csv", *renamed]) == 0
    assert "1 run, 2 readings of crown" in capfd.readouterr().out
    words = refused("check", "nasa-tread", "--ignore", "room")
    assert "--ignore: goes with a measured table; in a study both are keys of its [[measured]] entries" in words
    (here / "own.py").write_text("", encoding="utf-8")
    assert "--rename: goes with a measured table" in refused("check", "own.py", "--rename", "T1=crown")


def test_a_run_that_was_not_measured_is_named() -> None:
    """Its effects would be left out without a word."""
    assert check_study(study("example-validation", {"run": "run-2"})) == 3
    with pytest.raises(InputError, match=r"run: no measured run 'run-22'; did you mean 'run-2'\?"):
        check_study(study("example-validation", {"run": "run-22"}))


BAD = {
    "wrong.toml": (b"title = \n", "not valid TOML: Invalid value (at line 1, column 9)"),
    "empty.toml": (b"", "is empty"),
    "binary.toml": (b"\x7fELF\xff\xfe\x00", "not a text file in UTF-8"),
    "other.toml": (b"x = 1\n", "unknown key 'x'"),
    "newline.toml": (b'"a\\nb\\u001b[31m" = 1\n', "unknown key 'a b"),
    "empty.csv": (b"", "is empty"),
    "binary.csv": (b"\x7fELF\x00\x01", "is not a text file"),
    "zip.csv": (b"PK\x03\x04rest", "workbook or archive that cannot be read"),
    "words.csv": (b"hello\nworld\n", "no time column"),
    "short.csv": (b"time [s],crown [degC]\n0,25\n1\n", "line 3: 1 cells, but the heading has 2"),
    "cases.csv": (b"name,drive.load [lbf]\na,1\na,2\n", "case 'a' stands in lines 2 and 3"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_files(here: Path, refused: Callable[..., str], name: str) -> None:
    content, words = BAD[name]
    (here / name).write_bytes(content)
    message = refused("check", name)
    assert words in message
    assert name in message


def test_missing_file_empty_folder_and_a_link_to_nowhere(here: Path, refused: Callable[..., str]) -> None:
    assert "nowhere.toml: no such file" in refused("check", "nowhere.toml")
    (here / "folder").mkdir()
    assert "folder: this folder has no sweep.toml, thermal.toml, rig.toml or study.toml" in refused("check", "folder")
    (here / "link.toml").symlink_to("nothing")
    assert "link.toml: cannot be read" in refused("check", "link.toml")


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("nasa-22x5.5-8pr", "a study of 1 phase, 600 s"),
        ("crown-angle", "a sweep: 100 variants"),
        ("nasa-tread", "a material card, Tread rubber"),
    ],
)
def test_what_the_library_knows_is_checked_by_name(
    here: Path, refused: Callable[..., str], capfd: pytest.CaptureFixture[str], name: str, words: str
) -> None:
    assert main(["check", name]) == 0
    assert words in capfd.readouterr().out
    assert "did you mean" in refused("check", name[:-1])


def test_a_file_of_another_kind_names_the_command_that_reads_it(here: Path, refused: Callable[..., str]) -> None:
    shipped = library.shipped()
    for kind, file, command in (
        ("a laser rig", shipped / "studies/rig-trtlab/rig.toml", "tyrefem rig simulate"),
        ("a thermal card", shipped / "studies/thermal-passenger/thermal.toml", "tyrefem thermal-card"),
        ("a sweep", shipped / "studies/crown-angle/sweep.toml", "tyrefem sweep"),
        ("a section", shipped / "geometry/nasa-22x5.5-8pr.toml", "tyrefem show section"),
        ("a material card", shipped / "materials/nasa-tread.toml", "tyrefem show material"),
    ):
        words = f"{file}: is {kind}, not a study; try: {command} {file}"
        assert words in refused("run", str(file))
        if file.parent.parent.name == "studies":
            assert words in refused("run", str(file.parent))
            assert words in refused("run", file.parent.name)
    study = shipped / "studies/nasa-22x5.5-8pr/study.toml"
    assert f"is a study, not a laser rig; try: tyrefem run {study}" in refused("rig", "simulate", str(study))
    assert f"is a study, not a thermal card; try: tyrefem run {study}" in refused("thermal-card", str(study))


@pytest.mark.parametrize("empty", [["--out", ""], ["--out="]])
def test_an_empty_folder_for_results_is_refused(refused: Callable[..., str], empty: list[str]) -> None:
    assert "--out: is empty; give a path" in refused("run", "nasa-22x5.5-8pr", *empty)


@pytest.mark.parametrize("name", FILES.values())
def test_a_folder_of_every_kind_of_file_is_checked(here: Path, refused: Callable[..., str], name: str) -> None:
    """A new kind of folder is known to the command from the list of kinds."""
    (here / "folder").mkdir()
    (here / "folder" / name).write_text("", encoding="utf-8")
    assert f"{name}: is empty" in refused("check", "folder")


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (
            '[explore]\nvary = { "drive.sped" = { from = "1 mph", to = "2 mph" } }',
            "explore.drive: a variant with drive.sped",
        ),
        ('[explore]\nvary = { "drive.speed" = nan }', "explore.vary: must be a list of values or a tuple"),
        ("[explore]\nlimits = { hottest_degC = 3 }", "explore.limits.hottest_degC: must be a table of keys, not 3"),
        ('[explore]\naxes = ["drive.speed", "drive.laod"]', "explore.axes: 'drive.laod' does not vary; did you mean"),
        (
            '[plan]\nlimits = { "drive.phases.x.speed" = ["1 mph", "2 mph"] }',
            "plan.limits.drive.phases.x.speed: the drive",
        ),
        (
            '[plan]\nsensors = { p = { s = "10 m", depth = "2 mm" } }',
            "plan.sensors.p: s = 10000.0 mm is off the section",
        ),
    ],
)
def test_the_tables_of_later_commands_are_checked(
    table: str, words: str, tmp_path: Path, refused: Callable[..., str]
) -> None:
    file = tmp_path / "study.toml"
    study = (library.shipped() / "studies/nasa-22x5.5-8pr/study.toml").read_text(encoding="utf-8")
    file.write_text(f"{study}\n{table}\n", encoding="utf-8")
    assert f"study.toml: {words}" in refused("check", str(file))
