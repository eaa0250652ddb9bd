"""Every command with ``--json`` prints one JSON object with the documented keys, and quiet nothing but errors."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from documented_keys import checked
from every_command import Command, commands
from json_answers import answered

import tyrefem as tf
from tyrefem.cli import main
from tyrefem.contracts import template
from tyrefem.schemas.answers import ANSWERS

#: Commands that take seconds; the others are tried here too, with ``--json`` alone.
QUICK = ("check", "list", "new", "road film", "run", "show", "slide rise", "sweep")


#: Commands without results in files; those of the others: `test_files_of_every_command.py`.
PRINTING = [each for each in commands() if "out" not in each.options]


@pytest.mark.parametrize("command", PRINTING, ids=lambda command: command.name)
def test_json_is_one_object_with_the_documented_keys(
    command: Command, here: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    answered(command, command.line(None, "--json"), capfd)


def test_the_study_of_a_folder_has_the_changes_and_stays_the_user_s(here: Path) -> None:
    """The file that a command reads is not replaced, wherever the results go; another's study is refused."""
    own = (here / "study.toml").read_bytes()
    pressed = ["modes", "study.toml", "--highest", "0", "--no-pictures", "-q", "--set", "drive.pressure=60 psi"]
    assert main([*pressed, "--out", "new"]) == 0
    study = tf.load("new").study
    assert study is not None
    assert study.data["drive"]["pressure"] == "60 psi"
    sweep = ["sweep", "study.toml", "--vary", "drive.speed=10 mph:20 mph:2", "--workers", "1", "--no-pictures", "-q"]
    # It goes on from there, into its folder too: there it is the input.
    kept = (here / "new" / "study.toml").read_bytes()
    assert main(["modes", "new/study.toml", "--highest", "0", "--no-pictures", "-q", "--out", "new"]) == 0
    assert (here / "new" / "study.toml").read_bytes() == kept
    # A run without --out, in the folder of results: beside the one that the study stands in.
    assert main([*pressed, "--out", "results/soft"]) == 0
    assert main(["run", "results/soft/study.toml", "--no-pictures", "--no-vtk", "-q"]) == 0
    run = tf.load("results/soft-run")
    assert run.study is not None
    assert run.study.data["drive"]["pressure"] == "60 psi"
    # Beside the user's study.
    assert main([*pressed, "--out", "."]) == 0
    assert (here / "study.toml").read_bytes() == own
    told = json.loads((here / "summary.json").read_text(encoding="utf-8"))
    assert "study.toml" not in told["files"]
    assert told["input"]["drive"]["pressure"] == "60 psi"
    tf.study("study.toml").run().save(here, force=True)
    assert main(["run", "study.toml", "--no-pictures", "--no-vtk", "-q", "--out", ".", "--force"]) == 0
    assert main([*sweep, "--out", ".", "--force"]) == 0
    assert (here / "study.toml").read_bytes() == own
    # In a folder with a study that is not this one.
    (here / "other").mkdir()
    (here / "other" / "study.toml").write_bytes(own)
    assert main([*pressed, "--out", "other"]) == 2
    assert (here / "other" / "study.toml").read_bytes() == own


@pytest.mark.parametrize("words", QUICK)
def test_quiet_says_nothing(words: str, here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    command = next(each for each in commands() if each.words == words)
    assert main(command.line(command.out(here / "new"), "--quiet")) == 0
    assert capfd.readouterr() == ("", "")
    # Quiet, the answer in JSON is still given.
    assert (
        main(command.line(command.out(here / "again"), "-q", "--json", *(["--force"] if words == "new" else []))) == 0
    )
    out, err = capfd.readouterr()
    checked(words, out)
    assert err == ""


@pytest.mark.parametrize("options", [["--json"], ["--quiet"], ["--quiet", "--json"]])
def test_an_error_is_one_line_on_stderr(options: list[str], here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "study.toml", "--set", "drive.speed=5 kg", *options]) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert err.startswith("tyrefem: study.toml: drive.speed: ")
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize("options", [[], ["--json"], ["--quiet"]])
def test_warnings_are_on_stderr_unless_quiet(options: list[str], here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    unlikely = ["--set", "materials.tread.density.value=1.18 kg/m**3", "--no-pictures", "--no-vtk", "--out", "new"]
    assert main(["run", "study.toml", *unlikely, *options]) == 0
    out, err = capfd.readouterr()
    assert ("is unlikely" in err) == (options != ["--quiet"])
    if options == ["--json"]:
        checked("run", out)


def test_other_questions_to_a_command_are_documented_too(here: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["press", "study.toml", "--critical-speed", "--out", "new", "--json", "--no-pictures"]) == 0
    checked("press", capfd.readouterr().out)
    assert main(["roll", "study.toml", "--slip-angle", "0 deg, 1 deg", "--out", "curve", "--json"]) == 0
    checked("roll", capfd.readouterr().out)
    (here / "cases.csv").write_text("name,drive.speed [mph]\nslow,10\nfast,20\n", encoding="utf-8")
    text = (here / "study.toml").read_text(encoding="utf-8")
    (here / "campaign.toml").write_text('cases = "cases.csv"\n' + text, encoding="utf-8")
    assert main(["run", "campaign.toml", "--out", "cases", "--json", "--no-pictures", "--no-vtk"]) == 0
    checked("run", capfd.readouterr().out)


def test_all_questions_of_a_sweep_and_all_of_a_run_are_documented(
    here: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    vary = ["--vary", "drive.speed=10 mph:20 mph", "--vary", "materials.tread.loss_tangent.value=x0.8:x1.2"]
    asked = ["--indices", "4", "--tornado", "--envelope", "hottest_degC<90"]
    assert main(["sweep", "study.toml", *vary, *asked, "--out", "asked", "--json"]) == 0
    checked("sweep", capfd.readouterr().out)
    vary = ["--vary", "drive.speed=10 mph:20 mph", "--vary", "drive.load=2500 lbf:3000 lbf"]
    asked = ["--minimise", "hottest_degC", "--limit", "rolling_resistance_N<500"]
    assert main(["sweep", "study.toml", *vary, *asked, "--out", "best", "--json"]) == 0
    checked("sweep", capfd.readouterr().out)
    changes = [
        "mechanics.strain=fem",
        "mechanics.motion=linear",
        "mechanics.feedback.pressure=true",
        "drive.slip_ratio=5 %",
    ]
    flags = [word for change in changes for word in ("--set", change)]
    assert main(["run", "study.toml", *flags, "--out", "warm", "--json", "--no-pictures", "--no-vtk"]) == 0
    out = capfd.readouterr().out
    assert {"feedback", "sliding", "footprint"} <= set(json.loads(out))
    checked("run", out)
    for what in (["mesh", "study.toml"], ["strain", "study.toml"], ["effect", "sun"], ["sweep", "crown-angle"]):
        assert main(["show", *what, "--json"]) == 0
        checked("show", capfd.readouterr().out)


def test_every_command_lists_the_plugins_that_take_part(
    here: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for kind, name in (("effect", "lamp"), ("boundary-law", "power-film")):
        (here / "plugins").mkdir(exist_ok=True)
        (here / "plugins" / f"{kind}.py").write_text(template(kind, name), encoding="utf-8")
    monkeypatch.setenv("TYREFEM_PLUGINS", str(here / "plugins"))
    film = 'boundaries.outside_air={law = "power-film", at_10_m_s = "30 W/m**2/K"}'
    # A lamp is a candidate of every diagnosis, and the film the law of this study.
    for words, expected in {
        "isolability": ["power-film", "lamp"], "blind": ["power-film", "lamp"], "plan": ["power-film", "lamp"],
        "explore": ["power-film"],
    }.items():  # fmt: skip
        command = next(each for each in commands() if each.words == words)
        assert main(command.line(command.out(here / "new" / words), "--json", "--set", film)) == 0
        used = json.loads(capfd.readouterr().out)["plugins"]
        assert sorted(plugin["name"].split(".")[-1] for plugin in used) == sorted(expected), words


def test_no_keys_of_a_command_that_there_is_not() -> None:
    words = {each.words for each in commands()}
    assert {name.partition(" (")[0].partition(" --")[0] for name in ANSWERS} == words
