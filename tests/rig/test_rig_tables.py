"""Every run of a rig has its table, or is left out by name; all wrong columns are named at once."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tyrefem.cli import main
from tyrefem.errors import InputError, ResultWarning
from tyrefem.heating_test.files import find, tables
from tyrefem.rig import load, read


@pytest.fixture
def rig(tmp_path: Path) -> Path:
    return Path(shutil.copytree(find("trtlab").parent, tmp_path / "rig"))


def test_a_table_that_is_missing_is_an_error_and_not_a_fit_of_the_others(
    rig: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (rig / "high.csv").unlink()
    for command in (["rig", "identify", str(rig), "--out", str(tmp_path / "out")], ["check", str(rig)]):
        assert main(command) == 2
        err = capfd.readouterr().err
        assert "without a table beside it: high.csv; to do without them, name low.csv" in err
    assert not (tmp_path / "out").exists()
    card, file = load(rig)
    assert [table.name for table in tables(card, file, ["low.csv"])] == ["low.csv"]


def test_tables_beside_a_card_are_checked(rig: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(rig)]) == 0
    assert "2 table(s)" in capfd.readouterr().out
    text = (rig / "low.csv").read_text(encoding="utf-8")
    (rig / "low.csv").write_text(text.replace("outer [degC]", "outr [degC]"), encoding="utf-8")
    assert main(["check", str(rig)]) == 2
    assert "no column 'outer [degC]'; did you mean 'outr'" in capfd.readouterr().err


def test_all_wrong_columns_are_named_at_once(rig: Path) -> None:
    card, _ = load(rig)
    text = (rig / "low.csv").read_text(encoding="utf-8")
    path = rig / "low.csv"
    path.write_text(text.replace("outer [degC]", "outr [degC]").replace("inner [degC]", "x [degC]"), encoding="utf-8")
    with pytest.raises(InputError, match=r"no columns 'outer' \(did you mean 'outr'\?\), 'inner'"):
        read(card, [path])
    with pytest.raises(InputError, match=r"columns 'outr' \(did you mean 'outer'\?\), 'x' are no sensors of the rig"):
        read(card, [path], ["outer", "inner"])


def test_how_a_table_was_read_is_a_warning(rig: Path) -> None:
    card, _ = load(rig)
    path = rig / "low.csv"
    path.write_text(path.read_text(encoding="utf-8").replace("time [s]", "Zeit/s"), encoding="utf-8")
    with pytest.warns(ResultWarning, match=r"low\.csv: times are those of 'Zeit/s'"):
        read(card, [path])


def test_columns_are_renamed_and_left_out(rig: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    card, _ = load(rig)
    plain = read(card, [rig / "low.csv", rig / "high.csv"])
    text = (rig / "low.csv").read_text(encoding="utf-8").replace("outer [degC]", "IR 1 [degC]")
    rows = [line if line.startswith("#") else f"{line},{'room [degC]' if 'time' in line else 20}"
            for line in text.splitlines()]  # fmt: skip
    (rig / "low.csv").write_text("\n".join(rows), encoding="utf-8")
    # Some table must have the columns, not each.
    renamed = read(card, [rig / "low.csv", rig / "high.csv"], rename={"IR 1": "outer"}, ignore=["room"])
    for before, after in zip(plain, renamed, strict=True):
        for was, now in zip(before.series, after.series, strict=True):
            assert (was.sensor, was.readings.tolist()) == (now.sensor, now.readings.tolist())
    with pytest.raises(InputError, match=r"'IR 2'.*to rename"):
        read(card, [rig / "low.csv"], rename={"IR 1": "outer", "IR 2": "inner"}, ignore=["room"])
    command = ["rig", "identify", str(rig), "--rename", "IR 1=outer", "--out", str(tmp_path / "out")]
    assert main(command) == 2
    assert "column 'room' is no sensor of the rig" in capfd.readouterr().err
    assert main(["rig", "layers", str(rig), "--ignore", "room", "--out", str(tmp_path / "out")]) == 2
    assert "--ignore: is for a table of readings; none is given" in capfd.readouterr().err
    assert not (tmp_path / "out").exists()
