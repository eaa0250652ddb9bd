"""Ctrl-C at any moment of any command: exit code 130, one line that says what is kept, nothing half-written."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from pathlib import Path

import psutil
import pytest
from interrupting import Interrupted, interrupted
from terminal import NASA, SHORT, TABLES

from tyrefem.cli import main
from tyrefem.heating_test.files import find

#: In the middle of a simulation, of a picture, of a table.
STEP = "tyrefem.conduction.balance:HeatBalance.remainder:40"
PICTURE, TABLE = "matplotlib.figure:Figure.savefig:1", "tyrefem.output.csv_table:write_csv:1"
#: While numpy is loaded, and while Python ends.
LOADING = "numpy.linalg"
SPEEDS = ("--vary", "drive.speed=10 mph,20 mph,30 mph", "--set", "mesh.size=12 mm", *SHORT[:2])
NOTHING = "tyrefem: interrupted; nothing was written\n"


def clean(folder: Path, done: Interrupted) -> str:
    """The one line of a command that was interrupted in good order and left nothing half-written."""
    assert done.code == 130, done
    # A comparison says beforehand how many simulations it will make; a busy machine says how far it is.
    *before, line = done.err.splitlines(keepends=True)
    assert not [each for each in before if " simulations: " not in each and "% after " not in each], done.err
    assert line.startswith("tyrefem: interrupted"), done.err
    hidden = [path for path in folder.rglob(".*") if path.name != ".progress"]
    assert not hidden
    return line


@pytest.fixture
def rig(here: Path) -> Path:
    """A short version of the shipped rig: one power, 200 s of heating."""
    text = find("trtlab").read_text(encoding="utf-8").split("[runs.high]")[0]
    text = text.replace('"1050 s"', '"200 s"').replace('cooling = "550 s"', 'cooling = "60 s"')
    (here / "mine.toml").write_text(text, encoding="utf-8")
    return here


@pytest.mark.parametrize(
    "arguments",
    [["run", NASA], ["list", "studies"], ["show", NASA], ["check", NASA], ["new", "mine"], ["rig", "layers", "trtlab"]],
    ids=lambda words: words[0],
)
def test_while_loading(here: Path, arguments: list[str]) -> None:
    assert clean(here, interrupted(*arguments, at="typer", folder=here)) == NOTHING
    assert list(here.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "moment"),
    [
        (["run", NASA, *SHORT], LOADING),
        (["run", NASA, *SHORT], "tyrefem.geometry.meshing:build:1"),
        (["compare", "example-validation", "--no-inputs"], STEP),
        (["press", "passenger-205-55r16"], "tyrefem.mechanics.solid.newton:_newton:1"),
        (["export", NASA, "--workers", "1", "--set", "mesh.size=12 mm"], STEP),
        (
            ["isolability", "hidden-effect", "--workers", "1", "--set", "mesh.size=12 mm"],
            "tyrefem.diagnose.forward.evaluations:Evaluations.together:1",
        ),
        (["rig", "simulate", "trtlab"], STEP),
        (["rig", "identify", "trtlab"], STEP),
        (["rig", "layers", "trtlab"], "tyrefem.conduction.balance:HeatBalance.remainder:3"),
    ],
    ids=lambda given: given[0] if isinstance(given, list) else None,
)
def test_before_anything_is_finished(here: Path, arguments: list[str], moment: str) -> None:
    line = clean(here, interrupted(*arguments, at=moment, folder=here))
    assert line in (NOTHING, "tyrefem: interrupted; no simulation is finished yet\n")
    assert not [path for path in here.rglob("*") if path.is_file()]


def test_a_run_keeps_what_it_reached(here: Path) -> None:
    long = ("--set", "mesh.size=8 mm", "--set", "output.every=2 s", "--out", "out", "--no-vtk")
    done = interrupted("run", NASA, *long, at=STEP, folder=here)
    assert clean(here, done).endswith("s; finished files are in out\n")
    assert json.loads((here / "out/summary.json").read_text(encoding="utf-8"))["complete"] is False
    assert (here / "out/report.html").is_file()


@pytest.mark.parametrize(
    ("moment", "kept"),
    [
        (TABLE, "the tables are in out, pictures and VTK files are not complete"),
        ("tyrefem.reports.vtk:_write:1", "the tables are in out, pictures and VTK files are not complete"),
        (PICTURE, "the tables are in out, pictures and VTK files are not complete"),
        ("tyrefem.cli.run:_words:1", "complete files are in out"),
    ],
)
def test_a_run_that_is_through_keeps_all_its_tables(here: Path, moment: str, kept: str) -> None:
    line = clean(here, interrupted("run", NASA, *SHORT, "--out", "out", at=moment, folder=here))
    assert line == f"tyrefem: interrupted; {kept}\n"
    assert {file.name for file in (here / "out").iterdir() if file.is_file()} >= TABLES
    # The folder is not.
    assert json.loads((here / "out/summary.json").read_text(encoding="utf-8"))["complete"] is False


def test_ctrl_c_twice_says_one_thing(here: Path) -> None:
    # In the march, and then while what was reached is drawn.
    long = ("--set", "mesh.size=8 mm", "--set", "output.every=2 s", "--out", "out", "--no-vtk")
    line = clean(here, interrupted("run", NASA, *long, at=[STEP, PICTURE], folder=here))
    assert "; the tables up to " in line
    assert {file.name for file in (here / "out").iterdir() if file.is_file()} == TABLES
    # In the march, and then while Python ends.
    moments = ["concurrent.futures.process:ProcessPoolExecutor.submit:2", "tyrefem.processes:end_children:1"]
    assert clean(here, interrupted("sweep", NASA, *SPEEDS, "--workers", "2", at=moments, folder=here, new=True))


def test_a_campaign_keeps_its_cases(here: Path) -> None:
    assert main(["new", "study", "mine"]) == 0
    study = here / "studies/mine/study.toml"
    study.write_text('cases = "cases.csv"\n' + study.read_text(encoding="utf-8"), encoding="utf-8")
    study.with_name("cases.csv").write_text("name,drive.speed\na,10 mph\nb,20 mph\n", encoding="utf-8")
    command = ("run", "mine", *SHORT, "--no-vtk", "--out", "out")
    line = clean(here, interrupted(*command, at="tyrefem.reports.campaign:run_campaign:1", folder=here))
    assert line == "tyrefem: interrupted; nothing was written\n"
    second = "tyrefem.inputs.study:StudyData.case_study:4"
    line = clean(here, interrupted(*command, at=second, folder=here))
    assert line == "tyrefem: interrupted; finished cases are in out/campaign.csv\n"
    # While the first one's report is drawn: its numbers are in the table.
    clean(here, interrupted(*command, at=PICTURE, folder=here))
    with (here / "out/campaign.csv").open(newline="", encoding="utf-8") as file:
        assert [row["case"] for row in csv.DictReader(file)] == ["a"]
    assert json.loads((here / "out/summary.json").read_text(encoding="utf-8"))["complete"] is False


def test_rig_keeps_fits_and_tables(rig: Path) -> None:
    done = interrupted("rig", "simulate", "mine.toml", "--seed", "1", "--out", "sim", at=PICTURE, folder=rig)
    assert clean(rig, done) == "tyrefem: interrupted; sim has the tables, but not the pictures\n"
    assert {file.name for file in (rig / "sim").iterdir()} == {"low.csv", "summary.json"}
    layers = ("rig", "layers", "mine.toml", "sim/low.csv", "--out", "layers")
    line = clean(rig, interrupted(*layers, at="tyrefem.heating_test.identification:identify:2", folder=rig))
    assert line == "tyrefem: interrupted; 1 of 2 fits are in layers/layers.csv\n"
    assert json.loads((rig / "layers/summary.json").read_text(encoding="utf-8"))["complete"] is False
    identify = ("rig", "identify", "mine.toml", "sim/low.csv", "--constant", "--out", "identified")
    line = clean(rig, interrupted(*identify, at=PICTURE, folder=rig))
    assert line == "tyrefem: interrupted; identified has the tables and cards, but not the page\n"
    assert (rig / "identified/rig.json").is_file()


def test_press_keeps_its_tables(here: Path) -> None:
    command = ("press", NASA, "--motion", "linear", "--set", "mesh.size=12 mm", "--out", "out", "--no-vtk")
    line = clean(here, interrupted(*command, at=PICTURE, folder=here))
    assert line == "tyrefem: interrupted; out has the tables, but not the pictures\n"
    assert (here / "out/press.json").is_file()


def test_blind_and_isolability_go_on(here: Path) -> None:
    coarse = ("--workers", "2", "--set", "mesh.size=12 mm", "--set", "mesh.element=P1", "--out", "out")
    # The third answer of a worker is waited for when the first two are kept.
    third = "tyrefem.variants.answer_store:AnswerStore.keep:3"
    line = clean(here, interrupted("isolability", "hidden-effect", *coarse, at=third, folder=here, new=True))
    assert line == "tyrefem: interrupted; 2 finished simulations are kept; the same command resumes from there\n"
    # The two have the same runs: what the first has finished serves the second.
    (here / "out").rename(here / "blind")
    (here / "blind/summary.json").unlink()
    coarse, last = (*coarse[:-1], "blind"), "tyrefem.diagnose.forward.evaluations:Evaluations.together:1"
    blind = ("blind", "hidden-effect", "--cases", "1", "--force")
    line = clean(here, interrupted(*blind, *coarse, at=last, folder=here, new=True))
    assert line == "tyrefem: interrupted; 0 of 1 cases are finished; the same command resumes from there\n"
    assert len(list((here / "blind/.progress").rglob("*.npz"))) == 2


def test_a_sweep_whose_page_is_not_drawn_goes_on(here: Path) -> None:
    line = clean(here, interrupted("sweep", NASA, *SPEEDS, "--workers", "1", "--out", "out", at=PICTURE, folder=here))
    assert line == "tyrefem: interrupted; finished variants are in out; the same command resumes from there\n"


def test_an_interruption_that_a_library_swallows_is_sent_again(here: Path) -> None:
    # Within a finaliser Python prints the exception and goes on.
    code = (
        "import os, signal, time\n"
        # A shell that runs the tests in the background has them ignore it.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "import sys, tyrefem.cli, tyrefem.errors\n"
        "class Gone:\n"
        "    def __del__(self): os.kill(os.getpid(), signal.SIGINT)\n"
        "import tyrefem.cli.commands as commands\n"
        "def run_command_line(arguments):\n"
        "    Gone()\n"
        "    until = time.monotonic() + 60.0\n"
        "    while time.monotonic() < until: pass\n"
        "    return None, 0\n"
        "commands.run_command_line = run_command_line\n"
        "tyrefem.cli.main()\n"
    )
    (here / "program.py").write_text(code, encoding="utf-8")
    done = subprocess.run([sys.executable, "program.py"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, NOTHING)


def test_workers_of_an_interrupted_command_are_gone_and_silent(here: Path) -> None:
    # Interrupted as soon as the first two workers are started, and with them: they have imported nothing yet.
    moment = "concurrent.futures.process:ProcessPoolExecutor.submit:3"
    done = interrupted("sweep", NASA, *SPEEDS, "--workers", "2", at=moment, folder=here, new=True)
    clean(here, done)
    psutil.wait_procs([process for process in psutil.process_iter() if _of(process, done.group)], timeout=10)
    assert not [process for process in psutil.process_iter() if _of(process, done.group)]


def test_a_command_that_ends_at_once_leaves_no_warning(here: Path) -> None:
    # As when workers do not end in time: the semaphores of their queues are left to Python's tracker.
    code = (
        "import os\n"
        "from tyrefem.processes import processes\n"
        "if __name__ == '__main__':\n"
        "    with processes(1) as pool:\n"
        "        assert pool.submit(abs, -3).result() == 3\n"
        "        os._exit(130)\n"
    )
    (here / "program.py").write_text(code, encoding="utf-8")
    done = subprocess.run([sys.executable, "program.py"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, "")


def _of(process: psutil.Process, group: int) -> bool:
    try:
        return os.getsid(process.pid) == group and process.status() != psutil.STATUS_ZOMBIE
    except (psutil.Error, OSError):
        return False


def test_a_comparison_goes_on(here: Path) -> None:
    coarse = [word for change in ("size=12 mm", "element=P1") for word in ("--set", f"mesh.{change}")]
    coarse += ["--set", "numerics.tolerance=1 delta_degC", "--set", "output.every=20 s", "--reduced", "never"]
    command = ("compare", "example-validation", *coarse, "--workers", "2", "--out", "out")
    done = interrupted(*command, at="tyrefem.variants.answer_store:AnswerStore.keep:6", folder=here, new=True)
    lines = done.err.splitlines()
    assert done.code == 130
    assert lines[0].startswith("tyrefem: 45 simulations: 3 drives as driven; 42 with one uncertain input changed")
    assert lines[1:] == ["tyrefem: interrupted; 5 finished simulations are kept; the same command resumes from there"]
    done = interrupted(*command, at="tyrefem.reports.comparison:pictures:1", folder=here)
    lines = done.err.splitlines()
    assert done.code == 130
    assert lines[0].endswith("; 2 are reused from an interrupted comparison")
    # Between them lines of progress, on a slow machine.
    assert lines[-1] == "tyrefem: interrupted; 45 finished simulations are kept; the same command resumes from there"
    assert main([*command, "--quiet"]) == 0
    assert not (here / "out/.progress").exists()
