"""Inputs of variants as functions of the varied numbers: as those of their studies, or not used at all."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from tyrefem import study
from tyrefem.reduced.answers import learnt_outcomes, outcomes_of
from tyrefem.reduced.balance import matrices_of
from tyrefem.reduced.error_estimate import PARTS, SAFETY_FACTOR, TAU, estimated_errors
from tyrefem.reduced.learnt_balance import learnt_inputs
from tyrefem.reduced.learnt_inputs import LearntInputs
from tyrefem.reduced.model import ReducedModel
from tyrefem.reduced.packed_model import ReducedTask, pack, perform_reduced
from tyrefem.reduced.separated import NotSeparableError, separated
from tyrefem.reduced.surrogate import surrogate
from tyrefem.reduced.variant import Variant
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.variants.outcomes import Answered
from tyrefem.variants.plan import Plan, plan_of

Array = NDArray[np.float64]
BOX = {
    "drive.speed": ("12 mph", "25 mph"),
    "drive.load": ("2200 lbf", "3200 lbf"),
    "drive.pressure": ("75 psi", "95 psi"),
    "drive.ambient": ("10 degC", "30 degC"),
    "materials.tread.loss_tangent.value": {"factor": [0.7, 1.3]},
    "materials.tread.specific_heat.value": {"factor": [0.8, 1.2]},
    "materials.tread.density.value": {"factor": [0.9, 1.1]},
}


@pytest.fixture(scope="module")
def plan() -> Plan:
    coarse = study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "drive.duration": "300 s", "output.every": "10 s"})
    return plan_of(coarse, BOX, sample="sobol", count=1024)


@pytest.fixture(scope="module")
def model(plan: Plan) -> ReducedModel:
    """Trained for far more variants than the tests answer, so its inputs are learnt."""
    return surrogate(plan, tolerance=0.05).model


@pytest.fixture(scope="module")
def inputs(model: ReducedModel) -> LearntInputs:
    assert model.inputs is not None
    return model.inputs


def _as_studies(model: ReducedModel, plan: Plan, count: int) -> tuple[object, ...]:
    packed = pack(replace(model, inputs=None), plan.packed)
    return perform_reduced(ReducedTask(plan.variants[:count]), packed)


def test_answers_and_estimates_are_those_of_variants_made_as_studies(model: ReducedModel, plan: Plan) -> None:
    learnt = learnt_outcomes(model, plan.variants[:48], None)
    assert learnt is not None
    for first, second in zip(learnt, _as_studies(model, plan, 48), strict=True):
        assert isinstance(first, Answered)
        assert isinstance(second, Answered)
        assert list(first.answers) == list(second.answers)
        for name, value in second.answers.items():
            if isinstance(value, str):
                assert first.answers[name] == value
            else:
                assert first.answers[name] == pytest.approx(value, rel=1e-6, abs=1e-6), name
        assert first.error == pytest.approx(second.error, abs=1e-6)


def test_a_task_uses_them(model: ReducedModel, plan: Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    tyre_of = ReducedModel.tyre
    monkeypatch.setattr(ReducedModel, "tyre", lambda self, changed: made.append(changed) or tyre_of(self, changed))
    perform_reduced(ReducedTask(plan.variants[:40]), pack(model, plan.packed))
    # The two that are compared.
    assert len(made) == 2


def test_their_evaluations_are_few(inputs: LearntInputs) -> None:
    # Load and pressure do not separate; all else is a sum or a product.
    assert inputs.entries.evaluations < 256
    assert {len(part.numbers) for array in inputs.entries.arrays.values() for part in array.parts} == {1, 2}


def test_few_variants_are_made_as_studies(model: ReducedModel, plan: Plan) -> None:
    assert learnt_inputs(model, plan.varied, 100) is None
    # Enough for the numbers one by one, not for the pair.
    assert learnt_inputs(model, plan.varied, 400) is None


def test_places_are_those_of_the_box_alone(inputs: LearntInputs, plan: Plan) -> None:
    variant = dict(plan.variants[7])
    place = inputs.place(variant)
    assert place is not None
    assert ((place > 0) & (place < 1)).all()
    assert inputs.place(variant | {"drive.speed": "26 mph"}) is None
    assert inputs.place(variant | {"boundaries.contained_air.film": "5 W/m**2/K"}) is None
    assert inputs.place({name: value for name, value in variant.items() if name != "drive.load"}) is None


def test_inputs_that_are_not_those_of_the_studies_are_not_used(
    model: ReducedModel, inputs: LearntInputs, plan: Plan
) -> None:
    name = "body bead 0"
    wrong = replace(inputs.entries.arrays[name], centre=1.001 * inputs.entries.arrays[name].centre)
    entries = replace(inputs.entries, arrays={**inputs.entries.arrays, name: wrong})
    off = replace(model, inputs=replace(inputs, entries=entries))
    assert learnt_outcomes(off, plan.variants[:4], None) is None
    outcomes = perform_reduced(ReducedTask(plan.variants[:4]), pack(off, plan.packed))
    for first, second in zip(outcomes, _as_studies(model, plan, 4), strict=True):
        assert isinstance(first, Answered)
        assert isinstance(second, Answered)
        assert first.answers == second.answers


@pytest.mark.parametrize(
    "box",
    [
        {"sensors.crown-inner.depth": ("3 mm", "5 mm")},
        {"materials.tread.loss_tangent.value": [0.1, 0.2]},
        {"drive.duration": ("200 s", "300 s")},
    ],
    ids=["sensors", "values", "phases"],
)
def test_what_is_no_steady_number_is_not_learnt(model: ReducedModel, plan: Plan, box: Mapping[str, object]) -> None:
    assert learnt_inputs(model, plan_of(plan.study, box, sample="grid").varied, 1000) is None


def test_ramps_are_not_learnt(model: ReducedModel, plan: Plan) -> None:
    ramp = plan.study.replace({"drive.speed": {"from": "10 mph", "to": "25 mph"}})
    other = replace(model, base=RollingTyre(ramp, model.base))
    box = plan_of(ramp, {"drive.ambient": BOX["drive.ambient"]}, sample="grid").varied
    assert learnt_inputs(other, box, 1000) is None


def _function(of: Callable[[Array], Mapping[str, Array]]) -> Callable[[Array], tuple[Array, Mapping[str, Array]]]:
    return lambda x: (x, of(x))


def test_sums_products_and_pairs_are_learnt() -> None:
    def arrays(x: Array) -> dict[str, Array]:
        return {
            "sum": np.array([np.exp(x[0]) + x[1] ** 2, 3.0]),
            "product": np.array(np.sqrt(1 + x[0]) * (2 - x[2])),
            "pair": np.array(np.cos(x[0] * x[1]) * (1 + x[2])),
        }

    learnt = separated(_function(arrays), 3)
    points = np.random.default_rng(5).random((20, 3))
    values = learnt(points)
    for name in values:
        exact = np.array([arrays(x)[name] for x in points])
        assert np.abs(values[name] - exact).max() < 1e-9
    assert [part.numbers for part in learnt.arrays["pair"].parts] == [(2,), (0, 1)]


@pytest.mark.parametrize(
    "of",
    [
        lambda x: {"kink": np.array(abs(x[0] - 0.3))},
        lambda x: {"three": np.array(np.exp(x[0] * x[1] * x[2]))},
        lambda x: {"corner": np.array(1.0 + (x[0] > 0.7) * (x[1] > 0.7) * (x[2] != 0.5))},
    ],
    ids=["kink", "three at once", "corner"],
)
def test_other_functions_are_refused(of: Callable[[Array], Mapping[str, Array]]) -> None:
    with pytest.raises(NotSeparableError):
        separated(_function(of), 3)


def test_the_estimate_is_the_implicit_step_on_all_modes(model: ReducedModel, plan: Plan) -> None:
    tyre = model.tyre(plan.study.replace(plan.variants[3]))
    ((_, variant),) = outcomes_of(model, [tyre])
    assert isinstance(variant, Variant)
    solution = variant.readout.solution
    balance = solution.batch.balances[0]
    whole = balance.on(model.enriched)
    (M,), (K,) = matrices_of([whole])
    m, size = model.size, model.enriched.size
    times = PARTS * tyre.drive.end * (1 - 1e-9)
    steps = []
    for t, y, rate in zip(times, solution.states(times)[:, 0], solution.slopes(times)[:, 0], strict=True):
        films, sinks = whole.coefficients(float(t))
        A = K + np.tensordot(films, whole.stack, axes=1)
        embedded, change = (np.concatenate([each[:m], np.zeros(size - m), each[m:]]) for each in (y, rate))
        heat = (films * sinks) @ whole.loads
        heat[:size] += model.enriched.load @ balance.source(float(t), y[:m])
        right = heat - A @ embedded - M @ change
        steps.append(np.linalg.solve(M / (TAU * tyre.drive.end) + A, right))
    hot = np.vstack(list(model.enriched.hot_rows.values()))
    largest = max(np.abs(hot @ step[:size]).max() for step in steps)
    errors = estimated_errors(solution)
    assert errors is not None
    # The table of tan delta is linear between its points; sensors may exceed the hottest nodes.
    assert errors[0] >= SAFETY_FACTOR * largest * 0.999
    assert errors[0] <= SAFETY_FACTOR * max(np.abs(model.enriched.V @ step[:size]).max() for step in steps) * 1.001
