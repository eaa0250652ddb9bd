"""Synthetic runs for comparisons."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from tyrefem.measured import MeasuredRun

from .fakes import Study


def measured_from(study, times, *, name="run-1", bias=0.0, noise=0.0, delay=0.0, sensors=("crown", "shoulder")):
    """A run that a study would have given, with a bias (computed - measured), noise, and a late clock."""
    rng = np.random.default_rng(7)
    times = np.asarray(times, dtype=float)
    frame = pd.DataFrame(
        {one: study.at(one, times - delay) - bias + noise * rng.normal(size=len(times)) for one in sensors}
    )
    return MeasuredRun(name, times, frame)


@pytest.fixture
def study():
    return Study()
