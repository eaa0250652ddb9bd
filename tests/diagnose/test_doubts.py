"""What a verdict must survive: usual corrections, and held-out runs; on readings by formulas."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from formula import STATED, Array, Case, Law, case, effect
from hidden import Case as HiddenCase
from scipy.stats import kstest

from tyrefem.diagnose.fitting.criterion import LogEvidence
from tyrefem.diagnose.fitting.exhaustive import Exhaustive
from tyrefem.diagnose.fitting.pulls import pulls, pulls_p
from tyrefem.diagnose.fitting.selection import SelectionProblem
from tyrefem.diagnose.settings import DEFAULT
from tyrefem.diagnose.unknowns.candidates import Members, SetPrior
from tyrefem.diagnose.verdicts.verdict import (
    CONFOUNDED,
    IDENTIFIED,
    NO_GAP,
    UNEXPLAINED,
    Judgement,
    better_on_held_out,
    judge,
    ranked,
)

N = 60
T = np.linspace(0.0, 1.0, N)
STEP, SLOW = np.where(T > 0.4, 4.0, 0.0), 8.0 * T**4


def law(step: Array = STEP, slow: Array = SLOW) -> Law:
    def readings(values: Mapping[str, float]) -> Array:
        heat = 10.0 * values.get(STATED.key, 0.0) * T
        return np.asarray(heat + values.get("step", 0.0) * step + values.get("slow", 0.0) * slow)

    return readings


def made_of(measured: Array, held_out: tuple[Law, Array] | None = None, slow: Array = SLOW) -> tuple[Case, Members]:
    candidates = (effect("step"), effect("slow"))
    return case(law(slow=slow), measured, candidates, held_out=held_out), candidates


def verdict_on(
    measured: Array, held_out: tuple[Law, Array] | None = None, outside: float = np.nan, slow: Array = SLOW
) -> Judgement:
    """``outside``: lead of heat of unknown origin over the best set on the held-out run, nats."""
    made, candidates = made_of(measured, held_out, slow)
    problem = SelectionProblem(made.residuals, made.predictions, candidates, SetPrior(candidates, 0.5), LogEvidence())
    scored = problem.settled(Exhaustive().search(problem))
    assert scored[0].fit is not None
    ranking = ranked(scored, scored[0].score - 20.0, scored[0].fit.held_out + outside)
    return judge(ranking, lambda members: None)


def noise(seed: int) -> Array:
    return np.random.default_rng(seed).normal(size=N)


def test_a_set_that_needs_an_improbable_base_number_is_not_named() -> None:
    usual = verdict_on(law()({"step": 2.0, STATED.key: 0.5}) + noise(1))
    assert usual.verdict == IDENTIFIED
    assert usual.best.key == "step"
    odd = verdict_on(law()({"step": 2.0, STATED.key: 2.0}) + noise(1))
    assert odd.best.key == "step"
    # The misfit alone is no ground: among 60 readings a pull of six drowns.
    assert odd.best.fit is not None
    assert odd.best.fit.p_value > DEFAULT.rejected_p
    assert odd.verdict == UNEXPLAINED
    assert "loss tangent of tread" in odd.doubts[0]
    assert "prior standard deviations" in odd.doubts[0]
    assert odd.doubts[0].startswith("Step explains the data only with improbable corrections")


def test_no_effect_with_an_improbable_base_number_is_not_no_gap() -> None:
    assert verdict_on(law()({STATED.key: 0.6}) + noise(2)).verdict == NO_GAP
    odd = verdict_on(law()({STATED.key: 1.5}) + noise(2))
    assert odd.best.key == "no effect"
    assert odd.verdict == UNEXPLAINED
    assert odd.doubts[0].startswith("Base numbers and sensors explain the data only with improbable corrections")


def test_pulls_are_corrections_over_their_prior() -> None:
    made, _ = made_of(law()({STATED.key: 0.6}))
    problem = SelectionProblem(made.residuals, made.predictions, (), SetPrior((), 0.5), LogEvidence())
    (fit,) = problem.continued(problem.fitted([()], {}))
    (pull,) = pulls(fit)
    assert pull.pull == pytest.approx(fit.values[STATED] / 0.3)
    assert pull.pull == pytest.approx(2.0, rel=0.02)
    assert pull.words.startswith("loss tangent of tread +8")


def test_the_sum_of_pulls_is_uniform_over_right_data() -> None:
    """Base number drawn from its prior, and noise: the probability is as often below p as it says."""
    rng = np.random.default_rng(3)
    values = []
    for _ in range(200):
        made, _ = made_of(law()({STATED.key: 0.3 * rng.normal()}) + rng.normal(size=N))
        problem = SelectionProblem(made.residuals, made.predictions, (), SetPrior((), 0.5), LogEvidence())
        values.append(pulls_p(problem.fitted([()], {})[0]))
    assert kstest(values, "uniform").pvalue > 0.01


def test_no_gap_must_stand_the_held_out_run() -> None:
    other = law()
    right = (other, other({}) + noise(5))
    assert verdict_on(noise(4), right).verdict == NO_GAP
    wrong = (other, other({}) + 4.0 * np.sin(9.0 * T) + noise(5))
    judged = verdict_on(noise(4), wrong)
    assert judged.best.key == "no effect"
    assert judged.verdict == UNEXPLAINED
    assert "held-out runs reject no effect" in judged.doubts[0]


#: In the fitted run nearly "step".
ALIKE = STEP + 1.0 * np.sin(9.0 * T)


def confusing(share: float) -> tuple[Array, tuple[Law, Array]]:
    """The fitted run calls for "step"; in the held-out run "slow" acts, with this share of the difference."""
    fitted = law()({"step": 1.0}) + noise(6)
    # In the held-out run both effects are alike but for a small part.
    step, slow = 3.0 * T, 3.0 * T + 2.0 * share * np.sin(6.0 * T)
    other = law(step, slow)
    return fitted, (other, other({"step": 1.0}) + 2.0 * share * np.sin(6.0 * T) + noise(7))


def test_a_set_that_another_beats_on_the_held_out_run_is_not_named() -> None:
    fitted, held_out = confusing(0.0)
    assert verdict_on(fitted, held_out, slow=ALIKE).verdict == IDENTIFIED
    fitted, held_out = confusing(0.55)
    judged = verdict_on(fitted, held_out, slow=ALIKE)
    best = judged.ranking[0].fit
    assert best is not None
    assert judged.best.key == "step"
    assert best.held_out_p > DEFAULT.rejected_p, "by itself the held-out run does not reject it"
    better = better_on_held_out(judged.ranking, best, DEFAULT.held_out_margin)
    assert better is not None
    assert better[1] > DEFAULT.held_out_margin
    assert judged.verdict == CONFOUNDED
    assert better[0] in judged.credible
    assert "predicts the held-out runs better than step, by" in judged.doubts[0]


@pytest.mark.parametrize(("lead", "verdict"), [(3.0, IDENTIFIED), (20.0, UNEXPLAINED)])
def test_heat_of_unknown_origin_may_predict_the_held_out_run_better(lead: float, verdict: str) -> None:
    fitted, held_out = confusing(0.0)
    judged = verdict_on(fitted, held_out, lead)
    assert judged.verdict == verdict
    if verdict == UNEXPLAINED:
        assert judged.doubts[0].startswith("Heat of unknown origin predicts the held-out runs better than step")


def test_no_gap_lists_what_was_corrected_and_by_how_much(case: HiddenCase) -> None:
    assert case.diagnosis.again is not None
    record = case.diagnosis.to_dict()
    for row in record["changes"]:
        assert abs(row["pull"]) < DEFAULT.largest_pull
    assert record["sets"][0]["largest_pull"] < DEFAULT.largest_pull
    assert 0.0 < record["sets"][0]["pulls_p"] <= 1.0
