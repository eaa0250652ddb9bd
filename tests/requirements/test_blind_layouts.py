"""Blind tests of studies that lack something: rates without what is not there, and words that say so."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from odd_studies import FITTED, write

import tyrefem as tf
from tyrefem.diagnose.blind.blind_case import cases
from tyrefem.diagnose.blind.rates import Blind, run_blind
from tyrefem.reports.blind import picture, save

#: Of the synthetic data.
COARSE = {"mesh.size": "10 mm"}


def _row(held_out: bool, **more: Any) -> dict[str, Any]:
    before, after = (4.0, 0.55) if held_out else (None, None)
    return {
        "kind": "one", "hidden": ["sun"], "verdict": "identified", "named": ["sun"], "set": ["sun"],
        "identifiable": True, "amplitude": {"sun": 2.0}, "probability": 0.97, "best": "sun",
        "held_out_rms_K": {"before": before, "after": after}, "noise_K": 0.5, "missing_station_m": 0.1,
        "station_m": 0.1, "length_m": 0.15,
    } | more  # fmt: skip


def test_rates_of_held_out_runs_count_only_cases_that_have_some() -> None:
    row_of_table = Blind("s", 1, (_row(False), _row(False), _row(True)))
    rates = {name: (rate.right, rate.of) for name, rate in row_of_table.rates.items()}
    assert rates["identifiable: named correctly"] == (3, 3)
    assert rates["named rightly: held-out rms at most 1.2 times the noise"] == (1, 1)
    assert rates["strong and identifiable: held-out gap shrunk 3 times"] == (1, 1)


def test_without_held_out_runs_the_rates_and_the_picture_are_made() -> None:
    row_of_table = Blind("s", 1, (_row(False),), ("No run is held out.",))
    assert row_of_table.rates["named rightly: held-out rms at most 1.2 times the noise"].of == 0
    assert row_of_table.words()[-1] == "No run is held out."
    assert picture(row_of_table).axes


@pytest.mark.parametrize("rivals", [["hot-road"], ["sensor-offset"], ["sensor-offset", "sun"]])
def test_with_too_few_physical_effects_for_a_pair_one_is_hidden(rivals: list[str], here: Path) -> None:
    study = tf.study(write(here / "few", rivals=rivals))
    blind_cases = cases(study, 40, 1)
    assert {item.kind for item in blind_cases} == {"one", "none", "outside"}
    assert all(len(item.hidden) == (item.kind == "one") for item in blind_cases)


def test_without_uncertain_numbers_none_is_far_off(here: Path) -> None:
    study = tf.study(write(here / "sure"))
    study.__dict__["uncertainty"] = {}
    blind_cases = cases(study, 60, 1)
    assert sum(item.kind == "none" for item in blind_cases) > 5


def test_a_study_without_sensors_or_runs_is_tested_by_its_contained_air(
    here: Path,
) -> None:
    result = run_blind(tf.study(write(here / "bare", sensors=False)), 2, 1, here / "out", mesh=COARSE)
    assert [row["verdict"] for row in result.rows] != ["failed", "failed"]
    words = " ".join(result.words())
    assert "only the contained air is read" in words
    assert "No run is held out" in words
    save(result, here / "out")
    record = json.loads((here / "out/blind.json").read_text(encoding="utf-8"))
    assert record["notes"] == list(result.notes)


def test_one_fitted_run_is_enough(here: Path) -> None:
    result = run_blind(tf.study(write(here / "single", measured=[FITTED])), 2, 1, here / "out", mesh=COARSE)
    assert result.notes == ("No run is held out, so the rates do not cover runs that were not fitted.",)
    assert all(row["held_out_rms_K"] == {"before": None, "after": None} for row in result.rows)
