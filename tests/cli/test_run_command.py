"""`tyrefem run`: what is written, what is said, and what happens when it cannot go on."""

from __future__ import annotations

import csv
import json
import os
import pty
import re
import signal
import subprocess
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest
from terminal import BARE, NASA, SHORT, TABLES, command, process

import tyrefem as tf
from tyrefem.cli import main


def test_run_writes_tables_pictures_vtk_and_report(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["run", NASA, *SHORT, "--out", "deep/er"]) == 0
    out, err = capfd.readouterr()
    assert "hottest point" in out
    assert "deep/er/report.html" in out
    assert err == ""
    folder = here / "deep/er"
    assert {file.name for file in folder.iterdir()} == TABLES | {"vtk", "pictures", "report.html"}
    assert (folder / f"vtk/{NASA}.pvd").is_file()
    assert list((folder / "pictures").glob("*.png"))
    # No temporary file is left behind.
    assert not [file for file in folder.rglob("*") if file.name.startswith(".")]


def test_set_is_what_replace_does(here: Path) -> None:
    assert main(["run", NASA, *SHORT, *BARE, "--set", "drive.speed=25 mph"]) == 0
    written = json.loads((here / "results" / NASA / "summary.json").read_text(encoding="utf-8"))
    changes = {"drive.duration": "10 s", "mesh.size": "8 mm", "output.fields": 2, "drive.speed": "25 mph"}
    result = tf.study(NASA).replace(changes).run()
    assert written["hottest"]["temperature_degC"] == pytest.approx(float(result.extremes["temperature_degC"].iloc[0]))
    assert written["input"]["drive"]["speed"] == "25 mph"
    assert written["complete"] is True
    # The study that is written beside the results gives the same results.
    again = tf.study(here / "results" / NASA / "study.toml")
    assert again.data == result.study.data


def test_json_is_all_there_is_on_stdout(here: Path) -> None:
    done = process("run", NASA, *SHORT, *BARE, "--json")
    assert done.returncode == 0
    assert done.stderr == ""
    written = json.loads((here / "results" / NASA / "summary.json").read_text(encoding="utf-8"))
    output = json.loads(done.stdout)
    for clock in (written, output):
        clock.pop("wall_time_s")
    assert output == written


def test_pipe_is_quiet_and_terminal_shows_progress() -> None:
    done = process("run", NASA, *SHORT, *BARE)
    assert done.stderr == ""
    assert "\x1b" not in done.stdout
    assert "\r" not in done.stdout
    ours, theirs = pty.openpty()
    with subprocess.Popen(
        command("run", NASA, *SHORT, *BARE),
        stdout=subprocess.DEVNULL,
        stderr=theirs,
        env=os.environ | {"TERM": "xterm"},
    ) as running:
        os.close(theirs)
        shown = b""
        try:
            while piece := os.read(ours, 4096):
                shown += piece
        except OSError:  # how a terminal says that the other side is closed
            pass
        assert running.wait(60) == 0
    os.close(ours)
    assert NASA.encode() in shown
    assert b"%" in shown


def test_interruption_leaves_what_is_finished(here: Path) -> None:
    # Some thousand steps: stopped when the progress bar has moved, long before its end.
    long = ("--set", "drive.duration=5 h", "--set", "numerics.tolerance=1e-4 K", "--set", "output.every=10 s")
    ours, theirs = pty.openpty()
    with subprocess.Popen(
        command("run", NASA, *BARE, *long), stdout=subprocess.PIPE, stderr=theirs, text=True,
        env=os.environ | {"TERM": "xterm"},
        # A shell that runs the tests in the background has them ignore it.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as running:  # fmt: skip
        os.close(theirs)
        output = b""
        while not re.search(rb"\b[1-9]\d?%", output):
            output += os.read(ours, 4096)
        running.send_signal(signal.SIGINT)
        try:
            while piece := os.read(ours, 4096):
                output += piece
        except OSError:
            pass
        assert running.wait(60) == 130
    os.close(ours)
    assert b"tyrefem: interrupted at" in output
    assert b"Traceback" not in output
    folder = here / "results" / NASA
    assert {file.name for file in folder.iterdir()} == TABLES
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert summary["complete"] is False
    with (folder / "readings.csv").open(newline="", encoding="utf-8") as file:
        times = [float(row["time [s]"]) for row in csv.DictReader(file)]
    assert len(times) > 1
    assert 0.0 < times[-1] < 5 * 3600.0
    assert times == sorted(times)


def test_a_file_where_a_folder_is_wanted(here: Path, refused: Callable[..., str]) -> None:
    (here / "taken").write_text("mine", encoding="utf-8")
    for out in ("taken", "taken/below"):
        assert "--out: a file is in the place of this folder" in refused("run", NASA, *SHORT, "--out", out)
        assert "--out" in refused("compare", "example-validation", "--out", out)
    assert (here / "taken").read_text(encoding="utf-8") == "mine"


def test_a_folder_that_cannot_be_written(refused: Callable[..., str]) -> None:
    # Not even root can make a folder there.
    assert "cannot be written" in refused("run", NASA, *SHORT, "--out", "/proc/tyrefem/out")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nasa-22x5.5-8p"], "did you mean 'nasa-22x5.5-8pr'?"),
        (["./nowhere"], "no study file './nowhere'"),
        (["205/55R16"], "no study file '205/55R16'; a size becomes one by: tyrefem new study '205/55R16'"),
        (["~nobody-by-that-name/x"], "no study file"),
        ([NASA, "--set", "drive.sped=3 mph"], "did you mean 'speed'?"),
        ([NASA, "--set", "drive.speed"], "is not KEY=VALUE"),
        ([NASA, "--set", "drive.speed=20"], "has no unit"),
        ([NASA, "--set", "drive.speed=20 kg"], "is not a unit of this quantity"),
        ([NASA, "--set", "section=nasa-22x5.5-9pr"], "section: no section named"),
        ([NASA, "--set", "drive.load=1e7 lbf"], "drive"),
        (
            ["nasa-campaign", "--set", "drive.load=3000 lbf"],
            "'drive.load' is set again by 'drive.load' of every case: change it in cases.csv",
        ),
        (
            ["nasa-campaign", "--set", "drive.deflection=10 mm"],
            "'drive.deflection' is set again by 'drive.load' of every",
        ),
        (["nasa-campaign", "--set", "drive . load=3000 lbf"], "is set again by 'drive.load' of every case"),
        (["nasa-campaign", "--set", "section.crown_radius=3.6 in"], "is set again by 'section' of"),
    ],
)
def test_bad_input_is_refused_in_one_line(refused: Callable[..., str], arguments: list[str], words: str) -> None:
    assert words in refused("run", *arguments)


def test_a_file_whose_name_is_no_text_is_one_error(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "study", "mine", "--out", "mine.toml"]) == 0
    name = os.fsdecode(b"caf\xe9.toml")
    try:
        Path("mine.toml").rename(name)
    except OSError:
        pytest.skip("a file system whose names are text")
    capfd.readouterr()
    assert main(["run", name, *SHORT, "--no-vtk"]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err == "tyrefem: the name of a file or folder is not UTF-8 text, so that no result can hold it: rename it\n"


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="a device of Linux")
def test_lines_that_nobody_takes_leave_complete_results(
    here: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    summary, (reader, writer) = here / "results" / NASA / "summary.json", os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w", encoding="utf-8") as closed, monkeypatch.context() as piped:
        # As `tyrefem run ... | head` ends: the reader has gone.
        piped.setattr("sys.stdout", closed)
        assert main(["run", NASA, *SHORT, *BARE]) == 0
    assert json.loads(summary.read_text(encoding="utf-8"))["complete"] is True
    full = open("/dev/full", "w", encoding="utf-8")  # noqa: SIM115, its end would be an error
    with suppress(OSError), full, monkeypatch.context() as piped:
        # A full disk where stdout goes is an error, but not of the results.
        piped.setattr("sys.stdout", full)
        assert main(["run", NASA, *SHORT, *BARE]) == 2
    assert json.loads(summary.read_text(encoding="utf-8"))["complete"] is True
    assert capfd.readouterr().err == "tyrefem: No space left on device\n"
