"""Candidates, criterion and strategy: forward selection against the exhaustive search, on readings by formulas."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pytest
from formula import STATED, Array, Case, case, effect

import tyrefem as tf
from tyrefem.diagnose.fitting.criterion import BIC, Criterion, LogEvidence
from tyrefem.diagnose.fitting.exhaustive import Exhaustive
from tyrefem.diagnose.fitting.forward_selection import ForwardSelection, _Progress
from tyrefem.diagnose.fitting.selection import ScoredSet, SelectionProblem, Strategy, rivals_of_names, sets_of
from tyrefem.diagnose.settings import DEFAULT, DiagnosisSettings
from tyrefem.diagnose.unknowns.candidates import Members, SetPrior
from tyrefem.errors import InputError
from tyrefem.inputs.study import StudyData

N = 60
T = np.linspace(0.0, 1.0, N)
STRATEGIES: tuple[Strategy, ...] = (ForwardSelection(), Exhaustive())
CRITERIA: tuple[Criterion, ...] = (LogEvidence(), BIC())


def linear_law(shapes: Mapping[str, Array]) -> Any:
    """Readings that are linear in every amplitude."""

    def law(values: Mapping[str, float]) -> Array:
        heat = 5.0 * values.get(STATED.key, 0.0) * T
        return np.asarray(heat + sum(values.get(name, 0.0) * shape for name, shape in shapes.items()))

    return law


def problem_of(made: Case, candidates: Members, criterion: Criterion) -> SelectionProblem:
    prior = SetPrior(candidates, 0.5)
    return SelectionProblem(made.residuals, made.predictions, candidates, prior, criterion)


def searched(
    shapes: Mapping[str, Array],
    measured: Array,
    strategy: Strategy,
    criterion: Criterion = CRITERIA[0],
    largest: int = 2,
    **settings: Any,
) -> list[ScoredSet]:
    candidates = tuple(effect(name) for name in shapes)
    made = case(linear_law(shapes), measured, candidates, DiagnosisSettings(largest=largest, **settings))
    return strategy.search(problem_of(made, candidates, criterion))


def names(scored: Sequence[ScoredSet]) -> set[str]:
    return {member.name for member in scored[0].members}


#: Five effects as a tyre has them: at once, slowly, in the middle of the drive, at its end, swinging.
SHAPES = {
    "step": np.where(T > 0.1, 6.0, 0.0),
    "slow": 8.0 * T**2,
    "middle": 6.0 * np.exp(-(((T - 0.5) / 0.15) ** 2)),
    "end": 7.0 * np.where(T > 0.8, T - 0.8, 0.0) * 5,
    "swing": 4.0 * np.sin(12.0 * T),
}


@pytest.mark.parametrize("criterion", CRITERIA, ids=lambda item: type(item).__name__)
@pytest.mark.parametrize("hidden", [(), ("middle",), ("slow", "swing"), ("step", "end")], ids="+".join)
def test_forward_and_exhaustive_search_find_what_is_hidden(hidden: tuple[str, ...], criterion: Criterion) -> None:
    noise = np.random.default_rng(4).normal(size=N)
    measured = linear_law(SHAPES)({STATED.key: 0.1} | dict.fromkeys(hidden, 1.5)) + noise
    forward, exhaustive = (searched(SHAPES, measured, strategy, criterion) for strategy in STRATEGIES)
    assert names(forward) == names(exhaustive) == set(hidden)
    # Both have fitted the best set to convergence: the same score.
    assert forward[0].fit is not None
    assert forward[0].score == pytest.approx(exhaustive[0].score, abs=1e-6)
    # Exhaustive is what it says: no effect, 5 single effects, 10 pairs.
    assert sum(entry.fit is not None for entry in exhaustive) == 16
    assert sum(entry.fit is not None for entry in forward) < 16


def hiding() -> dict[str, Array]:
    """Two effects that nearly cancel, and four that look like what is left of them, but not quite."""
    large, left = 30.0 * np.cos(3.0 * T), 2.0 * np.sin(9.0 * T)
    odd = {"first": np.sin(17.0 * T), "second": np.cos(13.0 * T), "third": np.cos(21.0 * T), "fourth": np.sin(25.0 * T)}
    alike = {name: 8.0 * (np.sin(9.0 * T) + 0.4 * shape) for name, shape in odd.items()}
    return {"warming": large + left, "cooling": left - large, **alike}


def test_effects_that_hide_each_other_are_found_where_another_one_would_be_named() -> None:
    shapes = hiding()
    noise = np.random.default_rng(6).normal(size=N)
    measured = linear_law(shapes)({"warming": 4.0, "cooling": 4.0}) + noise
    forward, exhaustive = (searched(shapes, measured, strategy) for strategy in STRATEGIES)
    assert names(exhaustive) == names(forward) == {"warming", "cooling"}
    # Growing sets alone miss the pair, each of which explains little.
    grown = searched(shapes, measured, ForwardSelection(), name_rounds=0)
    assert names(grown) != {"warming", "cooling"}
    assert exhaustive[0].score > grown[0].score + 10
    # What was not fitted does not stand above what was.
    assert grown[0].fit is not None


def test_a_base_number_that_imitates_an_effect_does_not_hide_it() -> None:
    # The base number bends: at 0.3 it looks like the effect at 1.6 but for a ripple, at 0.15 it does not. About the fit
    # of no effect the linear model sees nothing to gain; about x = 0 it does.
    times = np.linspace(0.0, 1.0, 400)
    bend, ripple = 40.0 * np.sin(9.0 * times), 0.75 * np.cos(40.0 * np.pi * times)
    imitated = 12.0 * times + 0.3**2 * bend
    shapes = {"strong": (imitated + ripple) / 1.6, "idle": np.sin(25.0 * times)}

    def law(values: Mapping[str, float]) -> Array:
        base = values.get(STATED.key, 0.0)
        heat = 40.0 * base * times + base**2 * bend
        return np.asarray(heat + sum(values.get(name, 0.0) * shape for name, shape in shapes.items()))

    candidates = tuple(effect(name) for name in shapes)
    made = case(law, law({"strong": 1.6}) + np.random.default_rng(2).normal(size=400), candidates)
    problem = problem_of(made, candidates, CRITERIA[0])
    (none,) = problem.continued(problem.fitted([()], {}))
    assert none.close
    assert none.p_value < problem.settings.usual_p
    about = problem.linear_about(none, candidates)
    assert about.log_evidence(candidates[:1]) < about.log_evidence(())
    scored = ForwardSelection().search(problem)
    assert names(scored) == {"strong"}
    assert scored[0].fit is not None
    assert scored[0].fit.p_value > 0.05


def test_sensitivities_at_the_fit_of_no_effect_show_what_those_at_x_0_do_not() -> None:
    # The base number imitates the effect at 0.3. There the effect acts in another way than at 0, as a worn tread does.
    times = np.linspace(0.0, 1.0, 400)
    bend, ripple = 40.0 * np.sin(9.0 * times), 0.75 * np.cos(40.0 * np.pi * times)
    shape, coupled = (12.0 * times + 0.3**2 * bend + ripple) / 1.6, 0.3 * bend / 1.6

    def law(values: Mapping[str, float]) -> Array:
        base, strong = values.get(STATED.key, 0.0), values.get("strong", 0.0)
        return np.asarray(40.0 * base * times + base**2 * bend + strong * (shape + base * coupled))

    candidates = (effect("strong"), effect("idle"))
    made = case(law, law({"strong": 1.6}) + np.random.default_rng(2).normal(size=400), candidates)
    problem = problem_of(made, candidates, CRITERIA[0])
    (none,) = problem.continued(problem.fitted([()], {}))
    gains = []
    for fit in (none, problem.with_sensitivities(none)):
        about = problem.linear_about(fit, candidates)
        gains.append(about.log_evidence(candidates[:1]) - about.log_evidence(()))
    assert gains[0] < 0
    assert gains[1] > 10
    scored = ForwardSelection().search(problem)
    assert names(scored) == {"strong"}
    assert scored[0].fit is not None
    assert scored[0].fit.p_value > 0.05


def test_an_effect_that_is_impossible_at_a_fit_keeps_its_sensitivities_at_x_0() -> None:
    # As two channels that are swapped already, or a tread worn through.
    def law(values: Mapping[str, float]) -> Array:
        base, more = values.get(STATED.key, 0.0), values.get("impossible", 0.0)
        return np.asarray(5.0 * base * T + values.get("possible", 0.0) * T**2 + (np.nan if base and more else more) * T)

    candidates = (effect("possible"), effect("impossible"))
    made = case(law, law({STATED.key: 1.0}) + np.random.default_rng(4).normal(size=N), candidates)
    problem = problem_of(made, candidates, CRITERIA[0])
    (none,) = problem.fitted([()], {})
    fit = problem.with_sensitivities(none)
    assert {unknown.key for unknown in fit.state.further} == {"possible"}
    about = problem.linear_about(fit, candidates)
    assert np.isfinite(about.jacobian).all()
    assert np.isfinite(about.log_evidence(candidates))


def test_a_name_is_held_against_the_best_set_without_it() -> None:
    # The true effect bends upwards: its slope at 0 promises 14 nats less than an imitation by another effect.
    times = np.linspace(0.0, 1.0, 400)
    shape, ripple = np.sin(9.0 * times), 0.08 * np.cos(40.0 * np.pi * times)

    def law(values: Mapping[str, float]) -> Array:
        curved, plain = (values.get(name, 0.0) for name in ("curved", "plain"))
        heat = 5.0 * values.get(STATED.key, 0.0) * times
        return np.asarray(heat + (0.3 * curved + 0.9 * curved**2) * shape + plain * (shape + ripple))

    candidates = tuple(effect(name, low=0.0) for name in ("curved", "plain"))
    measured = law({"curved": 2.0}) + np.random.default_rng(3).normal(size=400)
    for rounds, found in ((0, "plain"), (2, "curved")):
        made = case(law, measured, candidates, DiagnosisSettings(name_rounds=rounds))
        prior = SetPrior(candidates, 0.5)
        problem = SelectionProblem(made.residuals, made.predictions, candidates, prior, CRITERIA[0])
        # As if no other set had been worth a fit.
        progress = _Progress(problem)
        progress.fit([(), candidates[1:]])
        for _ in range(rounds):
            rivals = rivals_of_names(progress.scored(), problem.settings)
            progress.fit(rivals, {members: start for members, start in rivals.items() if start is not None})
        assert names(progress.scored()) == {found}


def test_too_many_sets_are_refused_in_one_sentence() -> None:
    candidates = tuple(effect(f"effect-{number}") for number in range(30))
    study, settings = tf.study("nasa-22x5.5-8pr"), DiagnosisSettings(largest=2)
    with pytest.raises(InputError, match=r"would fit 466 sets of up to 2 effects; allowed: 300"):
        Exhaustive().check(study, candidates, settings)
    Exhaustive().check(study, candidates[:23], settings)
    ForwardSelection().check(study, candidates, settings)


@pytest.mark.parametrize("strategy", STRATEGIES, ids=lambda item: type(item).__name__)
def test_every_single_effect_has_a_score_and_the_best_has_a_fit(strategy: Strategy) -> None:
    noise = np.random.default_rng(7).normal(size=N)
    scored = searched(SHAPES, linear_law(SHAPES)({"slow": 2.0}) + noise, strategy)
    assert [entry.score for entry in scored] == sorted((entry.score for entry in scored), reverse=True)
    assert {entry.members[0].name for entry in scored if len(entry.members) == 1} == set(SHAPES)
    assert next(entry for entry in scored if not entry.members).fit is not None


@pytest.mark.parametrize("criterion", CRITERIA, ids=lambda item: type(item).__name__)
def test_a_criterion_of_a_linear_problem_is_the_same_by_fit_and_by_linear_model(criterion: Criterion) -> None:
    measured = linear_law(SHAPES)({"slow": 1.0, "swing": 0.5}) + np.random.default_rng(9).normal(size=N)
    candidates = tuple(effect(name) for name in SHAPES)
    made = case(linear_law(SHAPES), measured, candidates)
    problem = problem_of(made, candidates, criterion)
    sets = [(), candidates[1:2], candidates[1:5:3]]
    fits = problem.continued(problem.fitted(sets, {}))
    linear = made.residuals.linear([0])
    by_linear = criterion.of_linear(linear, sets) + linear.constant
    assert [criterion.of_fit(fit) for fit in fits] == pytest.approx(by_linear.tolist(), abs=1e-3)


def test_bic_counts_a_parameter_as_half_the_logarithm_of_the_readings() -> None:
    # An effect that changes no reading: the misfit stays, only its parameter counts.
    candidates = (effect("idle"),)
    made = case(lambda values: 0.0 * T, np.random.default_rng(1).normal(size=N), candidates)
    problem = problem_of(made, candidates, BIC())
    none, idle = problem.fitted([(), candidates], {})
    assert BIC().of_fit(none) - BIC().of_fit(idle) == pytest.approx(np.log(N) / 2, abs=1e-9)


class Alone:
    """A strategy of somebody else: single effects only, in the linear model, and no effect fitted."""

    def check(self, study: StudyData, candidates: Members, settings: DiagnosisSettings) -> None:
        """Takes any number."""

    def search(self, problem: SelectionProblem) -> list[ScoredSet]:
        (none,) = problem.continued(problem.fitted([()], {}))
        singles = problem.fitted(list(sets_of(problem.candidates, 1)), {})
        fits = [none, *singles]
        return sorted((ScoredSet(problem.score(fit), fit.members, fit) for fit in fits), key=lambda entry: -entry.score)


def test_a_strategy_is_any_object_with_a_search() -> None:
    noise = np.random.default_rng(2).normal(size=N)
    assert names(searched(SHAPES, linear_law(SHAPES)({"end": 2.0}) + noise, Alone())) == {"end"}


def test_settings_are_checked_and_frozen() -> None:
    with pytest.raises(InputError, match="largest: must be a number of effects from 1 to 3, not 4"):
        DiagnosisSettings(largest=4)
    with pytest.raises(InputError, match="looks: must be a whole number of at least 1"):
        DiagnosisSettings(looks=0)
    with pytest.raises(AttributeError):
        DEFAULT.batch = 1  # type: ignore[misc]
