"""Beside a discrepancy: rivals whose own fits ended early, and effects that a fit does not ask for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from formula import STATED, Array, case, effect

from tyrefem.diagnose.beside.best_fit import not_asked_for
from tyrefem.diagnose.beside.discrepancy import NONE, Discrepancy
from tyrefem.diagnose.beside.ranked_beside import FAR, RankedBeside, is_good
from tyrefem.diagnose.fitting.criterion import LogEvidence
from tyrefem.diagnose.fitting.selection import SelectionProblem
from tyrefem.diagnose.settings import DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Members, SetPrior

N = 80
T = np.linspace(0.05, 1.0, N)
STRONG, RIVAL, SPARE = effect("strong"), effect("rival"), effect("spare")
CANDIDATES = (STRONG, RIVAL, SPARE)


def law(values: Mapping[str, float]) -> Array:
    """Two effects that saturate and have nearly the same course, and a small third one."""
    heat = 10.0 * values.get(STATED.key, 0.0) * np.sqrt(T)
    both = (
        60.0 * np.tanh(values.get(name, 0.0) / 3.0) * T**power for name, power in (("strong", 1.0), ("rival", 1.01))
    )
    return np.asarray(heat + sum(both) + values.get("spare", 0.0) * T**4)


def test_a_rival_that_ended_early_is_found_by_a_larger_set() -> None:
    made = case(law, law({"strong": 5.0}) + np.random.default_rng(3).normal(size=N), CANDIDATES)
    prior = SetPrior(CANDIDATES, 0.5)
    problem = SelectionProblem(made.residuals, made.predictions, CANDIDATES, prior, LogEvidence())
    hasty = replace(problem, residuals=replace(made.residuals, settings=DiagnosisSettings(first_steps=1)))
    (early,) = hasty.fitted([(STRONG,)], {})
    early = replace(early, log_evidence=early.log_evidence - early.state.predicted_reduction / 2)
    good = {problem.ordered(fit.members): problem.settled_fit(fit) for fit in problem.fitted(
        [(), (STRONG,), (RIVAL,), (STRONG, SPARE)], {}
    )}  # fmt: skip
    beside = RankedBeside(problem, Discrepancy(NONE, 0.0), fits=good | {(STRONG,): early})
    assert beside.best.members == (RIVAL,)
    assert beside.score((STRONG,)) < beside.score((RIVAL,)) - 20.0
    assert beside._continue_ended()
    assert beside.fits[STRONG,].log_evidence == pytest.approx(good[STRONG,].log_evidence, abs=0.5)
    assert abs(beside.score((STRONG,)) - beside.score((RIVAL,))) < 3.0


def test_a_rival_that_ended_at_its_best_point_stays_as_it_is() -> None:
    made = case(law, law({"strong": 5.0}) + np.random.default_rng(3).normal(size=N), CANDIDATES)
    problem = SelectionProblem(made.residuals, made.predictions, CANDIDATES, SetPrior(CANDIDATES, 0.5), LogEvidence())
    fits = [problem.settled_fit(fit) for fit in problem.fitted([(), (STRONG,), (RIVAL,), (STRONG, SPARE)], {})]
    beside = RankedBeside(problem, Discrepancy(NONE, 0.0), fits={problem.ordered(fit.members): fit for fit in fits})
    assert beside._hidden_rivals() == []


def test_a_rival_whose_misfit_noise_explains_is_fitted_to_its_end() -> None:
    made = case(law, law({"strong": 5.0}) + np.random.default_rng(3).normal(size=N), CANDIDATES)
    problem = SelectionProblem(made.residuals, made.predictions, CANDIDATES, SetPrior(CANDIDATES, 0.5), LogEvidence())
    fits = [problem.settled_fit(fit) for fit in problem.fitted([(), (STRONG,), (RIVAL,)], {})]
    good = {problem.ordered(fit.members): fit for fit in fits}
    whole = good[STRONG,]
    early = replace(
        whole, log_evidence=whole.log_evidence - 20.0, state=replace(whole.state, converged=False, done=False)
    )
    beside = RankedBeside(problem, Discrepancy(NONE, 0.0), fits=good | {(STRONG,): early})
    assert is_good(early)
    assert beside.best.members == (RIVAL,)
    assert beside._hidden_rivals() == []
    assert beside._continue_ended()
    assert beside.fits[STRONG,].log_evidence == pytest.approx(whole.log_evidence, abs=0.5)
    # Converged, it is not fitted again; nor is a rival far behind.
    assert beside._unfinished_rivals() == []
    beside.fits[STRONG,] = replace(early, log_evidence=early.log_evidence - FAR)
    assert beside._unfinished_rivals() == []


@pytest.mark.parametrize(("spare", "idle"), [(0.0, (SPARE,)), (12.0, ())])
def test_an_effect_that_a_fit_does_not_ask_for_is_told(spare: float, idle: Members) -> None:
    made = case(law, law({"strong": 5.0, "spare": spare}) + np.random.default_rng(3).normal(size=N), CANDIDATES)
    prior = SetPrior(CANDIDATES, 0.5)
    problem = SelectionProblem(made.residuals, made.predictions, CANDIDATES, prior, LogEvidence())
    (fit,) = problem.fitted([(STRONG, SPARE)], {})
    assert not_asked_for(problem, problem.settled_fit(fit)) == idle
