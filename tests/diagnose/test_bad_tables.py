"""What a person gets wrong: said in one line, exit code 2, nothing written."""

from __future__ import annotations

from pathlib import Path

import pytest
from hidden import study

from tyrefem.cli import main

pytestmark = pytest.mark.fast

TABLES = {
    "no such sensor": ("time [s],crown-outr [degC]\n0,25\n60,30\n", "crown-outer"),
    "a word in a cell": ("time [s],crown-outer [degC]\n0,25\n60,hot\n", "hot"),
    "no unit": ("time [s],crown-outer\n0,25\n60,30\n", "unit"),
    "time runs back": ("time [s],crown-outer [degC]\n60,25\n0,30\n", "time"),
    "after the drive": (
        "time [s],crown-outer [degC]\n5000,25\n6000,30\n",
        "no fitted run has a reading within the simulated drive",
    ),
    "only the start": ("time [s],crown-outer [degC]\n0,25\n", "run 'table' has readings at 0 s only"),
    "broken thermocouple": ("time [s],crown-outer [degC]\n0,25\n60,1372\n", "1372"),
}


@pytest.mark.parametrize("name", TABLES)
def test_a_bad_table_is_refused(name: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    owner = study(tmp_path / "study")
    table = tmp_path / "table.csv"
    text, message = TABLES[name]
    table.write_text(text, encoding="utf-8")
    assert main(["diagnose", str(owner.file), str(table), "--out", str(tmp_path / "out"), "--workers", "1"]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.startswith("tyrefem: ")
    assert err.count("\n") == 1
    assert message in err
    assert not (tmp_path / "out").exists()


def test_bad_arguments_are_refused(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    owner = study(tmp_path / "study")
    taken = tmp_path / "taken"
    taken.write_text("mine", encoding="utf-8")
    for arguments, printed in (
        (["--rename", "T1"], "COLUMN=SENSOR"),
        (["--out", str(taken)], "a file is in the place"),
        ([str(tmp_path / "missing.csv")], "missing.csv"),
        (["--set", "drive.speed=fast"], "drive.speed"),
        (["--largest", "7"], "--largest"),
    ):
        assert main(["diagnose", str(owner.file), *arguments]) == 2
        assert printed in capfd.readouterr().err
    assert main(["diagnose", "nasa-22x5.5-8pr"]) == 2
    assert "[[measured]]" in capfd.readouterr().err
    assert taken.read_text(encoding="utf-8") == "mine"
