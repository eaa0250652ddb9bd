"""A hot road in data of another strain energy: part of the cause is named, and the rest is told."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hidden import WARMER, measure, study

import tyrefem as tf
from tyrefem.diagnose import DiagnosisData
from tyrefem.diagnose.headline import headline
from tyrefem.diagnose.verdict import PARTLY
from tyrefem.diagnose.words import verdict_words

#: Half waves of ln(heat) along the meridian: up to 65 % more heat at the crown, less at the sidewall.
SHAPE = {1: 0.3, 2: 0.2}


@pytest.fixture(scope="module")
def hidden(tmp_path_factory: pytest.TempPathFactory) -> tuple[DiagnosisData, Path]:
    folder = tmp_path_factory.mktemp("partly")
    owner = study(folder / "study")
    # Exact base numbers and sensors cannot imitate the strain energy.
    sure = {f"sensors.{name}.{key}": value for name in owner.sensors for key, value in SURE.items()}
    numbers = ("loss_tangent", "conductivity", "specific_heat")
    cards = {f"materials.{name}.{key}.value": "2 %" for name in owner.materials for key in numbers}
    changes = sure | {"uncertainty": cards, "diagnosis.film_sd": 0.02}
    owner = tf.study(owner.replace(changes).save(folder / "study" / "sure.toml"))
    shapes = [{"name": "heat-shape", "half_waves": n, "log_factor": x} for n, x in SHAPE.items()]
    measure(owner, [{"name": "hot-road", "warmer_by": f"{WARMER} delta_degC"}, *shapes])
    diagnosis = owner.diagnose(largest=1, looks=1)
    diagnosis.save(folder / "out")
    return diagnosis, folder / "out"


SURE = {"position_sd": "0.1 mm", "accuracy": "0.2 delta_degC", "lag_sd": "0.2 s"}


def test_the_hot_road_is_part_of_the_cause(hidden: tuple[DiagnosisData, Path]) -> None:
    d, _ = hidden
    assert d.verdict == PARTLY
    assert [member.name for member in d.best.members] == ["hot-road"]
    low, high = d.robustness.interval(d.best.members[0].amplitudes[0])
    assert low < WARMER < high
    assert {model.name for model in d.robustness.laws} == {"strain law barrel"}
    assert d.robustness.untried == ("fem",)


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
    names = [row["name"] for row in record["discrepancies"]]
    assert names[0] == "strain energy"
    assert {"none", "missing heat", "strain law barrel"} < set(names)
    assert record["discrepancies"][0]["effects"]["hot-road"] >= 0.9
    assert 0 < record["confidence"] <= record["effects"][0]["probability"]


def test_the_amended_study_has_the_effect_and_the_strain_energy(hidden: tuple[DiagnosisData, Path]) -> None:
    d, folder = hidden
    amended = tf.study(folder / "amended.toml")
    assert {effect.name for effect in amended.effects} == {"hot-road", "heat-shape"}
    assert d.rms(after=True, held_out=True) < 0.4 * d.rms(after=False, held_out=True)
