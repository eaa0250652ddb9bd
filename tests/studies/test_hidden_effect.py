"""The shipped blind study: what was put into its table is found, and nothing else is named."""

from __future__ import annotations

import numpy as np
import pytest
from hidden_effect_truth import AMPLITUDE, HIDDEN, TABLE, truth

import tyrefem as tf
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.measured import read_table


def test_the_table_is_what_the_truth_says(request: pytest.FixtureRequest) -> None:
    runs = read_table(request.config.rootpath / TABLE)
    assert [run.name for run in runs] == ["A", "B", "C", "D"]
    case = truth(tf.study("hidden-effect"))
    assert [member.name for member in case.hidden] == [HIDDEN]
    assert all(np.isfinite(run.temperatures.to_numpy()).mean() > 0.85 for run in runs)


def test_the_hidden_effect_is_found() -> None:
    diagnosis = tf.study("hidden-effect").diagnose(
        settings=DiagnosisSettings(
            mesh_size="8 mm", largest=1, looks=1, odd_run_share=0.0, heat_widths=(3.0,), discrepancy_sizes=(1.0,)
        ),
        rerun=False,
        verdict_only=True,
    )
    assert diagnosis.verdict == "identified"
    assert [member.name for member in diagnosis.judgement.best.members] == [HIDDEN]
    (amplitude,) = diagnosis.judgement.best.members[0].amplitudes
    assert abs(diagnosis.best.values[amplitude] - AMPLITUDE) < 3 * diagnosis.best.sd[amplitude]
    before, after = (diagnosis.rms(after=when, held_out=True) for when in (False, True))
    assert before > 2.0
    assert after < 1.2 * diagnosis.noise
