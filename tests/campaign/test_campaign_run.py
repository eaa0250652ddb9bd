"""A campaign: each case is the study with its row laid over it; what fails is named and stops nothing."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pandas as pd
import pytest

import tyrefem as tf
from tyrefem.api import Study
from tyrefem.cli import main
from tyrefem.cli.run import _tell_campaign
from tyrefem.errors import InputError
from tyrefem.reports.campaign import bars, run_campaign, write_campaign_report
from tyrefem.sweep import campaign as campaigns
from tyrefem.sweep.campaign import CampaignData


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_each_case_is_the_study_with_its_row(folder: Path, campaign: CampaignData) -> None:
    table = run_campaign(campaign, folder / "out")
    assert list(table["case"]) == ["light", "usual", "crushed"]
    data = {key: value for key, value in campaign.study.data.items() if key != "cases"}
    alone = tf.Study("alone", data, folder=folder).replace({"drive.load": "2700 lbf", "drive.pressure": "83 psi"}).run()
    usual = table.set_index("case").loc["usual"]
    peak = alone.extremes.iloc[0]
    assert usual["hottest_degC"] == pytest.approx(peak["temperature_degC"], abs=1e-9)
    assert usual["load_N"] == pytest.approx(2700 * 4.4482216, rel=1e-6)
    assert usual["rolling_resistance_N"] == pytest.approx(alone.rolling_resistance.force, rel=1e-9)
    assert usual["rolling_resistance_coefficient"] == pytest.approx(usual["rolling_resistance_N"] / usual["load_N"])
    assert usual["crown-inner_degC"] == pytest.approx(float(alone.readings["crown-inner"].iloc[-1]))
    assert usual[f"{usual['hottest_region']}_max_degC"] == pytest.approx(usual["hottest_degC"])
    # More load, more deflection, more heat.
    light = table.set_index("case").loc["light"]
    assert light["deflection_m"] < usual["deflection_m"]
    assert light["rolling_resistance_N"] < usual["rolling_resistance_N"]


def test_a_failing_case_is_named_and_the_others_go_on(folder: Path, campaign: CampaignData) -> None:
    # The case that cannot be is put first: what follows must still be run.
    turned = replace(campaign, cases=campaign.cases[::-1])
    table = run_campaign(turned, folder / "out")
    written = rows_of(folder / "out/campaign.csv")
    assert [row["case"] for row in written] == ["crushed", "usual", "light"]
    assert [bool(row["failure"]) for row in written] == [True, False, False]
    assert written[0]["hottest_degC"] == ""
    assert float(written[1]["hottest_degC"]) == pytest.approx(table["hottest_degC"][1], abs=1e-3)
    summary = json.loads((folder / "out/summary.json").read_text(encoding="utf-8"))
    assert summary["complete"] is True
    assert summary["failed"] == ["crushed"]
    assert not (folder / "out/cases/crushed").exists()
    assert (folder / "out/cases/usual/readings.csv").is_file()


def test_a_defect_in_one_case_is_called_that(
    campaign: CampaignData, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = campaigns.run

    def sometimes(study: Study, progress: Any = None, **how: Any) -> Any:
        if study.name == "light":
            raise ZeroDivisionError("float division by zero")
        return run(study, progress, **how)

    monkeypatch.setattr(campaigns, "run", sometimes)
    table = run_campaign(campaign, folder / "out")
    assert table["failure"][0] == "defect, please report: ZeroDivisionError: float division by zero"
    assert table["failure"][1] == ""


def test_the_name_of_a_case_is_no_case(campaign: CampaignData) -> None:
    """It had been taken for a failed run: "defect, please report: AttributeError"."""
    name: Any = campaign.cases[0].name
    for method in (campaign.outcome, campaign.case_study):
        with pytest.raises(InputError, match=r"case: must be one of the campaign's cases, not '.*'; study\.case\(NAME"):
            method(name)
    assert campaign.study.case(name).name == name


def test_an_interrupted_campaign_keeps_what_is_finished(
    campaign: CampaignData, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = campaigns.run

    def stop(time: float) -> None:
        if time > 5.0:
            raise KeyboardInterrupt

    def second_is_stopped(study: Study, progress: Any = None, **how: Any) -> Any:
        return run(study, stop if study.name == "usual" else progress, **how)

    monkeypatch.setattr(campaigns, "run", second_is_stopped)
    with pytest.raises(KeyboardInterrupt):
        run_campaign(campaign, folder / "out")
    written = rows_of(folder / "out/campaign.csv")
    assert [row["case"] for row in written] == ["light", "usual"]
    assert written[0]["failure"] == ""
    assert re.fullmatch(r"interrupted at [\d.]+ s", written[1]["failure"])
    assert json.loads((folder / "out/summary.json").read_text(encoding="utf-8"))["complete"] is False
    assert json.loads((folder / "out/cases/usual/summary.json").read_text(encoding="utf-8"))["complete"] is False


def test_an_older_table_does_not_pass_for_this_one(
    campaign: CampaignData, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "out").mkdir()
    (folder / "out/campaign.csv").write_text("case,failure\nold,\n", encoding="utf-8")

    def stopped(_study: Study, _progress: Any = None, **_how: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(campaigns, "run", stopped)
    with pytest.raises(KeyboardInterrupt):
        run_campaign(campaign, folder / "out")
    assert rows_of(folder / "out/campaign.csv") == []
    assert json.loads((folder / "out/summary.json").read_text(encoding="utf-8"))["complete"] is False


def test_page_stands_alone_and_names_the_failed(campaign: CampaignData, folder: Path) -> None:
    table = run_campaign(campaign, folder / "out")
    page = write_campaign_report(campaign, table, folder / "out/report.html").read_text(encoding="utf-8")
    assert "<h1>Three &lt;loads&gt;</h1>" in page
    assert page.count('src="data:image/png;base64,') == 2
    assert not re.search(r'(src|href)="(?!data:)|<script[^>]|@import', page)
    assert page.count("<script>") == 1
    assert "2 of 3 cases finished. Hottest: " in page
    assert table["failure"][2].split(":")[-1].strip() in page.replace("&#39;", "'").replace("&#34;", '"')


def test_the_resistance_of_a_schedule_is_of_the_phase_that_is_named(folder: Path) -> None:
    phases = [
        {"name": "roll", "speed": "20 mph", "duration": "20 s"},
        {"name": "stand", "speed": "0 mph", "duration": "20 s"},
    ]
    study = tf.study(folder).replace({"drive.phases": phases})
    table = run_campaign(replace(study.campaign(), cases=study.cases[:2]), folder / "out")
    usual = table.set_index("case").loc["usual"]
    assert usual["speed_m_s"] == 0
    assert usual["rolling_resistance_phase"] == "roll"
    assert usual["rolling_resistance_N"] > 0
    page = write_campaign_report(study.campaign(), table, folder / "out/report.html").read_text(encoding="utf-8")
    assert "at the end of its drive" not in page
    assert page.count("rolling phase with most heat") == 3


def test_page_of_nothing_but_failures(campaign: CampaignData, folder: Path) -> None:
    table = run_campaign(replace(campaign, cases=campaign.cases[2:]), folder / "out")
    page = write_campaign_report(campaign, table, folder / "report.html").read_text(encoding="utf-8")
    assert "0 of 3 cases finished." in page
    assert "<img" not in page


@pytest.mark.parametrize(("names", "words"), [(["a"], "1 case, 0 failed"), (["a", "b"], "2 cases, 0 failed")])
def test_cases_are_counted(names: list[str], words: str, capsys: pytest.CaptureFixture[str]) -> None:
    table = pd.DataFrame({"case": names, "hottest_degC": 80.0, "failure": ""})
    _tell_campaign(SimpleNamespace(study=SimpleNamespace(name="a", title="A")), table, Path("out"), False)  # type: ignore[arg-type]
    assert f"{words}; table in" in capsys.readouterr().out


def test_command_line(folder: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(folder)
    assert main(["run", ".", "--no-vtk", "--out", "out"]) == 1
    out, err = capfd.readouterr()
    assert "3 cases, 1 failed" in out
    # Every case has been tried: nothing is left to do.
    assert json.loads((folder / "out/summary.json").read_text(encoding="utf-8"))["complete"] is True
    assert err.startswith("tyrefem: case crushed: ")
    assert err.count("\n") == 1
    page = (folder / "out/report.html").read_text(encoding="utf-8")
    assert '<a href="cases/usual/report.html">usual</a>' in page
    assert (folder / "out/cases/usual/report.html").is_file()
    assert main(["run", ".", "--no-vtk", "--no-pictures", "--out", "bare", "--json"]) == 1
    out, err = capfd.readouterr()
    assert [case["case"] for case in json.loads(out)["cases"]] == ["light", "usual", "crushed"]
    assert json.loads(out)["cases"][2]["hottest_degC"] is None
    assert not (folder / "bare/report.html").exists()


def test_cases_that_all_stand_have_a_picture_of_their_resistance() -> None:
    """An axis from 0 to 0 would be a warning."""
    columns = {"pressure_Pa": 5e5, "load_N": 1e4, "hottest_degC": 0.0, "rolling_resistance_coefficient": 0.0}
    done = pd.DataFrame([{"case": name, "section": "tyre", **columns} for name in ("a", "b")])
    for column in ("hottest_degC", "rolling_resistance_coefficient"):
        low, high = bars(done, column).axes[0].get_xlim()
        assert low < 0 < high
