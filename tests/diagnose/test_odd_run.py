"""An effect that acts in one measured run only: named there, and told from the same effect in all runs."""

from __future__ import annotations

import html
import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from hidden import END, NOISE, RUNS, study

import tyrefem as tf
from tyrefem.api import DiagnosisRecord
from tyrefem.diagnose.diagnosis import DiagnosisData
from tyrefem.diagnose.fitting.selection import sets_of
from tyrefem.diagnose.forward.forward_model import FOLLOWED, ForwardModel
from tyrefem.diagnose.options import Method
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import SetPrior, catalogue_candidates, in_single_runs, separate
from tyrefem.diagnose.unknowns.unknown import base_unknowns
from tyrefem.diagnose.verdicts.verdict import UNEXPLAINED
from tyrefem.diagnose.words.sentences import verdict_words

COARSE = DiagnosisSettings(
    mesh_size="8 mm", largest=2, looks=2, heat_widths=(3.0,), discrepancy_sizes=(1.0,), beside_sets=2
)
HOT: dict[str, Any] = {"name": "hot-road", "warmer_by": "25 delta_degC"}
ODD = "loaded"


def measured(folder: Path, effects: list[dict[str, Any]]) -> tf.Study:
    """The study on a coarse mesh, with tables of readings that these effects and noise make."""
    owner = study(folder).replace({"mesh.size": "8 mm"})
    hidden = owner.replace({"mesh.size": "6 mm", "effects": effects, "measured": []})
    rng, times = np.random.default_rng(11), np.arange(0.0, END + 1.0, 3.0)
    for name, drive in RUNS.items():
        readings = hidden.at_run(name, drive).run().readings
        columns = {"time [s]": times}
        for sensor in owner.sensors:
            computed = np.interp(times, readings["time_s"], readings[sensor])
            columns[f"{sensor} [degC]"] = np.round(computed + NOISE * rng.normal(size=len(times)), 2)
        pd.DataFrame(columns).to_csv(folder / f"{name}.csv", index=False)
    return owner


@pytest.fixture(scope="module")
def owner(tmp_path_factory: pytest.TempPathFactory) -> tf.Study:
    return measured(tmp_path_factory.mktemp("odd"), [{**HOT, "runs": [ODD]}])


@pytest.fixture(scope="module")
def diagnosis(owner: tf.Study) -> DiagnosisData:
    return owner.diagnose(settings=COARSE)


def test_a_road_hot_in_one_run_is_named_in_that_run(diagnosis: DiagnosisData) -> None:
    assert diagnosis.verdict == "identified"
    assert [member.key for member in diagnosis.best.members] == [f"hot-road in {ODD}"]
    (member,) = diagnosis.best.members
    (amplitude,) = member.amplitudes
    assert diagnosis.best.values[amplitude] == pytest.approx(25.0, abs=4 * diagnosis.best.sd[amplitude])
    assert diagnosis.best.sd[amplitude] < 5.0
    assert verdict_words(diagnosis)[0].startswith(f"In run {ODD} only: The road is warmer than stated")
    # The held-out run has the stated road, and the amended study keeps it.
    assert diagnosis.rms(after=True, held_out=True) < 1.2 * NOISE
    assert [look.verdict for look in diagnosis.looks] == ["identified", "no gap"]


def test_without_single_runs_the_same_data_are_not_explained(owner: tf.Study) -> None:
    before = owner.diagnose(settings=replace(COARSE, odd_run_share=0.0, looks=1), rerun=False, verdict_only=True)
    assert not any(candidate.runs for candidate in before.candidates)
    assert before.verdict == UNEXPLAINED or len(before.best.members) > 1


def test_record_page_and_amended_study_state_the_run(diagnosis: DiagnosisData, tmp_path: Path) -> None:
    diagnosis.save(tmp_path)
    record = json.loads((tmp_path / "verdict.json").read_text(encoding="utf-8"))
    assert [(row["name"], row["variant"], row["runs"]) for row in record["effects"]] == [("hot-road", {}, [ODD])]
    assert {tuple(row["runs"] or ()) for row in record["candidates"] if row["name"] == "hot-road"} == {
        (), ("slow",), (ODD,),
    }  # fmt: skip
    assert all(row["runs"] is None for row in record["candidates"] if row["name"] == "sensor-offset")
    assert record["changes"][0]["runs"] == [ODD]
    assert f"In run {ODD} only: The road" in (tmp_path / "diagnosis.html").read_text(encoding="utf-8")
    amended = tf.study(tmp_path / record["amended_study"])
    assert amended.data["effects"][0]["runs"] == [ODD]
    assert "run" not in amended.data
    # What is known of it is a base number of the next look, in its run.
    (known,) = (unknown for unknown in base_unknowns(amended) if unknown.effect == "hot-road")
    assert known.runs == (ODD,)
    assert known.key == f"effects.hot-road.warmer_by in {ODD}"


def test_a_folder_gives_verdict_readings_and_amended_study_back(diagnosis: DiagnosisData, tmp_path: Path) -> None:
    diagnosis.save(tmp_path)
    back = tf.load(tmp_path)
    assert isinstance(back, DiagnosisRecord)
    assert back.verdict == diagnosis.verdict
    assert back.named == pytest.approx({f"hot-road in {ODD}": diagnosis.to_dict()["effects"][0]["probability"]})
    assert back.study is not None
    assert back.study.data["effects"] == diagnosis.study.data["effects"]
    assert back.rms["before"]["rms_K"] == pytest.approx(diagnosis.rms(after=False, held_out=False))
    assert back.noise == pytest.approx(diagnosis.noise)
    assert next(iter(back.sets)) == diagnosis.judgement.ranking[0].key
    assert (back.again is None) == (diagnosis.again is None or diagnosis.again.verdict == "no gap")
    # The amended study is nearer to the readings than the original.
    off = (back.readings["measured_degC"] - back.readings[name] for name in ("original_degC", "amended_degC"))
    before, after = (float((each**2).mean()) for each in off)
    assert after < 0.25 * before
    # Words and bars of its page are those of the diagnosis.
    assert repr(back).splitlines()[0] == f"DiagnosisRecord of {diagnosis.original.name}: {back.verdict}"
    page, again = diagnosis._repr_html_(), back._repr_html_()
    assert page is not None
    assert again is not None
    assert again.count("<rect") == page.count("<rect")
    assert back.headline[0] in html.unescape(again)


def test_a_road_hot_in_all_runs_is_named_in_all(tmp_path: Path) -> None:
    diagnosis = measured(tmp_path, [HOT]).diagnose(settings=replace(COARSE, looks=1), rerun=False, verdict_only=True)
    assert diagnosis.verdict == "identified"
    assert [member.key for member in diagnosis.best.members] == ["hot-road"]
    assert diagnosis.judgement.named["hot-road"] > 0.99


def test_sensitivities_are_those_of_all_runs_in_the_rows_of_the_run(diagnosis: DiagnosisData, owner: tf.Study) -> None:
    sensitive = diagnosis.gap.sensitivities
    odd = [unknown for unknown in sensitive.unknowns if unknown.runs]
    assert [unknown.runs for unknown in odd] == [("slow",), (ODD,)] * 2, "two effects of the day, two fitted runs"
    assert all(set(odd).isdisjoint(response.unknowns) for response in sensitive.responses), "nothing more is simulated"
    for unknown in odd:
        everywhere = sensitive.unknowns.index(unknown.everywhere)
        for drive, jacobian in zip(sensitive.drives, sensitive.jacobians, strict=True):
            column = jacobian[:, sensitive.unknowns.index(unknown)]
            expected = jacobian[:, everywhere] if drive.name in unknown.runs else np.zeros(len(column))
            np.testing.assert_array_equal(column, expected)
    # The forward model says the same by difference quotients, at any point, and so does a reduced model.
    model = ForwardModel(owner, sensitive.drives, settings=COARSE)
    (road,) = (unknown for unknown in odd if unknown.effect == "hot-road" and unknown.runs == (ODD,))
    at = {road: 20.0}
    for number, drive in enumerate(sensitive.drives):
        slopes = model.differences(number, [road], at)
        exact = model.jacobian(number, [road], at)
        status, reduced = model.reduced_jacobian(number, sensitive.responses[number].modes, [road], at)
        assert status[0] == FOLLOWED
        scale = np.abs(slopes).max()
        assert (scale > 0.1) == (drive.name == ODD), "K per K of the road, or nothing at all"
        np.testing.assert_allclose(exact, slopes, atol=0.02 * scale)
        np.testing.assert_allclose(reduced, slopes, atol=0.02 * scale)
        moved = model.predict(number, at) - model.predict(number, {})
        assert (np.abs(moved).max() > 1.0) == (drive.name == ODD)


def test_the_prior_pays_for_the_choice_of_the_run(owner: tf.Study) -> None:
    common = catalogue_candidates(owner)
    runs = ["a", "b", "c", "d"]
    odd = in_single_runs(owner, common, runs)
    assert {candidate.name for candidate in odd} == {"hot-road", "sun"}
    prior = SetPrior((*common, *odd), 0.5)
    road = [candidate for candidate in (*common, *odd) if candidate.name == "hot-road"]
    share = DEFAULT.odd_run_share
    assert prior((road[0],)) - prior((road[1],)) == pytest.approx(math.log((1 - share) / (share / len(runs))))
    # An effect is as probable as before; its prior is only divided.
    alone = SetPrior(common, 0.5)((road[0],))
    assert sum(math.exp(prior((form,))) for form in road) == pytest.approx(math.exp(alone))
    assert in_single_runs(owner, common, ["a"]) == (), "one run is all runs"


def test_a_set_has_an_effect_in_different_runs_but_not_beside_that_in_all(owner: tf.Study) -> None:
    common = [candidate for candidate in catalogue_candidates(owner) if candidate.name == "hot-road"]
    candidates = (*common, *in_single_runs(owner, common, ["a", "b"]))
    assert [[member.key for member in members] for members in sets_of(candidates, 2)] == [
        ["hot-road in a", "hot-road in b"]
    ]
    assert not separate(candidates[1], candidates[:1])
    assert not separate(candidates[1], [common[0].in_runs(["a", "b"])])


def test_candidates_that_the_study_has_in_a_run_are_not_tried_again(owner: tf.Study) -> None:
    amended = owner.replace({"effects": [{**HOT, "runs": ["slow"]}]})
    common = Method().candidates(amended)
    assert "hot-road" in {candidate.key for candidate in common}
    assert {candidate.key for candidate in in_single_runs(amended, common, ["slow", ODD])} == {
        f"hot-road in {ODD}", "sun in slow", f"sun in {ODD}",
    }  # fmt: skip


@pytest.mark.parametrize("share", [-0.1, 1.0])
def test_the_share_of_single_runs_is_a_probability(share: float) -> None:
    with pytest.raises(tf.InputError, match="odd_run_share must be at least 0 and less than 1"):
        DiagnosisSettings(odd_run_share=share)
