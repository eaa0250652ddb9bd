"""Effects that move no reading beyond the discrepancy are not named, however sure."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from formula import STATED, Array, case, effect
from hidden import RUNS
from hidden import Case as HiddenCase

from tyrefem.diagnose.data.runs import MeasuredDrive, MeasuredSensor
from tyrefem.diagnose.fitting.criterion import LogEvidence
from tyrefem.diagnose.fitting.exhaustive import Exhaustive
from tyrefem.diagnose.fitting.materiality import largest_change, movements
from tyrefem.diagnose.fitting.selection import SelectionProblem
from tyrefem.diagnose.unknowns.candidates import SetPrior
from tyrefem.diagnose.verdicts.verdict import IDENTIFIED, NO_GAP, Judgement, judge, ranked, without_immaterial
from tyrefem.diagnose.words.sentences import verdict_words

N = 400
T = np.linspace(0.0, 1.0, N)
SHAPES = {"large": 8.0 * T**2, "small": np.where(T > 0.5, 1.0, 0.0)}


def law(values: Mapping[str, float]) -> Array:
    heat = 10.0 * values.get(STATED.key, 0.0) * np.sqrt(T)
    return np.asarray(heat + sum(values.get(name, 0.0) * shape for name, shape in SHAPES.items()))


def judged(hidden: Mapping[str, float], floor: float) -> tuple[Judgement, list[str]]:
    """Readings with unit noise, 400 of them: an effect of 0.8 is clear, though it moves less than the noise."""
    candidates = tuple(effect(name) for name in SHAPES)
    made = case(law, law(hidden) + np.random.default_rng(4).normal(size=N), candidates)
    prior = SetPrior(candidates, 0.5)
    problem = SelectionProblem(made.residuals, made.predictions, candidates, prior, LogEvidence())
    ranking = ranked(problem.settled(Exhaustive().search(problem)))
    after, left_out = without_immaterial(ranking, lambda fit: movements(made.residuals, made.predictions, fit), floor)
    assert sum(row.probability for row in after) == pytest.approx(1.0)
    assert {row.members for row in after} == {row.members for row in ranking}
    assert after[0].fit is not None
    after = (replace(after[0], fit=problem.settled_fit(after[0].fit)), *after[1:])
    return judge(after, lambda members: None), [member.key for member in left_out]


def test_an_effect_below_the_floor_is_no_gap() -> None:
    named, _ = judged({"small": 0.8}, floor=0.1)
    assert (named.verdict, named.best.key) == (IDENTIFIED, "small")
    silent, left_out = judged({"small": 0.8}, floor=1.5)
    assert silent.verdict == NO_GAP
    assert "small" in left_out
    assert silent.named.get("small", 0.0) < 0.01


def test_a_small_companion_is_not_named_beside_a_large_effect() -> None:
    hidden = {"large": 1.5, "small": 0.8}
    both, _ = judged(hidden, floor=0.1)
    assert (both.verdict, both.best.key) == (IDENTIFIED, "large + small")
    alone, left_out = judged(hidden, floor=1.5)
    assert (alone.verdict, alone.best.key) == (IDENTIFIED, "large")
    assert left_out == ["small"]
    # The probability of the pair went to its part.
    assert alone.best.probability > 0.99


def test_what_an_effect_moves_stands_in_record_and_words(case: HiddenCase) -> None:
    (move,) = case.diagnosis.movements.values()
    assert move.sensor == "crown-outer"
    assert move.run in RUNS
    # The road is 25 K warmer; the tread next to it follows by a part of that.
    assert 2.0 < move.kelvin < 25.0
    record = json.loads((case.folder / "verdict.json").read_text(encoding="utf-8"))
    assert record["effects"][0]["moves"] == {"largest_K": move.kelvin, "sensor": move.sensor, "run": move.run}
    assert f"moves readings by up to {move.kelvin:+.1f} K (crown-outer, {move.run})" in verdict_words(case.diagnosis)[0]


def test_an_effect_without_which_no_tyre_is_possible_is_told_without_kelvins() -> None:
    drive = MeasuredSensor("crown", np.arange(2.0), 1.0, 0.0, 1.0, 2, measured=np.zeros(2))
    runs = (MeasuredDrive("fast", {}, False, (drive,)),)
    move = largest_change(runs, [np.array([1.0, np.nan])])
    assert move.words == "cannot be left out, as no tyre can be computed without it (fast)"
    assert largest_change(runs, [np.array([1.0, -2.0])]).words == "moves readings by up to -2.0 K (crown, fast)"
