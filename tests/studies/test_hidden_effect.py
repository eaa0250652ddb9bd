"""The shipped blind study: what was put into its table is found, and nothing else is named."""

from __future__ import annotations

import numpy as np
import pytest
from hidden_effect_truth import AMPLITUDE, HIDDEN, TABLE, truth

import tyrefem as tf
from tyrefem.measured import read_table


def test_the_table_is_what_the_truth_says(request: pytest.FixtureRequest) -> None:
    runs = read_table(request.config.rootpath / TABLE)
    assert [run.name for run in runs] == ["A", "B", "C", "D"]
    case = truth(tf.study("hidden-effect"))
    assert [one.name for one in case.hidden] == [HIDDEN]
    assert all(np.isfinite(run.temperatures.to_numpy()).mean() > 0.85 for run in runs)


def test_the_hidden_effect_is_found() -> None:
    found = tf.study("hidden-effect").diagnose(largest=1, rerun=False, looks=1)
    assert found.verdict == "identified"
    assert [one.name for one in found.judgement.best.members] == [HIDDEN]
    (amplitude,) = found.judgement.best.members[0].amplitudes
    assert abs(found.best.values[amplitude] - AMPLITUDE) < 3 * found.best.sd[amplitude]
    before, after = (found.rms(after=when, held_out=True) for when in (False, True))
    assert before > 2.0
    assert after < 1.2 * found.noise
