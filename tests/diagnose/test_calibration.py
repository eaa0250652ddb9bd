"""Calibration by quick cases: linear layouts with every answer in closed form."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from formula import STATED, effect
from hidden import HASTY, study
from scipy.special import expit

from tyrefem.diagnose.inference.evidence import posterior
from tyrefem.diagnose.inference.linear_model import DesignMatrix, LinearModel
from tyrefem.diagnose.layout.calibration import Calibration, RankTest, Reliability, calibrate
from tyrefem.diagnose.layout.conformal import (
    COVERAGE,
    ConformalCalibration,
    conformal_sets,
    conformal_threshold,
    read_calibration,
)
from tyrefem.diagnose.layout.false_alarms import Frequency, false_alarms
from tyrefem.diagnose.layout.linear_layout import LinearLayout, linear_layout
from tyrefem.diagnose.layout.planned_runs import planned_sensitivities
from tyrefem.diagnose.layout.quick_cases import DrawnCause, drawn, posterior_ranks, readings
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Candidate, Members, SetPrior
from tyrefem.diagnose.unknowns.unknown import Unknown
from tyrefem.diagnose.words.sentences import verdict_words
from tyrefem.errors import InputError
from tyrefem.output import write_json

T = np.linspace(0.0, 1.0, 30)
PRESENT = Candidate("swap", (), (Unknown("effects.swap", 1.0, 0.0, 1.0, "swap"),))
BOTH = Candidate("both", (), tuple(replace(effect(name).unknowns[0], effect="both") for name in ("one-end", "other")))


def layout(
    shapes: dict[str, Any],
    candidates: Members,
    settings: DiagnosisSettings = DEFAULT,
    heat: float = 0.0,
    stated: Unknown = STATED,
) -> LinearLayout:
    """Readings of a base number and the candidates' unknowns by key; half as many readings are held out."""
    unknowns = (stated, *(unknown for each in candidates for unknown in each.unknowns))
    J = np.column_stack([5.0 * np.sqrt(T), *(shapes[unknown.key] for unknown in unknowns[1:])])
    patches = heat * np.column_stack([np.sin(9 * T), np.cos(9 * T)])
    prior = SetPrior(candidates, 0.5, settings.size_shares)
    log_heat = math.log(0.025) if heat else -math.inf
    return LinearLayout(
        DesignMatrix(unknowns, 1, J), J[::2], candidates, prior, patches, np.ones(2), patches[::2], log_heat, settings
    )


def single(size: float = 1.0, sd: float = 2.0) -> LinearLayout:
    """One effect against none."""
    return layout({"early": size * T**2}, (effect("early", sd),), replace(DEFAULT, largest=1))


ALIKE = {"first": 1.5 * T, "second": 1.5 * T**1.1, "third": 1.5 * T**1.2, "fourth": np.sin(6 * T)}


def alike() -> LinearLayout:
    return layout(ALIKE, tuple(effect(name) for name in ALIKE), replace(DEFAULT, largest=2), heat=0.5)


@pytest.mark.parametrize("low", [-math.inf, 0.05])
def test_evidences_are_those_of_the_linear_model(low: float) -> None:
    rng, stated = np.random.default_rng(1), replace(STATED, low=low)
    candidates = (effect("first"), effect("bounded", 1.0, low=0.0), PRESENT, replace(PRESENT, name="swap-2",
        unknowns=(Unknown("effects.swap-2", 1.0, 0.0, 1.0, "swap-2"),)), BOTH)  # fmt: skip
    shapes = {unknown.key: rng.normal(size=len(T)) for each in candidates for unknown in each.unknowns}
    of_layout = layout(shapes, candidates, heat=2.0, stated=stated)
    data = 2.0 * rng.normal(size=len(T))
    linear = LinearModel(of_layout.design, data)
    expected = [linear.log_evidence(members) + of_layout.prior(members) for members in of_layout.sets]
    scores = of_layout.scores(data)
    assert len(of_layout.sets) == 1 + 5 + 10
    assert scores[:-1] - scores[0] == pytest.approx(np.array(expected) - expected[0], abs=1e-9)
    J, wide = np.hstack([of_layout.design.jacobian[:, :1], of_layout.heat]), np.full(3, np.inf)
    lowest = np.array([low, -np.inf, -np.inf])
    of_heat = posterior(J.T @ J, J.T @ data, np.array([stated.sd, 1.0, 1.0]), lowest, wide).log_evidence
    assert scores[-1] - scores[0] == pytest.approx(of_heat + math.log(0.025) - expected[0], abs=1e-9)


def test_the_bounds_of_base_numbers_count_in_the_evidence() -> None:
    # The base number's best value lies beyond its bound unless an effect that resembles it acts.
    stated = replace(STATED, high=0.05)
    shapes = {"first": 5.0 * T**0.6, "second": np.sin(6 * T)}
    candidates = tuple(effect(name) for name in shapes)
    of_layout = layout(shapes, candidates, stated=stated)
    data = of_layout.design.jacobian @ np.array([0.04, 1.0, 0.0]) + np.random.default_rng(7).normal(size=len(T))
    linear = LinearModel(of_layout.design, data)
    for members in [(), candidates[:1], candidates[1:], candidates]:
        unknowns = [stated, *(each.amplitudes[0] for each in members)]
        J = of_layout.design.jacobian[:, of_layout.design.columns(unknowns)]
        sd, low, high = (np.array([getattr(each, name) for each in unknowns]) for name in ("sd", "low", "high"))
        expected = posterior(J.T @ J, J.T @ data, sd, low, high).log_evidence
        assert linear.log_evidence(members) == pytest.approx(expected, abs=1e-9), members
    gain = linear.log_evidence(candidates[:1]) - linear.log_evidence(())
    unbounded = LinearModel(layout(shapes, candidates).design, data)
    assert gain > unbounded.log_evidence(candidates[:1]) - unbounded.log_evidence(()) + 1.0


def test_the_probability_of_one_effect_is_its_closed_form() -> None:
    # Without the base number's share: P = 1 - J (J^T J + 1/s^2)^-1 J^T.
    of_layout, data = single(4.0), np.random.default_rng(2).normal(size=len(T)) + 3.0 * T**2
    J, x = of_layout.design.jacobian[:, :1], of_layout.design.jacobian[:, 1]
    P = np.eye(len(T)) - J @ np.linalg.inv(J.T @ J + np.eye(1) / STATED.sd**2) @ J.T
    g, b, s = x @ P @ x, x @ P @ data, 2.0
    log_odds = b**2 / (2 * (g + 1 / s**2)) - math.log(1 + s**2 * g) / 2 + math.log(0.375 / 0.5)
    assert of_layout.probabilities(data)[1] == pytest.approx(float(expit(log_odds)), rel=1e-6)


@pytest.fixture(scope="module")
def calibration() -> Calibration:
    return calibrate(alike(), 600, 3, study="alike", sensors=["crown"], runs=["slow"], draws=4000)


def test_probabilities_and_ranks_of_a_right_model_are_calibrated(calibration: Calibration) -> None:
    assert calibration.best_sets.p_value > 0.01
    assert calibration.effects.p_value > 0.01
    assert min(calibration.amplitudes.p_value, calibration.base_numbers.p_value, calibration.misfits.p_value) > 0.01
    # Many statements are uncertain ones, so the agreement says something.
    assert sum(0.3 < case.stated < 0.9 for case in calibration.cases) > 100
    assert sum(case.outside for case in calibration.cases) > 3


def test_wrong_probabilities_and_ranks_are_noticed() -> None:
    rng = np.random.default_rng(4)
    right = rng.uniform(size=500) < 0.7
    assert Reliability.of([0.7] * 500, right).p_value > 0.01
    overconfident = Reliability.of([0.9] * 500, right)
    assert overconfident.error == pytest.approx(0.9 - right.mean(), abs=1e-12)
    (row,) = overconfident.to_dict()["bins"]
    assert (row["stated"], row["of"]) == (pytest.approx(0.9), 500)
    assert overconfident.p_value < 0.001
    # A prior that is three times too narrow pulls every amplitude towards zero.
    wide, narrow = single(1.0, 3.0), single(1.0, 1.0)
    (early,) = wide.candidates
    (of_narrow,) = narrow.candidates
    ranks = {"right": [], "narrow": []}  # type: ignore[var-annotated]
    while len(ranks["right"]) < 200:
        case = drawn(wide, rng)
        if case.place != 1:
            continue
        fitted, _ = readings(wide, case, rng)
        ranks["right"] += posterior_ranks(wide.fit(fitted, np.zeros(0), (early,)), case.values, [early.unknowns[0]])
        fit = narrow.fit(fitted, np.zeros(0), (of_narrow,))
        ranks["narrow"] += posterior_ranks(fit, {of_narrow.unknowns[0]: case.values[early.unknowns[0]]},
            [of_narrow.unknowns[0]])  # fmt: skip
    assert RankTest.of(ranks["right"]).p_value > 0.01
    assert RankTest.of(ranks["narrow"]).p_value < 1e-3


def test_without_held_out_runs_heat_of_unknown_origin_is_drawn_too(tmp_path: Any) -> None:
    owner = study(tmp_path).replace({"mesh.size": "12 mm", "measured": []})
    of_layout = linear_layout(owner, planned_sensitivities(owner))
    heat = DrawnCause(-1, (), {}, np.ones(len(of_layout.heat_sd)))
    fitted, held_out = readings(of_layout, heat, np.random.default_rng(1))
    assert len(fitted) == len(of_layout.heat)
    assert len(held_out) == 0


def test_the_same_seed_gives_the_same_cases(calibration: Calibration) -> None:
    again = calibrate(alike(), 40, 3, draws=0)
    assert [case.stated for case in again.cases] == [case.stated for case in calibration.cases[:40]]


def test_false_alarms_come_as_often_as_stated() -> None:
    settings = replace(DEFAULT, rejected_p=0.05, largest_pull=2.0)
    of_layout = layout({"early": T**2}, (effect("early"),), settings)
    alarms = false_alarms(of_layout, 6000, 1)
    assert alarms["misfit"].agrees, alarms
    assert alarms["held-out runs"].agrees, alarms
    # With one base number its pull is normal, and Satterthwaite's approximation exact.
    assert alarms["all pulls"].agrees, alarms
    J = of_layout.design.jacobian[:, 0] * STATED.sd
    spread = math.sqrt(J @ J / (1 + J @ J))
    assert Frequency(alarms["a pull"].count, 6000, math.erfc(2.0 / spread / math.sqrt(2))).agrees
    assert alarms["any of them"].count >= max(each.count for name, each in alarms.items() if name != "any of them")


def test_without_held_out_runs_nothing_is_told_of_them() -> None:
    of_layout = layout({"early": T**2}, (effect("early"),))
    alone = replace(of_layout, held_out=of_layout.held_out[:0], heat_held_out=of_layout.heat_held_out[:0])
    calibration = calibrate(alone, 4, 1, draws=50)
    assert list(calibration.alarms) == ["misfit", "a pull", "all pulls", "any of them"]
    assert not any("held-out" in line for line in calibration.words())


def test_intervals_of_a_frequency() -> None:
    # Nothing in n cases: 1 - 0.025^(1/n).
    assert Frequency(0, 50).interval == pytest.approx((0.0, 1 - 0.025 ** (1 / 50)))
    assert Frequency(50, 50).interval == pytest.approx((0.025 ** (1 / 50), 1.0))
    assert not Frequency(0, 50, 0.2).agrees


def test_the_conformal_threshold_covers_what_it_says() -> None:
    # Of exchangeable scores the k-th smallest of n covers a new one with probability k/(n + 1).
    rng, n = np.random.default_rng(5), 39
    covered = sum(rng.uniform() <= conformal_threshold(rng.uniform(size=n)) for _ in range(3000))
    assert Frequency(covered, 3000, math.ceil(40 * COVERAGE) / 40).agrees
    assert conformal_threshold([0.2] * 18) == 1.0, "95 % need 19 cases"


def test_conformal_sets_hold_the_true_set_in_fresh_cases(calibration: Calibration) -> None:
    for name, held in calibration.coverage.items():
        assert held.of > 30, name
        assert held.interval[1] >= COVERAGE, (name, held)
    assert calibration.coverage["all"].share > 0.92
    assert 1 < calibration.sizes["an effect leads"] < len(alike().sets) / 2


def test_a_calibration_is_read_for_its_own_layout(calibration: Calibration, tmp_path: Any) -> None:
    write_json(calibration.to_dict(), tmp_path / "calibration.json")
    known = read_calibration(tmp_path, "alike", ["crown"], ["slow"])
    assert known.thresholds == pytest.approx(calibration.thresholds)
    with pytest.raises(InputError, match=r"another layout: its sensors are crown; those of alike are bead"):
        read_calibration(tmp_path, "alike", ["bead"], ["slow"])
    with pytest.raises(InputError, match=r"another layout: it has 1 run, alike has 2"):
        read_calibration(tmp_path, "alike", ["crown"], ["slow", "fast"])
    with pytest.raises(InputError, match=r"--calibrate 1000"):
        read_calibration(tmp_path / "none", "alike", ["crown"], ["slow"])
    (tmp_path / "calibration.json").write_text("[1]", encoding="utf-8")
    with pytest.raises(InputError, match="is no calibration"):
        read_calibration(tmp_path, "alike", ["crown"], ["slow"])


def test_the_conformal_set_in_words() -> None:
    of_layout = alike()
    judgement = of_layout.judge(9.0 * T + np.random.default_rng(6).normal(size=len(T)), np.zeros(15))
    first, second, third, *_ = judgement.ranking
    threshold = first.probability + second.probability / 2
    assert conformal_sets(judgement.ranking, threshold) == (first, second)
    assert conformal_sets(judgement.ranking, 0.0) == (first,)
    assert len(conformal_sets(judgement.ranking, first.probability + second.probability)) == 3
    check = {"held": 288, "of": 300}
    known = ConformalCalibration("alike", (), (), 0.95, {"an effect leads": threshold}, {"an effect leads": check})
    assert known.words(judgement.ranking) == (
        f"It is one of these two sets: {first.key}; {second.key} "
        "(95 % wanted; such sets held the true one in 288 of 300 fresh cases)."
    )
    assert third.probability < second.probability
    pair = next(entry for entry in judgement.ranking if len(entry.members) == 2)
    alone = next(entry for entry in judgement.ranking if entry.members == pair.members[:1])
    both = (replace(alone, score=0.0, probability=0.6), replace(pair, score=-1.0, probability=0.4))
    of_both = replace(known, thresholds={"an effect leads": 0.9})
    assert of_both.words(both).endswith(f"fresh cases). All of them have {alone.key}.")


def test_a_diagnosis_with_a_calibration_states_its_conformal_set(case: Any, tmp_path: Any) -> None:
    sensors = list(case.study.sensors)
    groups = ("an effect leads", "no effect leads")
    record = {
        "study": "study",
        "layout": {"sensors": sensors, "runs": ["1", "2", "3"]},
        "conformal": {
            "coverage_wanted": 0.95,
            "thresholds": dict.fromkeys(groups, 0.99),
            "fresh_cases": {name: {"held": 480, "of": 500} for name in groups},
        },
    }
    write_json(record, tmp_path / "calibration.json")
    options = {"known": case.diagnosis.gap.responses, "rerun": False, "settings": HASTY}
    diagnosis = case.study.diagnose(calibration=tmp_path, **options)
    sentence = "It is this set: hot-road (95 % wanted; such sets held the true one in 480 of 500 fresh cases)."
    assert sentence in verdict_words(diagnosis)
    conformal = diagnosis.to_dict()["conformal"]
    assert (conformal["sets"], conformal["threshold"]) == (["hot-road"], 0.99)
    assert case.diagnosis.to_dict()["conformal"] is None
    write_json({**record, "layout": {"sensors": sensors[1:], "runs": ["1", "2", "3"]}}, tmp_path / "other.json")
    with pytest.raises(InputError, match="belongs to another layout"):
        case.study.diagnose(calibration=tmp_path / "other.json", **options)
