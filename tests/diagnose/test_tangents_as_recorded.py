"""Tangents are of what is recorded: lag, swapped channels and a late clock between rubber and table."""

from __future__ import annotations

import numpy as np
import pytest
from hidden import Case

from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.unknowns.candidates import catalogue_candidates
from tyrefem.diagnose.unknowns.unknown import Unknown, base_unknowns

#: Effect -> x of its unknown: where the tangents are taken.
AT = {
    "sensor-lag (crown-outer)": 25.0,
    "sensor-offset (shoulder-inner)": 3.0,
    "swapped-channels (crown-outer, sidewall-outer)": 1.0,
    "clock-offset": 12.0,
}


@pytest.mark.parametrize("present", [list(AT), ["swapped-channels (crown-outer, sidewall-outer)"], ["clock-offset"]])
def test_tangents_are_the_difference_quotients_of_the_record(case: Case, present: list[str]) -> None:
    study = case.study.replace({"diagnosis.exclude": []})
    known = {candidate.key: candidate.unknowns[0] for candidate in catalogue_candidates(study)}
    at: dict[Unknown, float] = {known[key]: AT[key] for key in present}
    model = ForwardModel(study, tuple(candidate.sampling for candidate in case.diagnosis.gap.runs))
    wanted = [candidate for candidate in base_unknowns(study) if "tread" in candidate.key]
    assert wanted
    derivatives = model.jacobian(0, wanted, at)
    quotients = model.differences(0, wanted, at)
    scale = np.abs(quotients).max(axis=0)
    assert (scale > 1.0).all(), "K per unit of the logarithm: something to compare"
    assert np.abs(derivatives - quotients).max(axis=0) / scale == pytest.approx(0.0, abs=0.05)
