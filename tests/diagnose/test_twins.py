"""An effect beyond the tolerance of a card is found where the fit of no effect strains the card."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from formula import STATED, Array, case, effect

from tyrefem.diagnose.beside.discrepancy import NONE, Discrepancy
from tyrefem.diagnose.beside.ranking import under
from tyrefem.diagnose.beside.robustness import Robustness
from tyrefem.diagnose.fitting.criterion import LogEvidence
from tyrefem.diagnose.fitting.fits import linear_about
from tyrefem.diagnose.fitting.forward_selection import ForwardSelection
from tyrefem.diagnose.fitting.selection import SelectionProblem
from tyrefem.diagnose.settings import DEFAULT
from tyrefem.diagnose.unknowns.candidates import SetPrior
from tyrefem.diagnose.words.result_tables import parameters

N, HIDDEN = 80, 2.4
T = np.linspace(0.05, 1.0, N)
BEYOND = effect("beyond")
#: The same number as the card's, with a prior many times as wide.
TWIN = replace(BEYOND, unknowns=(replace(BEYOND.unknowns[0], key=STATED.key),))


def late(values: Mapping[str, float]) -> Array:
    """A lag: what one more of it changes depends on how large it is."""
    lag = values.get(STATED.key, 0.0)
    return np.asarray(60.0 * T * np.exp(-lag * T) + 2.0 * values.get("other", 0.0) * T**2)


@pytest.fixture(scope="module")
def problem() -> SelectionProblem:
    candidates = (TWIN, effect("other"))
    noise = np.random.default_rng(5).normal(size=N)
    made = case(late, late({STATED.key: HIDDEN}) + noise, candidates)
    return SelectionProblem(made.residuals, made.predictions, candidates, SetPrior(candidates, 0.5), LogEvidence())


def test_the_effect_is_found_in_place_of_an_improbable_correction(problem: SelectionProblem) -> None:
    best, *_ = problem.settled(ForwardSelection().search(problem))
    assert best.members == (TWIN,)
    assert best.fit is not None
    (hidden,) = TWIN.amplitudes
    assert best.fit.values[hidden] + best.fit.values[STATED] == pytest.approx(HIDDEN, abs=0.1)
    assert abs(best.fit.values[STATED]) < STATED.sd


def test_it_has_the_slope_of_its_twin(problem: SelectionProblem) -> None:
    (null,) = problem.continued(problem.fitted([()], {}))
    assert null.values[STATED] > 5 * STATED.sd
    about = linear_about(problem.residuals, null, TWIN.amplitudes)
    stated, hidden = about.jacobian.T
    assert hidden == pytest.approx(stated)
    at_zero = problem.linear.jacobian[:, 0]
    assert np.linalg.norm(hidden - at_zero) > 0.3 * np.linalg.norm(at_zero)
    # The sum is known and the twin's prior is wide, so it takes over what the card cannot.
    gain = about.log_evidence((TWIN,)) - about.log_evidence(())
    assert gain > (null.values[STATED] / STATED.sd) ** 2 / 2 - DEFAULT.leading_score


def test_the_amended_study_states_the_sum_with_the_covariance_of_both(problem: SelectionProblem) -> None:
    best, *_ = problem.settled(ForwardSelection().search(problem))
    fit = best.fit
    assert fit is not None
    (hidden,) = TWIN.amplitudes
    x, sd = fit.total(hidden)
    assert x == pytest.approx(HIDDEN, abs=3 * sd)
    # The data alone: one number, whose slope is that of the readings, in unit noise.
    slope = (late({STATED.key: x + 1e-4}) - late({STATED.key: x - 1e-4})) / 2e-4
    assert sd == pytest.approx((slope @ slope + 1 / (hidden.sd**2 + STATED.sd**2)) ** -0.5, rel=0.05)
    # Each part by itself is as uncertain as the tolerance of the card.
    assert min(fit.sd[hidden], fit.sd[STATED]) > 0.9 * STATED.sd > 3 * sd
    # The tolerance is a part of what is stated, not a further change.
    assert fit.totals == {hidden: (x, sd)}
    (row,) = parameters([hidden], fit).values()
    assert (row["value"], row["sd"]) == (x, sd)
    beside = under(Discrepancy(NONE, 0.0), problem.residuals, [best])
    robust = Robustness((replace(beside, probability=1.0),))
    assert robust.spread(fit) == {hidden: pytest.approx(sd)}
    assert robust.interval(hidden) == (x - 2 * sd, x + 2 * sd)
    assert replace(fit, spread={hidden: 2 * sd}).total(hidden) == (x, 2 * sd)
