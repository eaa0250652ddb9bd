"""A catalogue of sizes as a campaign: a size that gives no section is a row with its reason."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData
from tyrefem.reports.campaign import bars
from tyrefem.sweep.campaign import CampaignData

STUDY = """
title = "sizes"
cases = "cases.csv"
section = { size = "22x5.5 8PR" }
[materials]
[drive]
speed = "20 mph"
load = "4350 lbf"
pressure = "135 psi"
duration = "20 s"
ambient = "25 degC"
[mesh]
size = "12 mm"
[mechanics]
strain = "barrel"
"""
HEAD = "name,section.size,section.rim_width [in],section.parameters.tread_width [mm],drive.pressure [psi],note\n"


def campaign(folder: Path, *rows: str) -> CampaignData:
    (folder / "study.toml").write_text(STUDY, encoding="utf-8")
    (folder / "cases.csv").write_text(HEAD + "\n".join(rows) + "\n", encoding="utf-8")
    return CampaignData.of(StudyData.load(folder))


def test_rows_without_a_section_say_why_and_the_others_run(tmp_path: Path) -> None:
    cases = campaign(
        tmp_path,
        "good,22x5.5 8PR,4.25,105,135,",
        "odd,22y5.5 8PR,4.25,105,135,",
        "narrow,22x5.5 8PR,2,105,135,",
        "wide,22x5.5 8PR,4.25,500 ,135,",
        "last,22x5.5 10PR,4.25,105,135,",
    )
    outcomes = {case.name: outcome for case, outcome in cases.runs()}
    assert list(outcomes) == ["good", "odd", "narrow", "wide", "last"]
    failures = {name: outcome for name, outcome in outcomes.items() if isinstance(outcome, str)}
    assert set(failures) == {"odd", "narrow", "wide"}
    assert "'22y5.5 8PR' is no tyre size; did you mean" in failures["odd"]
    assert "2 in is too narrow for 22x5.5 8PR; allowed: 3.59 to 4.91 in" in failures["narrow"]
    assert "tread_width" in failures["wide"]


def test_other_mistakes_in_a_row_stop_before_anything_runs(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"line 3, case 'low': drive\.pressure"):
        campaign(tmp_path, "good,22x5.5 8PR,4.25,105,135,", "low,22x5.5 8PR,4.25,105,-5,")


@pytest.mark.parametrize(("tyres", "legend"), [(8, True), (9, False)])
def test_the_picture_tells_tyres_apart_while_its_legend_has_room(tyres: int, legend: bool) -> None:
    done = pd.DataFrame(
        {
            "case": [f"case-{i}" for i in range(tyres)],
            "section": [f"tyre {i}" for i in range(tyres)],
            "pressure_Pa": 9e5,
            "hottest_degC": [60.0 + i for i in range(tyres)],
        }
    )
    (axes,) = bars(done, "hottest_degC").axes
    assert (axes.get_legend() is not None) is legend
    colors = {line.get_color() for line in axes.lines if line.get_marker() not in ("None", None)}
    assert (len(colors) > 1) is legend
