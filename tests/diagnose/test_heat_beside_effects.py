"""Heat of unknown origin beside effects: what their fit leaves, not what they do themselves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hidden import Case

from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.forward.evaluations import Evaluations
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.heat.missing_heat import missing_heat
from tyrefem.diagnose.heat.over_time import heat_over_time
from tyrefem.diagnose.unknowns.heat_patches import patches


def beside_what_it_cannot_do(fit: FittedSet) -> FittedSet:
    """A poor fit: every other block is 30 standard deviations warmer, which nothing that is fitted makes."""
    spoiled = fit.linear.data.copy()
    spoiled[::2] += 30.0
    return replace(fit, linear=replace(fit.linear, data=spoiled))


def test_the_heat_beside_an_effect_is_not_that_of_the_effect(case: Case) -> None:
    d = case.diagnosis
    (hot_road,) = d.best.members
    fit = beside_what_it_cannot_do(d.best)
    beside = missing_heat(d.gap, patches(d.gap.study, d.gap.settings), fit)
    # Its amounts stand beside the effect's: the estimate has both.
    assert hot_road.amplitudes[0] in beside.values
    assert hot_road.amplitudes[0] not in missing_heat(d.gap, patches(d.gap.study, d.gap.settings), d.null).values


def test_sources_over_time_beside_an_effect_explain_what_its_fit_leaves(case: Case) -> None:
    d = case.diagnosis
    model = ForwardModel(d.gap.study, tuple(run.sampling for run in d.gap.runs), settings=d.gap.settings)
    fit = beside_what_it_cannot_do(d.best)
    beside = heat_over_time(d.gap, Evaluations(model), fit)
    assert beside.basis is not None
    # The effect's amount is among the unknowns that are integrated out.
    assert beside.basis.data.jacobian.shape[1] == len(d.best.unknowns)
    assert np.array_equal(beside.basis.data.data, fit.linear.data)
