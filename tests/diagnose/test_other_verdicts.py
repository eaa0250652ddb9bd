"""The page and the record of verdicts other than "identified", drawn from one diagnosis judged otherwise."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from formula import case as formula_case
from formula import effect
from hidden import Case
from made_up import confounded, judged, unexplained

from tyrefem.diagnose.fitting.criterion import LogEvidence
from tyrefem.diagnose.fitting.selection import ScoredSet, SelectionProblem
from tyrefem.diagnose.unknowns.candidates import SetPrior
from tyrefem.diagnose.verdicts.verdict import (
    CONFOUNDED,
    IDENTIFIED,
    NO_GAP,
    UNEXPLAINED,
    RankedSet,
    judge,
    ranked,
)
from tyrefem.diagnose.words.effects import effect_words
from tyrefem.diagnose.words.heat import NOT_CLEAR
from tyrefem.diagnose.words.result_tables import competing_sets, inclusion_probability
from tyrefem.diagnose.words.sentences import verdict_words


def test_confounded_names_the_rivals_and_what_would_decide(case: Case, tmp_path: Path) -> None:
    d = confounded(case.diagnosis)
    # The hot road with an idle effect beside it is no rival of the hot road, but speaks for it.
    assert [unknown.key for unknown in competing_sets(d)] == ["hot-road", "sun"]
    assert inclusion_probability(d, competing_sets(d)[0]) == pytest.approx(0.74)
    d.save(tmp_path)
    record = json.loads((tmp_path / "verdict.json").read_text(encoding="utf-8"))
    rivals = {row["name"]: row["confounded_with"] for row in record["candidates"] if row["runs"] is None}
    assert rivals["hot-road"] == ["sun"]
    assert rivals["sun"] == ["hot-road"]
    assert rivals["sensor-offset"] == []
    assert record["next_experiment"]["sensors"][0]["largest_K"] == 2.5
    assert [unknown["name"] for unknown in record["effects"]] == ["hot-road"]
    words = " ".join(verdict_words(d))
    assert "cannot show which: hot-road (74 %), or sun (25 %)" in words
    assert "A thermocouple at s = 0 mm, outside" in words
    assert "twice the speed" not in words
    page = (tmp_path / "diagnosis.html").read_text(encoding="utf-8")
    assert words.split(". ")[0] in page
    assert not (tmp_path / "missing-heat.png").exists()


def test_unexplained_draws_the_missing_heat_and_names_nothing(case: Case, tmp_path: Path) -> None:
    d = case.diagnosis
    outside = RankedSet((), 0.0, 0.97, None, outside=True)
    judged = replace(
        d.judgement, verdict=UNEXPLAINED, ranking=(outside, *d.judgement.ranking), credible=(outside,), named={}
    )
    missing = replace(
        d.missing, flux=np.full_like(d.missing.flux, 10.0), flux_sd=np.full_like(d.missing.flux, 50.0),
        heat=np.full_like(d.missing.heat, 2e4), heat_sd=np.full_like(d.missing.heat, 1e3),
        station=float(d.missing.stations[0]), region="tread",
    )  # fmt: skip
    d = replace(d, judgement=judged, missing=missing, best=d.null)
    d.save(tmp_path)
    record = json.loads((tmp_path / "verdict.json").read_text(encoding="utf-8"))
    assert record["effects"] == []
    assert record["missing_heat"]["kind"] == "heat"
    assert len(record["missing_heat"]["runs"]) == 2
    assert record["missing_heat"]["runs"][0]["heat_W_m3"] == [2e4] * len(missing.stations)
    words = verdict_words(d)
    assert words[0] == "No effect in the catalogue explains the deviation."
    # The patch fills the thickness, so no layer is named.
    assert words[1].startswith("Heat is missing in the crown (s = ")
    assert "all layers: +20.0 ± 1.0 kW/m³, while the tyre rolls" in words[1]
    assert "tread" not in words[1]
    sink = replace(d, missing=replace(missing, heat=-missing.heat))
    assert verdict_words(sink)[1].startswith("The model has too much heat, cooling is missing, in the crown")
    weak = replace(d, missing=replace(missing, heat=missing.heat_sd * 1.9))
    assert verdict_words(weak)[1] == f"{NOT_CLEAR}."
    for name in ("missing-heat.png", "missing-heat-stations.png"):
        assert (tmp_path / name).stat().st_size > 10_000


@pytest.mark.parametrize("verdict", [IDENTIFIED, CONFOUNDED, UNEXPLAINED, NO_GAP])
def test_what_stands_behind_the_verdict_does_not_begin_with_it_again(verdict: str, case: Case) -> None:
    d = replace(case.diagnosis, judgement=replace(case.diagnosis.judgement, verdict=verdict))
    assert not verdict_words(d)[0].lower().startswith(verdict)


def test_the_certain_member_of_a_set_is_stated_first(case: Case) -> None:
    sets = {("hot-road", "sun"): 0.54, ("hot-road",): 0.45, ("sun",): 0.01}
    first = verdict_words(judged(case.diagnosis, CONFOUNDED, sets))[0]
    assert first.startswith("The road is warmer than stated")
    assert "99.0 % probable" in first
    assert first.endswith("cannot show whether it acts alone (probability 45 %) or with sun (55 %).")
    assert "cannot show which" not in first


def test_a_doubt_stands_beside_what_the_fitted_runs_say(case: Case) -> None:
    doubt = "Sun predicts the held-out runs better than hot-road, by 45 nats."
    d = judged(case.diagnosis, CONFOUNDED, {("hot-road",): 0.999, ("sun",): 0.001}, doubts=(doubt,))
    first, second, *_ = verdict_words(d)
    assert first.startswith("The fitted runs alone speak for hot-road (99.9 %), but this is not certain")
    assert second == doubt


def test_a_colder_road_is_said_to_be_colder(case: Case) -> None:
    d = case.diagnosis
    (member,) = d.best.members
    assert effect_words(d, member).startswith("The road is warmer than stated")
    mean = d.best.posterior.mean.copy()
    mean[d.best.unknowns.index(member.amplitudes[0])] *= -1
    colder = replace(d.best, posterior=replace(d.best.posterior, mean=mean))
    assert effect_words(replace(d, best=colder), member).startswith("The road is colder than stated (")


def test_unexplained_says_what_the_amended_study_has_and_what_to_do_next(case: Case) -> None:
    words = verdict_words(unexplained(case.diagnosis, 1e3))
    assert "The amended study has an entry of missing heat, which describe" in " ".join(words)
    assert any(sentence.startswith("In the amended study the rms") for sentence in words)
    worst = case.diagnosis.where.sort_values("sigma", ascending=False).iloc[0]
    assert words[-2].startswith(f"Next: check {worst['sensor']} in run {worst['run']},")
    assert "docs/effects.md" in words[-1]


def test_a_bound_is_named_by_effect_and_parameter() -> None:
    """Not by the raw key effects.radiation.emissivity."""
    T = np.linspace(0.0, 1.0, 60)
    bounded = effect("radiation", sd=0.5, low=0.0)
    made = formula_case(lambda values: 5.0 * T * values.get("radiation", 0.0), -0.7 * T, (bounded,))
    prior = SetPrior((bounded,), 0.5)
    problem = SelectionProblem(made.residuals, made.predictions, (bounded,), prior, LogEvidence())
    fits = problem.continued(problem.fitted([(bounded,)], {}))
    judgement = judge(ranked([ScoredSet(0.0, (bounded,), fits[0])]), lambda members: None)
    assert judgement.verdict == CONFOUNDED
    assert judgement.reasons == ("the best value lies beyond a physical bound: radiation (size)",)
