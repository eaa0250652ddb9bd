"""Studies without sensors, without measured runs, with every run held out, or with none: an answer or one error."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from odd_studies import END, FITTED, HELD_OUT, SENSORS, table, write

import tyrefem as tf
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.layout.isolability import isolability
from tyrefem.diagnose.layout.planned_runs import planned
from tyrefem.diagnose.next_experiment import drive_gain
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import catalogue_candidates
from tyrefem.errors import InputError

pytestmark = pytest.mark.fast

ALL_HELD_OUT = ({**FITTED, "hold_out": True}, HELD_OUT)


@pytest.mark.parametrize("question", ["diagnose", "isolability", "blind"])
def test_every_run_held_out_is_refused_before_anything_runs(
    question: str, here: Path, refused: Callable[..., str], no_simulation: None
) -> None:
    words = refused(question, str(write(here / "held", measured=ALL_HELD_OUT)))
    assert "held/study.toml: measured.hold_out: all 2 runs are held out" in words
    assert "hold_out = false" in words


def test_the_only_run_held_out_is_said_so(here: Path, refused: Callable[..., str]) -> None:
    assert "the only run is held out" in refused("blind", str(write(here / "held", measured=ALL_HELD_OUT[:1])))


def test_a_given_table_of_held_out_runs_is_refused(
    here: Path, refused: Callable[..., str], no_simulation: None
) -> None:
    folder = write(here / "study", measured=[FITTED, HELD_OUT])
    assert "measured.hold_out: the only run is held out" in refused("diagnose", str(folder), str(folder / "b.csv"))


@pytest.mark.parametrize("question", ["compare", "diagnose"])
@pytest.mark.parametrize("sensors", [True, False])
def test_no_measured_runs_is_one_error(
    question: str, sensors: bool, here: Path, refused: Callable[..., str], no_simulation: None
) -> None:
    words = refused(question, str(write(here / "bare", sensors=sensors)))
    assert "bare/study.toml: measured: " in words
    assert "[[measured]]" in words
    assert "name a table" in words


def test_readings_outside_the_drive_are_refused_before_anything_runs(here: Path, no_simulation: None) -> None:
    late = table(here / "late.csv", list(SENSORS), start=END + 1)
    study = tf.study(write(here / "study", measured=[FITTED]))
    with pytest.raises(InputError, match=r"no measured time is within the simulated span.*0 to 60 s"):
        study.compare(late)
    with pytest.raises(InputError, match="measured: no fitted run has a reading within the simulated drive"):
        study.diagnose(late)


def test_no_effect_left_to_tell_apart_is_refused(here: Path, refused: Callable[..., str], no_simulation: None) -> None:
    folder = str(write(here / "none", measured=[FITTED], rivals=()))
    for question in ("isolability", "blind"):
        assert "none/study.toml: diagnosis.exclude: no effect of the catalogue is left" in refused(question, folder)


def test_a_drive_shorter_than_the_time_between_readings_is_refused(
    here: Path, refused: Callable[..., str], no_simulation: None
) -> None:
    folder = str(write(here / "short", drive={"duration": "5 s"}))
    for question in ("isolability", "blind"):
        words = refused(question, folder)
        assert "short/study.toml: drive: the study's own drive lasts 5 s" in words
        assert "10 s" in words


def test_without_sensors_the_contained_air_alone_is_planned_and_said(here: Path) -> None:
    study = tf.study(write(here / "bare", sensors=False))
    assert [[sensor_series.sensor for sensor_series in trial.sensors] for trial in planned(study)] == [
        ["contained-air"]
    ]
    isolability_result = isolability(study)
    assert set(isolability_result.table["effect"]) >= {"hot-road", "sun"}
    assert "only the contained air is read" in " ".join(isolability_result.words())
    assert "its drive is the only run" in " ".join(isolability_result.to_dict()["notes"])


def test_where_nothing_is_identifiable_no_runs_are_recommended(here: Path) -> None:
    # RankedSet in the shade at ambient temperature: whatever warms a rolling tyre is not there to be seen.
    study = tf.study(write(here / "standing", sensors=False, rivals=["tread-slip"], drive={"speed": "0 mph"}))
    isolability_result = isolability(study)
    assert not isolability_result.table["identifiable_at_usual"].any()
    assert isolability_result.runs == ()


def test_without_sensors_the_next_drive_is_judged_by_the_contained_air(here: Path) -> None:
    study = tf.study(write(here / "bare", sensors=False, measured=[FITTED]))
    bench = ForwardModel(study, planned(study))
    warmer, brighter = (
        {candidate.amplitudes[0]: candidate.amplitudes[0].sd} for candidate in catalogue_candidates(study)[:2]
    )
    result = drive_gain(bench, "half the speed", {"speed": 0.5}, warmer, brighter)
    assert result is not None
    assert result["sensor"] == "contained-air"
    assert result["gain"] > 0


@pytest.mark.parametrize("phases", [1, 2])
def test_a_diagnosis_without_held_out_runs_claims_nothing_of_them(phases: int, here: Path) -> None:
    drive = {} if phases == 1 else {"phases": [{"duration": "40 s"}, {"speed": "0 mph", "duration": "20 s"}]}
    folder = write(here / "fitted", measured=[FITTED], drive=drive)
    study = tf.study(folder)
    # A sensor reads too much: that is explained soon.
    readings = study.run().readings[["time_s", *SENSORS]]
    readings[list(SENSORS)] += np.random.default_rng(0).normal(0.0, 0.5, (len(readings), len(SENSORS)))
    readings["crown-outer"] += 8.0
    names = {"time_s": "time [s]", **{name: f"{name} [degC]" for name in SENSORS}}
    readings.rename(columns=names).to_csv(folder / "a.csv", index=False)
    settings = DiagnosisSettings(mesh_size="12 mm", largest=1, looks=1, heat_widths=(3.0,), discrepancy_sizes=(1.0,))
    result = study.diagnose(settings=settings)
    assert math.isnan(result.null.held_out_p)
    result.save(here / "out")
    record = json.loads((here / "out/verdict.json").read_text(encoding="utf-8"))
    assert record["gap"]["after"]["held_out_rms_K"] is None
    assert {item["held_out_p"] for item in record["sets"] if "held_out_p" in item} == {None}
    assert result.verdict != "no gap"
    assert "No run is held out" in " ".join(record["summary"])
