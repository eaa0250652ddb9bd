"""The example with another mechanics than the model: its table is what its script makes; a hot road is a part of it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import tyrefem as tf
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Candidate, catalogue_candidates
from tyrefem.diagnose.verdicts.verdict import PARTLY
from tyrefem.diagnose.words.headline import headline
from tyrefem.inputs.study import StudyData

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from make_structural_table import HIDDEN, MODES, STUDY, WARMER, table  # noqa: E402

from tyrefem.diagnose.blind.other_model import rms_of_modes  # noqa: E402

#: Few candidates make a short test; all of them change the tread.
FEW = ("hot-road", "sun", "worn-tread")


def few(looked_at: StudyData) -> tuple[Candidate, ...]:
    return tuple(each for each in catalogue_candidates(looked_at) if each.name in FEW)


def test_the_table_is_what_its_script_makes() -> None:
    study = tf.study("example-structural")
    (first, *_) = study.data["measured"]
    made = table(study.replace({"measured": [first]}))
    shipped = pd.read_csv(STUDY / "runs.csv", comment="#")
    shipped = shipped[shipped["run"] == "A"]
    assert list(made) == list(shipped)
    for name in made.columns[1:]:
        np.testing.assert_allclose(made[name].to_numpy(), shipped[name].to_numpy(), atol=0.02)
    assert rms_of_modes(MODES) == pytest.approx(0.2, abs=0.01)


def test_the_hot_road_is_a_part_of_the_cause() -> None:
    coarse: dict[str, Any] = {"mesh_size": "12 mm", "blocks": 20, "tolerance": "0.1 delta_degC"}
    # The strain energy is what decides; of the other discrepancies the middle size is tried.
    settings = DiagnosisSettings(
        **coarse, heat_widths=(3.0,), discrepancy_sizes=(1.0,), largest=1, looks=1, first_steps=2, more_steps=2,
        singles=2, most_sets=3, most_continuations=1, beside_sets=1, beside_steps=1, odd_run_share=0.0,
    )  # fmt: skip
    study = tf.study("example-structural")
    first, other_load, _, held_out = study.data["measured"]
    d = study.replace({"measured": [first, other_load, held_out]}).diagnose(
        settings=settings, candidates=few, rerun=False, verdict_only=True
    )
    assert d.verdict == PARTLY
    assert [member.key for member in d.best.members] == [HIDDEN]
    assert d.robustness is not None
    low, high = d.robustness.interval(d.best.members[0].amplitudes[0])
    assert low - 1.5 < WARMER < high + 1.5
    wrong, sure, _ = headline(d)
    assert wrong.startswith("This is a part of it: The road is warmer than stated")
    assert "whatever else is wrong" in sure
