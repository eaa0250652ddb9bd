"""Leading fits are compared with sensitivities at their points; without these nothing is named. By formulas."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from formula import STATED, Array, Case, case, effect, slopes

from tyrefem.diagnose.fitting.criterion import LogEvidence
from tyrefem.diagnose.fitting.exhaustive import Exhaustive
from tyrefem.diagnose.fitting.fits import FittedSet
from tyrefem.diagnose.fitting.forward_selection import ForwardSelection, _Progress
from tyrefem.diagnose.fitting.selection import ScoredSet, SelectionProblem
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Members, SetPrior
from tyrefem.diagnose.verdicts.verdict import CONFOUNDED, IDENTIFIED, judge, ranked

N = 80
T = np.linspace(0.05, 1.0, N)
#: Four effects that saturate, all of nearly the same course.
EXPONENTS = {"first": 1.0, "second": 1.05, "third": 1.1, "fourth": 1.15}


def saturating(values: Mapping[str, float]) -> Array:
    heat = 10.0 * values.get(STATED.key, 0.0) * np.sqrt(T)
    each = (40.0 * np.tanh(values.get(name, 0.0) / 3.0) * T**power for name, power in EXPONENTS.items())
    return np.asarray(heat + sum(each))


def problem_of(settings: DiagnosisSettings) -> tuple[Case, SelectionProblem]:
    candidates: Members = tuple(effect(name) for name in EXPONENTS)
    noise = np.random.default_rng(2).normal(size=N)
    made = case(saturating, saturating({"second": 4.0, STATED.key: 0.2}) + noise, candidates, settings)
    return made, SelectionProblem(
        made.residuals, made.predictions, candidates, SetPrior(candidates, 0.5), LogEvidence()
    )


def tangents_off(fit: FittedSet) -> float:
    """Largest difference of a fit's sensitivities from those at its point, relative to the largest of them."""
    at = {unknown.key: float(x) for unknown, x in zip(fit.unknowns, fit.posterior.mean, strict=True)}
    exact = slopes(saturating, [unknown.key for unknown in fit.unknowns], at)
    return float(np.abs(fit.linear.jacobian - exact).max() / np.abs(exact).max())


def leading(scored: list[ScoredSet]) -> list[FittedSet]:
    within = scored[0].score - DEFAULT.leading_score
    return [entry.fit for entry in scored if entry.fit is not None and entry.score > within]


def test_leading_fits_have_sensitivities_of_their_points() -> None:
    made, problem = problem_of(DiagnosisSettings(largest=1, near_tangents=0.0))
    before = Exhaustive().search(problem)
    after = problem.settled(before)
    assert len(leading(before)) >= 3
    assert max(tangents_off(fit) for fit in leading(before)) > 0.02
    assert max(tangents_off(fit) for fit in leading(after)) < 1e-5
    assert all(fit.settled for fit in leading(after))
    # The evidences of the first fits rest on secants from x = 0.
    known = {entry.members: entry.score for entry in before}
    assert max(abs(entry.score - known[entry.members]) for entry in after if entry.fit) > 0.05
    assert [entry.score for entry in after] == sorted((entry.score for entry in after), reverse=True)
    assert {entry.members for entry in after} == {entry.members for entry in before}
    # Settled once, nothing is simulated again.
    count = len(made.formula.questions)
    assert problem.settled(after) == after
    assert len(made.formula.questions) == count


def test_tangents_near_a_point_are_as_good_as_those_at_it() -> None:
    results = []
    for near in (0.0, DEFAULT.near_tangents):
        made, problem = problem_of(DiagnosisSettings(largest=1, near_tangents=near))
        scored = problem.settled(ForwardSelection().search(problem))
        results.append((scored, len(made.formula.points("jacobian"))))
    (exact, many), (near_enough, fewer) = results
    assert fewer < many
    scores = {entry.members: entry.score for entry in exact if entry.fit in leading(exact)}
    found = {entry.members: entry.score for entry in near_enough}
    assert max(abs(found[members] - score) for members, score in scores.items()) < 0.2
    assert all(fit.settled for fit in leading(near_enough))


def test_a_fit_that_has_not_converged_is_not_named() -> None:
    candidates = (effect("step"),)
    step = np.where(T > 0.5, 4.0, 0.0)

    def law(values: Mapping[str, float]) -> Array:
        return np.asarray(10.0 * values.get(STATED.key, 0.0) * T + values.get("step", 0.0) * step)

    made = case(law, law({"step": 2.0}) + np.random.default_rng(5).normal(size=N), candidates)
    prior = SetPrior(candidates, 0.5)
    problem = SelectionProblem(made.residuals, made.predictions, candidates, prior, LogEvidence())
    scored = problem.settled(ForwardSelection().search(problem))
    assert judge(ranked(scored), lambda members: None).verdict == IDENTIFIED
    best = scored[0].fit
    assert best is not None
    for state in (replace(best.state, converged=False), replace(best.state, jacobian_outdated=True)):
        doubtful = [scored[0]._replace(fit=replace(best, state=state)), *scored[1:]]
        judged = judge(ranked(doubtful), lambda members: None)
        assert judged.verdict == CONFOUNDED
        assert judged.doubts == ("The fit of step has not converged, so its probability is not certain.",)


def test_hopeless_fits_are_not_continued() -> None:
    candidates = (effect("step"),)
    made = case(lambda values: 0.0 * T, 30.0 * np.sin(20.0 * T), candidates)
    prior = SetPrior(candidates, 0.5)
    problem = SelectionProblem(made.residuals, made.predictions, candidates, prior, LogEvidence())
    scored = problem.fitted([(), candidates], {})
    entries = [ScoredSet(problem.score(fit), fit.members, replace(fit, state=replace(fit.state, converged=False)))
               for fit in scored]  # fmt: skip
    count = len(made.formula.questions)
    assert problem.settled(entries) == entries
    assert len(made.formula.questions) == count
    assert entries[0].fit is not None
    assert entries[0].fit.misfit > DEFAULT.slow_misfit * N
    assert pytest.approx(0.0) == entries[0].fit.p_value


def test_a_part_of_the_best_set_that_was_fitted_badly_is_fitted_from_it() -> None:
    candidates = (effect("strong"), effect("spare"))

    def law(values: Mapping[str, float]) -> Array:
        heat = 10.0 * values.get(STATED.key, 0.0) * np.sqrt(T)
        return np.asarray(heat + 60.0 * np.tanh(values.get("strong", 0.0) / 3.0) * T + values.get("spare", 0.0) * T**4)

    made = case(law, law({"strong": 5.0}) + np.random.default_rng(3).normal(size=N), candidates)
    problem = SelectionProblem(made.residuals, made.predictions, candidates, SetPrior(candidates, 0.5), LogEvidence())
    sound = problem.settled(Exhaustive().search(problem))
    alone, both = candidates[:1], candidates
    assert sound[0].members == alone
    # The single effect as a fit leaves it that ended after its first step, without credit for further ones.
    hasty = replace(problem, residuals=replace(made.residuals, settings=DiagnosisSettings(first_steps=1)))
    (stuck,) = hasty.fitted([alone], {})
    stuck = replace(stuck, log_evidence=stuck.log_evidence - stuck.state.predicted_reduction / 2)
    assert not stuck.worth_settling
    rows = [ScoredSet(problem.score(stuck), alone, stuck) if row.members == alone else row for row in sound]
    rows.sort(key=lambda row: -row.score)
    assert rows[0].members == both
    mended = problem.settled(rows)
    assert mended[0].members == alone
    assert mended[0].score == pytest.approx(sound[0].score, abs=0.3)
    # Sound fits of parts stay as they are.
    count = len(made.formula.questions)
    assert problem.settled(mended) == mended
    assert len(made.formula.questions) == count


def test_sets_that_add_to_a_fit_are_estimated_anew_where_it_rises() -> None:
    candidates = (effect("strong"), effect("spare"), effect("weak"))
    ripple = 1.5 * np.sin(15.0 * T)

    def law(values: Mapping[str, float]) -> Array:
        heat = 10.0 * values.get(STATED.key, 0.0) * np.sqrt(T)
        strong = 60.0 * np.tanh(values.get("strong", 0.0) / 3.0) * T
        return np.asarray(heat + strong + values.get("spare", 0.0) * T**4 + values.get("weak", 0.0) * ripple)

    measured = law({"strong": 5.0, "weak": 0.8}) + np.random.default_rng(3).normal(size=N)
    made = case(law, measured, candidates)
    problem = SelectionProblem(made.residuals, made.predictions, candidates, SetPrior(candidates, 0.5), LogEvidence())
    progress = _Progress(problem)
    progress.fit([()])
    alone, both, hidden = candidates[:1], candidates[:2], (candidates[0], candidates[2])
    # The strong effect alone ended after its first step, with a spare one it did not: sets that add to it look bad.
    hasty = replace(problem, residuals=replace(made.residuals, settings=DiagnosisSettings(first_steps=1)))
    (stuck,) = hasty.fitted([alone], {})
    stuck = replace(stuck, log_evidence=stuck.log_evidence - stuck.state.predicted_reduction / 2)
    progress._take([stuck, *problem.continued(problem.fitted([both], {}))])
    progress._extend(alone)
    assert not progress.promising()
    assert progress.settle()
    assert progress.promising()[0] == problem.ordered(hidden)
    progress.grow(-np.inf)
    assert progress.scored()[0].members == problem.ordered(hidden)
    # Nothing rises a second time.
    assert not progress.settle()
