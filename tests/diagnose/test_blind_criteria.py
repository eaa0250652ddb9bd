"""Rates and failures of structural blind tests, on made-up outcomes; one coarse test from the command to the files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import hidden
import pytest
from typer.testing import CliRunner

import tyrefem as tf
from tyrefem.cli.commands import app
from tyrefem.diagnose.blind.blind_case import STRUCTURAL
from tyrefem.diagnose.blind.criteria import Rate, acting, failures, in_set, right
from tyrefem.diagnose.blind.rates import Blind, run_blind
from tyrefem.errors import InputError
from tyrefem.reports.blind import picture, save

FILMS = {"outside-film-speed": 0.2, "road-film-speed": 0.3}


def row(kind: str, hidden: list[str], verdict: str, named: list[str], **more: Any) -> dict[str, Any]:
    """A made-up case of structural data."""
    return {
        "number": 0, "kind": kind, "hidden": hidden, "verdict": verdict, "named": named, "set": named or ["no effect"],
        "identifiable": kind in ("one", "two"), "amplitude": dict.fromkeys(hidden, 2.0), "probability": 0.97,
        "best": " + ".join(named) or "no effect", "held_out_rms_K": {"before": 4.0, "after": 0.55}, "noise_K": 0.5,
        "rms_K": {"before": 4.0, "after": 0.6}, "missing_station_m": 0.1, "station_m": 0.1, "length_m": 0.15,
        "other_model": {"strain_law": None, "film_speed_exponents": FILMS}, "reasons": ["the reason"],
        "leading": [["sun", 0.97]],
    } | more  # fmt: skip


BARREL = {"other_model": {"strain_law": "barrel", "film_speed_exponents": FILMS}}
ROWS = (
    row("one", ["sun"], "partly identified", ["sun"]),
    row("one", ["sun"], "identified", ["leak", "sun"]),
    row("one", ["sun"], "unexplained", [], set=["not in the catalogue"], **BARREL),
    row("one", ["sun"], "confounded", [], set=["sun", "leak"]),
    row("one", ["sun"], "identified", ["outside-film-speed", "sun"]),
    row("one", ["leak"], "identified", ["leak"], identifiable=False),
    row("two", ["leak", "sun"], "partly identified", ["sun"]),
    row("none", [], "unexplained", [], set=["not in the catalogue"]),
    row("none", [], "identified", ["road-film-speed"]),
    row("none", [], "identified", ["leak"]),
    row("outside", ["stranger"], "unexplained", [], **BARREL),
    row("outside", ["stranger"], "partly identified", ["sun"], **BARREL),
)


def test_structural_rates_count_what_they_say() -> None:
    rates = Blind("s", 1, ROWS, data_model=STRUCTURAL).rates
    counts = {name: (rate.right, rate.of) for name, rate in rates.items()}
    # Of six identifiable cases: unexplained has nothing in its set, and the pair lacks one member.
    assert counts["identifiable: all hidden effects in the reported set"] == (4, 6)
    assert counts["identifiable: all hidden effects named or partly identified"] == (3, 6)
    assert counts["identifiable: some hidden effect named"] == (4, 6)
    # "leak" beside the sun, "leak" where nothing is hidden, and "sun" beside a cause outside the catalogue.
    assert counts["all cases: confident wrong name"] == (3, 12)
    assert counts["nothing hidden: no effect named"] == (2, 3)
    assert counts["nothing hidden: nothing named, not even a film"] == (1, 3)
    assert counts["outside the catalogue: no effect named"] == (1, 2)
    assert counts["another strain law: confident wrong name"] == (1, 3)
    assert counts["energy by modes, identifiable: all named"] == (3, 5)
    goals = {name: rate.wanted for name, rate in rates.items() if rate.wanted}
    assert list(goals.values()) == ["at least 95 %", "at least 70 %", "at most 2 %", "at least 97 %"]


def test_failures_state_what_was_hidden_and_what_was_said() -> None:
    listed = failures(ROWS)
    faults = [(entry["hidden"], entry["fault"]) for entry in listed]
    assert faults == [
        (["sun"], "named, but not hidden: leak"),
        (["sun"], "a hidden effect is not in the reported set"),
        (["sun"], "a hidden effect is not named"),
        (["leak", "sun"], "a hidden effect is not in the reported set"),
        ([], "named, but not hidden: leak"),
        (["stranger"], "named, but not hidden: sun"),
    ]
    assert listed[0]["why"] == "rms 0.60 K after the fit, noise 0.50 K; the reason"
    assert listed[0]["leading"] == [["sun", 0.97]]
    assert listed[1]["other_model"]["strain_law"] == "barrel"


def test_partly_identified_names_its_members() -> None:
    partly = row("one", ["sun"], "partly identified", ["sun"])
    del partly["other_model"]
    rates = Blind("s", 1, (partly,)).rates
    assert (rates["identifiable: named correctly"].right, rates["verdicts 'identified': right"].right) == (1, 1)
    assert right(partly)
    assert in_set(partly)
    assert acting(partly) == {"sun"}
    # A verdict that names nothing has no names, whatever its best set is.
    assert not right(partly | {"verdict": "confounded"})


def test_a_diagnosis_that_failed_is_listed_with_its_reason() -> None:
    failed = row("one", ["sun"], "failed", [], rms_K={}, set=[], reason="no such load")
    assert failures([failed])[0]["fault"] == "the diagnosis failed: no such load"


def test_goals_stand_beside_the_rates() -> None:
    result = Blind("s", 1, ROWS, data_model=STRUCTURAL)
    first = result.words()[0]
    assert first.startswith("identifiable: all hidden effects in the reported set")
    assert first.endswith("wanted: at least 95 %")
    assert result.to_dict()["rates"]["all cases: confident wrong name"]["goal_is"] == "at most"
    assert Rate(1, 2).wanted == ""
    assert picture(result).axes


def test_a_wrong_name_of_the_model_is_one_error() -> None:
    answer = CliRunner().invoke(app, ["blind", "hidden-effect", "--truth", "structrual"])
    assert isinstance(answer.exception, InputError)
    assert str(answer.exception).startswith("--truth: 'structrual'")
    assert "did you mean 'structural'?" in str(answer.exception)
    with pytest.raises(InputError, match="ordinary, structural"):
        run_blind(tf.study("hidden-effect"), 1, 1, Path("unused"), truth="odd")
    with pytest.raises(TypeError, match="did you mean 'truth'"):
        run_blind(tf.study("hidden-effect"), 1, 1, Path("unused"), trut="structural")  # type: ignore[call-arg]


def test_structural_cases_from_data_to_record(tmp_path: Path) -> None:
    written = hidden.study(tmp_path / "study")
    study = written.replace({"mesh.size": "8 mm", "measured": written.data["measured"][:1]})
    mesh = {"mesh.size": "8 mm", "mesh.element": "P1"}
    first = run_blind(study, 1, 4, tmp_path, mesh=mesh, truth=STRUCTURAL)
    again = run_blind(study, 1, 4, tmp_path, mesh=mesh, truth=STRUCTURAL)
    assert len(list((tmp_path / "cases").glob("*.json"))) == 1, "a finished case is not run again"
    assert again.rows == first.rows
    save(first, tmp_path)
    record = json.loads((tmp_path / "blind.json").read_text(encoding="utf-8"))
    assert record["truth"] == "structural"
    assert record["mesh_of_the_truth"] == mesh
    case = record["cases"][0]
    assert case["verdict"] != "failed"
    assert case["other_model"]["mesh"] == mesh
    assert set(case["other_model"]["gauges"]) == set(study.section.regions)
    assert case["leading"][0][0] == case["best"]
