"""Every command that takes a study, given one that lacks what its question may need."""

from __future__ import annotations

from pathlib import Path

import pytest
import small
from content import content, half_written, one_line, unchanged
from every_command import Command, commands

from tyrefem.cli import main

PHASES = """[drive]
load = "2700 lbf"
pressure = "83 psi"
ambient = "25 degC"
[[drive.phases]]
name = "rolling"
speed = "20 mph"
duration = "20 s"
[[drive.phases]]
name = "standing"
speed = "0 mph"
duration = "10 s"
"""
ODD = {
    "campaign": small.study(cases='cases = "cases.csv"', measured=""),
    "no-sensors": small.study(sensors="", measured=""),
    "no-measured-runs": small.study(measured=""),
    "nothing-held-out": small.study(measured=small.MEASURED.replace("true", "false")),
    "everything-held-out": small.study(measured=small.MEASURED.replace("false", "true")),
    "several-phases": small.study(drive=PHASES, measured=""),
    "no-sensors-no-table": small.study(sensors="", measured=small.MEASURED.replace("false", "true")),
}
#: Commands that ask about measured runs.
OF_RUNS = {"blind", "compare", "diagnose", "explore", "isolability", "plan"}
#: The others answer without sensors and without the table of the runs: studies that lack less tell nothing more.
OF_OTHERS = {"campaign", "several-phases", "no-sensors-no-table"}
QUESTIONS = [
    pytest.param(command, odd, id=f"{command.name}-{odd}")
    for command in commands()
    for odd in ODD
    if command.of_study and (odd != "no-sensors-no-table" if command.words in OF_RUNS else odd in OF_OTHERS)
]


@pytest.mark.parametrize(("command", "odd"), QUESTIONS)
def test_an_answer_or_one_error(command: Command, odd: str, here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (here / "study.toml").write_text(ODD[odd])
    without_table = odd == "no-sensors-no-table"
    if without_table:
        (here / "measured.csv").unlink()
    (here / "cases.csv").write_text("name,drive.speed [mph]\nslow,10\nfast,20\n")
    before = content(here)
    out = command.out(here / "new")
    code = main(command.line(out))
    err = capfd.readouterr().err
    assert code in ((0,) if without_table else (0, 2)), err
    one_line(err)
    unchanged(before, here)
    assert half_written(here) == []
    if code == 2:
        assert len(err.splitlines()) == 1
        assert content(here) == before
        assert not out.parent.exists()
