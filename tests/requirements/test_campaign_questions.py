"""A campaign is a table of drives: every other question is asked of one of its cases, by name."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import typer
from odd_studies import FITTED, HELD_OUT, write

import tyrefem as tf
from tyrefem.cli import app, main
from tyrefem.diagnose.blind.rates import run_blind
from tyrefem.diagnose.layout.isolability import isolability
from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.press import press
from tyrefem.realtime.certificate import export
from tyrefem.simulation.law_comparison import compare_laws
from tyrefem.sweep.design import loaded

BRIEF = ("--no-pictures", "--no-vtk")
#: Command lines with the campaign's folder in the place of "STUDY".
COMMANDS = {
    "sweep": ["sweep", "STUDY", "--vary", "drive.speed=10 mph,20 mph"],
    "tornado": ["sweep", "STUDY", "--tornado", "--tolerance-of", "drive.load=10%"],
    "export": ["export", "STUDY"],
    "explore": ["explore", "STUDY"],
    "compare": ["compare", "STUDY"],
    "diagnose": ["diagnose", "STUDY"],
    "isolability": ["isolability", "STUDY"],
    "plan": ["plan", "STUDY"],
    "blind": ["blind", "STUDY"],
    "press": ["press", "STUDY"],
    "modes": ["modes", "STUDY"],
    "life": ["life", "STUDY"],
    "wear": ["wear", "STUDY"],
    "roll": ["roll", "STUDY"],
    "forces": ["forces", "STUDY"],
    "strain": ["strain", "STUDY"],
    "mesh": ["show", "mesh", "STUDY"],
    "mesh file": ["show", "mesh", "STUDY", "--out", "tyre.vtu"],
    "strain cycle": ["show", "strain", "STUDY"],
}
VERBS: dict[str, Callable[[tf.Study], Any]] = {
    "compare": lambda study: study.compare(),
    "diagnose": lambda study: study.diagnose(),
    "sweep": lambda study: study.sweep({"drive.speed": ["10 mph", "20 mph"]}),
    "isolability": isolability,
    "plan": lambda study: study.plan(),
    "blind": lambda study: run_blind(study, 1, 1, Path("blind")),
    "export": lambda study: export(study, "tyre.npz"),
    "explore": lambda study: study.explore(),
    "press": press,
    "life": lambda study: study.life(),
    "strain laws": compare_laws,
}


@pytest.fixture
def campaign(here: Path) -> str:
    return str(write(here / "flights", measured=[FITTED, HELD_OUT], cases=True))


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_asks_for_one_case(
    name: str, campaign: str, refused: Callable[..., str], no_simulation: None
) -> None:
    words = refused(*(campaign if part == "STUDY" else part for part in COMMANDS[name]))
    assert f"{campaign}/study.toml: cases: the study is a campaign" in words
    assert "--case" in words
    assert words.rstrip().endswith("light, heavy")


def test_every_command_that_takes_a_study_takes_a_case() -> None:
    commands = typer.main.get_command(app).commands.items()  # type: ignore[attr-defined]
    of_studies = {
        name: command
        for name, command in commands
        if any((item.name, item.param_type_name) == ("study", "argument") for item in command.params)
    }
    assert set(of_studies) - {"run"} <= {parts[0] for parts in COMMANDS.values()}
    for name, command in of_studies.items():
        assert "case" in [item.name for item in command.params], name


@pytest.mark.parametrize("name", VERBS)
def test_a_verb_asks_for_one_case(name: str, campaign: str, here: Path, no_simulation: None) -> None:
    study = tf.study(campaign)
    before = sorted(here.rglob("*"))
    with pytest.raises(InputError, match=r"cases: the study is a campaign.*study\.case\(NAME\)"):
        VERBS[name](study)
    assert sorted(here.rglob("*")) == before


def test_a_case_by_name_is_the_campaign_s_own(campaign: str) -> None:
    study = tf.study(campaign)
    by_name = study.case("heavy")
    of_table = study.campaign().case_study(study.campaign().cases[1])
    assert (by_name.name, by_name.data) == (of_table.name, of_table.data)
    assert not by_name.is_campaign
    assert by_name.title == "heavy: as flown"


def test_changes_are_laid_over_the_case(campaign: str) -> None:
    assert tf.study(campaign, case="light").data["drive"]["load"] == "2000 lbf"
    assert tf.study(campaign, {"drive.load": "2500 lbf"}, "light").data["drive"]["load"] == "2500 lbf"


def test_another_table_of_cases_comes_before_its_case(campaign: str) -> None:
    Path(campaign, "others.csv").write_text("name,drive.speed [mph]\nslow,5\n", encoding="utf-8")
    assert tf.study(campaign, {"cases": "others.csv"}, "slow").data["drive"]["speed"] == "5 mph"


def test_a_wrong_case_says_the_nearest(campaign: str, refused: Callable[..., str]) -> None:
    words = refused("run", campaign, "--case", "hevy")
    assert f"{campaign}/cases.csv: no case 'hevy'; did you mean 'heavy'?" in words


def test_a_study_without_cases_has_no_case(here: Path, refused: Callable[..., str]) -> None:
    words = refused("run", str(write(here / "plain")), "--case", "light")
    assert "plain/study.toml: cases: the study has no 'cases' table" in words


def test_only_the_chosen_case_has_to_be_right(campaign: str) -> None:
    Path(campaign, "cases.csv").write_text("name,drive.load\nlight,2000 lbf\nheavy,nonsense\n", encoding="utf-8")
    assert tf.study(campaign).case("light").data["drive"]["load"] == "2000 lbf"
    with pytest.raises(InputError, match=r"cases\.csv: line 3, case 'heavy': drive\.load"):
        tf.study(campaign).case("heavy")


def test_run_takes_one_case_or_all(campaign: str, here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", campaign, "--case", "heavy", "--out", "one", *BRIEF]) == 0
    assert main(["run", campaign, "--out", "all", *BRIEF]) == 0
    capsys.readouterr()
    summary = json.loads((here / "one/summary.json").read_text(encoding="utf-8"))
    row = json.loads((here / "all/summary.json").read_text(encoding="utf-8"))["cases"][1]
    assert row["case"] == summary["study"] == "heavy"
    assert summary["hottest"]["temperature_degC"] == pytest.approx(row["hottest_degC"], abs=1e-9)


def test_a_sweep_file_names_its_case(campaign: str, here: Path, refused: Callable[..., str]) -> None:
    text = f'study = "{campaign}"\n"vary" = {{ "drive.speed" = ["10 mph", "20 mph"] }}\n'
    (here / "all.toml").write_text(text, encoding="utf-8")
    (here / "one.toml").write_text(f'case = "heavy"\n{text}', encoding="utf-8")
    assert "--case" in refused("check", "all.toml")
    assert loaded("one.toml").study.data["drive"]["load"] == "3300 lbf"
    assert loaded("all.toml", case="light").study.data["drive"]["load"] == "2000 lbf"


def test_a_sweep_of_a_campaign_takes_its_case(campaign: str) -> None:
    speeds = {"drive.speed": ["10 mph", "20 mph"]}
    swept = tf.study(campaign).sweep(speeds, case="heavy").table
    assert swept.equals(tf.study(campaign).case("heavy").sweep(speeds).table)


def test_show_prints_and_draws_one_case(
    campaign: str, here: Path, refused: Callable[..., str], capfd: pytest.CaptureFixture[str]
) -> None:
    assert main(["show", "study", campaign, "--case", "light"]) == 0
    assert 'load = "2000 lbf"' in capfd.readouterr().out
    assert main(["show", "strain", campaign, "--case", "light", "--out", "cycle.png"]) == 0
    assert "load_N                       8896.44" in capfd.readouterr().out
    assert "--case: is for study" in refused("show", "material", "nasa-tread", "--case", "light")


def test_a_campaign_run_as_a_whole_says_that_its_cases_are_left_out(campaign: str) -> None:
    result = tf.study(campaign, {"mesh.size": "15 mm", "drive.duration": "10 s"}).run()
    assert any("study.campaign()" in line for line in result.warnings)
