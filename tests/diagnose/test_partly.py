"""A hot road in data of another strain energy: part of the cause is named, and the rest is told."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hidden import COARSE, COARSE_MESH, FINER_MESH, WARMER, measure, study

import tyrefem as tf
from tyrefem.diagnose import DiagnosisData
from tyrefem.diagnose.verdicts.prior_sensitivity import FACTORS, PROBABILITY
from tyrefem.diagnose.verdicts.verdict import PARTLY
from tyrefem.diagnose.words.headline import headline
from tyrefem.diagnose.words.missing_heat import missing_heat_words
from tyrefem.diagnose.words.sentences import verdict_words
from tyrefem.reports.diagnosis_missing import tells_missing_heat

#: Half waves of ln(heat) along the meridian: up to 65 % more heat at the crown, less at the sidewall.
SHAPE = {1: 0.3, 2: 0.2}


@pytest.fixture(scope="module")
def hidden(tmp_path_factory: pytest.TempPathFactory) -> tuple[DiagnosisData, Path]:
    folder = tmp_path_factory.mktemp("partly")
    owner = study(folder / "study", COARSE_MESH)
    # Exact base numbers and sensors cannot imitate the strain energy.
    sure = {f"sensors.{name}.{key}": value for name in owner.sensors for key, value in SURE.items()}
    numbers = ("loss_tangent", "conductivity", "specific_heat")
    cards = {f"materials.{name}.{key}.value": "2 %" for name in owner.materials for key in numbers}
    changes = sure | {"uncertainty": cards, "diagnosis.film_sd": 0.02}
    owner = tf.study(owner.replace(changes).save(folder / "study" / "sure.toml"))
    shapes = [{"name": "heat-shape", "half_waves": n, "log_factor": x} for n, x in SHAPE.items()]
    measure(owner, [{"name": "hot-road", "warmer_by": f"{WARMER} delta_degC"}, *shapes], FINER_MESH)
    diagnosis = owner.diagnose(settings=COARSE)
    diagnosis.save(folder / "out")
    return diagnosis, folder / "out"


SURE = {"position_sd": "0.1 mm", "accuracy": "0.2 delta_degC", "lag_sd": "0.2 s"}


def test_the_hot_road_is_part_of_the_cause(hidden: tuple[DiagnosisData, Path]) -> None:
    d, _ = hidden
    assert d.verdict == PARTLY
    assert [member.name for member in d.best.members] == ["hot-road"]
    low, high = d.robustness.interval(d.best.members[0].amplitudes[0])
    assert low < WARMER < high
    assert {model.name for model in d.robustness.laws} == {"strain law barrel", "strain law fem"}
    assert d.robustness.untried == ()


def test_words_and_record_tell_what_else_is_wrong(hidden: tuple[DiagnosisData, Path]) -> None:
    d, folder = hidden
    words = verdict_words(d)
    assert words[0].startswith("The road is warmer than stated")
    assert "part of the cause, whatever else is wrong" in words[0]
    assert "more heat in the crown" in words[1]
    assert "the strain law barrel" in words[2]
    assert "The road is warmer" in headline(d)[0]
    record = json.loads((folder / "verdict.json").read_text(encoding="utf-8"))
    assert record["verdict"] == "partly identified"
    assert [effect["name"] for effect in record["effects"]] == ["hot-road"]
    assert json.loads((folder / "posterior.json").read_text(encoding="utf-8"))["part"] == ["hot-road"]
    names = [row["name"] for row in record["discrepancies"]]
    assert names[0] == "strain energy"
    assert {"none", "missing heat", "strain law barrel", "strain law fem"} <= set(names)
    assert record["discrepancies"][0]["effects"]["hot-road"] >= 0.9
    assert 0 < record["confidence"] <= record["effects"][0]["probability"] <= 1
    assert record["confidence"] == record["effects"][0]["confidence"]
    # A probability is never rounded to 100 %.
    assert not [reason for reason in record["reasons"] if "100 %" in reason or "100.0 %" in reason]
    # Excluded models are told.
    counted = [model.words for model in d.robustness.counted]
    for model in (*d.robustness.models, *d.robustness.laws):
        if model.words not in counted:
            assert model.words in words[2].split("not counted, as the data exclude")[1]


def test_what_is_left_is_drawn_and_has_a_law_where_it_is_clear(hidden: tuple[DiagnosisData, Path]) -> None:
    d, folder = hidden
    text = (folder / "diagnosis.html").read_text(encoding="utf-8")
    assert tells_missing_heat(d) is bool(d.missing.over_time is not None and d.missing.over_time.clear)
    assert (folder / "missing-heat-course.png").is_file() is tells_missing_heat(d)
    assert ("<h2>Heat of unknown origin</h2>" in text) is tells_missing_heat(d)
    laws = missing_heat_words(d)
    assert bool(laws) is (d.law is not None)
    assert all(sentence in verdict_words(d) for sentence in laws)
    if d.law is not None and d.law.holds:
        assert laws[0].startswith("The heat that is missing beside it has a law over these runs: ")
        (file,) = (folder / "effects").glob("inferred_*.py")
        assert any(f"effects/{file.name}" in sentence for sentence in verdict_words(d))


def test_priors_of_the_named_effect_are_tried(hidden: tuple[DiagnosisData, Path]) -> None:
    d, _ = hidden
    tried = {(change.prior, change.factor) for change in d.prior_sensitivity if change.effect == "hot-road"}
    assert tried >= {(PROBABILITY, factor) for factor in FACTORS}
    for change in d.prior_sensitivity:
        if not change.decides:
            assert (change.verdict, change.best) == (PARTLY, "hot-road")
    # A third of the odds of the weakest model is a third there; forms of the effect in single runs, which are less
    # probable too, give some of it back.
    least = min(d.robustness.least("hot-road"), 1 - 1e-12)
    weaker = next(
        change
        for change in d.prior_sensitivity
        if (change.effect, change.prior, change.factor) == ("hot-road", PROBABILITY, FACTORS[0])
    )
    if not weaker.decides:
        odds = least / (1 - least)
        assert 0.999 * odds / 3 < weaker.share / (1 - weaker.share) < 0.999 * odds


def test_the_amended_study_has_the_effect_and_the_strain_energy(hidden: tuple[DiagnosisData, Path]) -> None:
    d, folder = hidden
    amended = tf.study(folder / "amended.toml")
    assert {effect.name for effect in amended.effects} == {"hot-road", "heat-shape"}
    assert d.rms(after=True, held_out=True) < 0.4 * d.rms(after=False, held_out=True)
