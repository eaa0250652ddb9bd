"""A reduced model against full runs: within its certificate inside its box, refused or left alone elsewhere."""

from __future__ import annotations

import gc
import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import simpson

from tyrefem import study
from tyrefem.api import Study
from tyrefem.reduced.answers import reduced_answers, reduced_outcomes
from tyrefem.reduced.balance import reduced_balance
from tyrefem.reduced.model import NotReducibleError
from tyrefem.reduced.packed_model import ReducedTask, pack, perform_reduced
from tyrefem.reduced.readout import Readout
from tyrefem.reduced.surrogate import Surrogate, surrogate, temperature_error
from tyrefem.reduced.variant import Variant
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.run import run
from tyrefem.simulation.simulate import output_times
from tyrefem.sweep.sweep import Sweep, sweep
from tyrefem.variants.answers import answers
from tyrefem.variants.execution import SweepSettings
from tyrefem.variants.outcomes import Answered, NotReducible
from tyrefem.variants.plan import Plan, plan_of
from tyrefem.variants.task import perform

BOX = {
    "drive.speed": ("12 mph", "25 mph"),
    "drive.load": ("2200 lbf", "3200 lbf"),
    "materials.carcass.conductivity.value": ("0.18 W/m/K", "0.3 W/m/K"),
}


@pytest.fixture(scope="module")
def tyre() -> Study:
    return study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "drive.duration": "300 s", "output.every": "10 s"})


@pytest.fixture(scope="module")
def plan(tyre: Study) -> Plan:
    return plan_of(tyre, BOX, sample="sobol", count=40, time_to="40 degC")


@pytest.fixture(scope="module")
def trained(plan: Plan) -> Surrogate:
    return surrogate(plan, tolerance=0.01)


@pytest.fixture(scope="module")
def variants(trained: Surrogate, plan: Plan) -> list[Variant]:
    studies = [plan.study.replace(plan.variants[number]) for number in (5, 17, 30)]
    outcomes = [reduced for _, reduced in reduced_outcomes(trained.model, studies)]
    assert [type(outcome) for outcome in outcomes] == [Variant] * 3
    return outcomes  # type: ignore[return-value]


def test_a_batch_that_is_answered_is_forgotten(trained: Surrogate, plan: Plan) -> None:
    packed, task = pack(trained.model, plan.packed), ReducedTask(plan.variants[:3], plan.time_to)

    def readouts() -> int:
        assert all(isinstance(outcome, Answered) for outcome in perform_reduced(task, packed))
        gc.collect()
        return sum(type(thing) is Readout for thing in gc.get_objects())

    assert readouts() == readouts() == readouts()


def test_fresh_full_runs_are_met_within_the_tolerance(trained: Surrogate, plan: Plan) -> None:
    assert trained.certificate.good
    packed = pack(trained.model, plan.packed)
    for number in (3, 29):
        reduced = perform_reduced(ReducedTask([plan.variants[number]], plan.time_to), packed)[0].answers
        full = perform(plan.task(number)).answers
        assert set(reduced) == set(full)
        assert temperature_error(reduced, full) < 0.01
        assert reduced["rolling_resistance_N"] == pytest.approx(full["rolling_resistance_N"], rel=1e-3)
        assert reduced["time_to_limit_s"] == pytest.approx(full["time_to_limit_s"], abs=0.1)
        assert reduced["hottest_region"] == full["hottest_region"]
        assert reduced["lost_road contact_share"] == pytest.approx(full["lost_road contact_share"], abs=1e-4)


def test_answers_are_those_of_the_whole_result(variants: list[Variant]) -> None:
    for variant in variants:
        light, whole = answers(variant, 40.0), answers(variant.result, 40.0)
        assert list(light) == list(whole)
        for name, value in light.items():
            # What the tyre loses when cold is summed over sample nodes in place of all.
            close = 1e-4 if name.endswith("_cold") else 1e-9
            assert value == whole[name] if isinstance(value, str) else value == pytest.approx(whole[name], rel=close)


def test_a_reduced_budget_closes(variants: list[Variant]) -> None:
    for variant in variants:
        budget = variant.result.heat_budget
        assert budget.imbalance < 1e-10
        # Energy is the integral of power: by Simpson, but for the first readings, where powers change fast.
        power = budget.power("generated")[5:]
        energy = sum(series for (kind, _), series in budget.energies.items() if kind == "generated")
        assert energy[-1] - energy[5] == pytest.approx(float(simpson(power, x=variant.times[5:])), rel=1e-5)


def test_variants_do_not_depend_on_their_company(trained: Surrogate, plan: Plan) -> None:
    studies = [plan.study.replace(plan.variants[number]) for number in (0, 9, 11)]
    together, alone = trained.answers(studies)[1].answers, trained.answers(studies[1:2])[0].answers
    assert temperature_error(together, alone) < 1e-3


def test_a_sweep_says_how_large_the_error_may_be(plan: Plan) -> None:
    swept: Sweep = sweep(plan, tolerance=0.02)
    assert swept.certificate is not None
    assert (swept.table["by"] == "reduced").all()
    # Every row has its own estimate.
    assert (swept.table["error_K"] > 0).all()
    assert swept.table["error_K"].nunique() == len(swept.table)
    assert swept.table["error_K"].median() < 10 * swept.certificate.tolerance
    assert swept.certificate.worst <= 0.02
    assert swept.certificate.errors["hottest_degC"] <= swept.certificate.worst


def test_the_estimated_error_is_that_of_the_modes_left_out(trained: Surrogate, plan: Plan) -> None:
    """With half of the modes the error against all modes is known: the estimate is above it, by less than 20 times."""
    whole = trained.model
    half = whole.size // 2
    few = replace(whole, V=whole.V[:, :half], further=whole.V[:, half:])
    studies = [plan.study.replace(plan.variants[number]) for number in (2, 11, 23, 35)]
    exact, rough = (reduced_answers(model, studies, None) for model in (whole, few))
    for better, worse in zip(exact, rough, strict=True):
        assert isinstance(better, Answered)
        assert isinstance(worse, Answered)
        true = temperature_error(worse.answers, better.answers)
        assert true > 1e-3
        assert worse.error is not None
        assert true <= worse.error < 20 * true
        # The model with all modes has a smaller estimate of its own.
        assert better.error is not None
        assert better.error < worse.error


def test_an_estimate_is_that_of_the_variant_s_sensors(trained: Surrogate, plan: Plan) -> None:
    """With few modes and a single hot node the sensor decides: 0.14 and 0.75 K at its two places."""
    V, hot = trained.model.V, {"sidewall": trained.model.hot["sidewall"][:1]}
    few = replace(trained.model, V=V[:, :5], further=V[:, 5:], hot=hot)
    places = [{"s": "20 mm", "depth": "1 mm"}, {"s": "50 mm", "depth": "8 mm"}]
    studies = [plan.study.replace({"sensors": {"moved": place}}) for place in places]
    together = [outcome.error for outcome in reduced_answers(few, studies, None)]  # type: ignore[union-attr]
    alone = [reduced_answers(few, [each], None)[0].error for each in studies]  # type: ignore[union-attr]
    assert together == pytest.approx(alone, rel=1e-3)
    assert alone[1] > 2 * alone[0]


def test_readings_of_a_late_clock_are_those_of_the_whole_result(trained: Surrogate, plan: Plan) -> None:
    late = plan.study.replace({"effects": [{"name": "clock-offset", "late": "15 s"}]})
    ((_, variant),) = reduced_outcomes(trained.model, [late])
    assert isinstance(variant, Variant)
    whole = variant.result.readings
    assert np.abs(variant.readings - whole).to_numpy().max() < 1e-6
    assert np.abs(whole["contained-air"] - variant.gas_temperature).max() > 0.5


def test_a_model_without_further_modes_estimates_nothing(trained: Surrogate, plan: Plan) -> None:
    (outcome,) = reduced_answers(replace(trained.model, further=None), [plan.study.replace(plan.variants[1])], None)
    assert isinstance(outcome, Answered)
    assert outcome.error is None


def test_outside_its_box_it_is_not_asked(trained: Surrogate, tyre: Study) -> None:
    inside = tyre.replace({"drive.speed": "20 mph", "drive.load": "2500 lbf"})
    assert isinstance(trained.answers([inside])[0], Answered)
    for key, value in (("drive.speed", "40 mph"), ("drive.load", "1000 lbf")):
        refused = trained.answers([inside.replace({key: value})])[0].reason
        assert key in refused
        assert "box" in refused
    # What the box does not vary at all is as the study has it.
    other = trained.answers([inside.replace({"drive.ambient": "5 degC"})])[0].reason
    assert "drive.ambient" in other
    # A number that the study does not have.
    deflected = trained.answers([inside.replace({"drive.load": None, "drive.deflection": "20 mm"})])[0]
    assert deflected.reason.startswith("drive.load: not set in the study")


def test_a_variant_hotter_than_the_table_of_tan_delta_is_left_to_a_full_run(trained: Surrogate, tyre: Study) -> None:
    """Beyond the table tan delta is constant: a thermal runaway would have an end."""
    warm, hot = (tyre.replace({"drive.initial": f"{T} degC", "drive.ambient": f"{T} degC"}) for T in (60, 420))
    (_, inside), (_, beyond) = reduced_outcomes(trained.model, [warm, hot])
    assert isinstance(inside, Variant)
    reason = "the table of tan delta ends at 400 degC, and its hottest point has 42"
    assert isinstance(beyond, NotReducible)
    assert beyond.reason.startswith(reason)


def test_another_mesh_is_refused(trained: Surrogate, tyre: Study) -> None:
    finer = tyre.replace({"mesh.size": "11 mm"})
    with pytest.raises(NotReducibleError, match="mesh"):
        reduced_balance(trained.model, RollingTyre(finer, trained.model.base))


def test_above_its_tolerance_it_falls_back_to_full_runs(tyre: Study) -> None:
    settings = SweepSettings(trials=1, rounds=1)
    few = plan_of(
        tyre.replace({"drive.duration": "20 s", "mesh.size": "25 mm", "mesh.element": "P1"}),
        {"drive.speed": ("10 mph", "40 mph")},
        sample="sobol",
        count=12,
    )
    swept = sweep(few, tolerance=1e-6, settings=settings)
    assert (swept.table["by"] == "full").all()
    assert swept.certificate is None
    assert "the error in the validation runs is" in swept.why_full
    assert "x 1e-06 K" in swept.why_full
    with pytest.raises(NotReducibleError):
        sweep(few, tolerance=1e-6, reduced="always", settings=settings)


def test_a_tolerance_that_nothing_is_certified_to_costs_no_training(tyre: Study) -> None:
    few = plan_of(tyre, {"drive.speed": ("10 mph", "40 mph")}, sample="sobol", count=16)
    with pytest.raises(NotReducibleError, match=r"certified to 1e-12 K; allowed: 1e-06 K or more"):
        sweep(few, tolerance=1e-12, reduced="always")


@pytest.mark.parametrize(
    ("changes", "key", "ends", "why"),
    [
        ({}, "mesh.size", ("10 mm", "12 mm"), "changes the mesh"),
        ({"mechanics.feedback": {}}, "drive.speed", ("10 mph", "20 mph"), "strain cycles that follow"),
        ({"drive.slip_ratio": "0.1"}, "drive.speed", ("10 mph", "20 mph"), "cannot follow given heat at 'road'"),
    ],
)
def test_what_cannot_be_reduced_says_why(
    tyre: Study, changes: dict[str, object], key: str, ends: tuple[str, str], why: str
) -> None:
    varied = Plan(
        changed := tyre.replace({"drive.duration": "20 s", **changes}),
        plan_of(tyre, {"drive.speed": ends}).varied if key == "drive.speed" else (_named(key),),
        (),
        (),
        {},
        None,
        {},
    )
    assert changed is varied.study
    with pytest.raises(NotReducibleError, match=why):
        surrogate(varied)


def _named(key: str) -> object:
    from tyrefem.variants.varied import Varied

    return Varied(key, "mm", low=10.0, high=12.0)


def test_phases_ramps_and_a_lumped_rim() -> None:
    taxi = study("nasa-taxi-takeoff", {"mesh.size": "25 mm", "output.every": "30 s"})
    phases = [dict(variant) for variant in taxi.data["drive"]["phases"]]
    for variant, seconds in zip(phases, (60, 10, 20, 40), strict=True):
        variant["duration"] = f"{seconds} s"
    short = taxi.replace({"drive.phases": phases})
    plan = plan_of(short, {"materials.tread.loss_tangent.value": {"factor": [0.8, 1.2]}}, sample="sobol", count=12)
    trained = surrogate(plan, tolerance=0.05)
    full = run(plan.study.replace(plan.variants[7]), like=trained.model.base)
    ((_, variant),) = reduced_outcomes(trained.model, [plan.study.replace(plan.variants[7])])
    assert isinstance(variant, Variant)
    assert temperature_error(answers(variant), answers(full)) < 0.05
    assert np.abs(variant.result.history.values - full.history.values).max() < 0.1
    assert variant.result.heat_budget.imbalance < 1e-10
    assert variant.rolling_resistance.phase == full.rolling_resistance.phase


ROLL, REST = {"name": "roll", "duration": "40 s"}, {"name": "rest", "duration": "40 s", "speed": "0 mph"}


@pytest.mark.parametrize(
    ("key", "values"),
    [
        ("boundaries.contained_air", [{"law": "gas"}, {"law": "held", "temperature": "40 degC"}]),
        ("drive.phases", [[ROLL], [ROLL, REST]]),
        ("sensors", [{}, {"crown": {"s": "20 mm", "depth": "2 mm"}}]),
    ],
)
def test_variants_with_and_without_a_reservoir_a_phase_or_a_sensor(key: str, values: list[object]) -> None:
    """Each has another number of unknowns, times or readings than the study."""
    base = study("nasa-22x5.5-8pr", {"mesh.size": "14 mm", "mesh.element": "P1", key: values[0]})
    short = base if key == "drive.phases" else base.replace({"drive.duration": "60 s"})
    plan = plan_of(short, {key: values, "drive.load": ("2200 lbf", "3200 lbf")}, sample="sobol", count=24)
    trained = surrogate(plan, tolerance=0.05)
    studies = [short.replace({key: value, "drive.load": "2900 lbf"}) for value in values]
    for fresh, outcome in zip(studies, trained.answers(studies), strict=True):
        assert isinstance(outcome, Answered)
        full = answers(run(fresh))
        assert outcome.answers.keys() == full.keys()
        assert temperature_error(outcome.answers, full) < 0.05


def test_a_full_section_is_its_half_twice(tyre: Study) -> None:
    whole = tyre.replace({"mesh.section": "full", "drive.duration": "60 s"})
    plan = plan_of(whole, {"drive.ambient": ("15 degC", "25 degC")}, sample="sobol", count=12)
    trained = surrogate(plan, tolerance=0.02)
    both = whole.replace({"drive.ambient": "18 degC"})
    reduced = trained.answers([both])[0].answers
    half = answers(run(both.replace({"mesh.section": "half"})))
    assert reduced["hottest_degC"] == pytest.approx(half["hottest_degC"], abs=0.05)
    assert reduced["heat_J"] == pytest.approx(half["heat_J"], rel=2e-3)


def test_the_hottest_place_is_found_where_training_never_saw_it(trained: Surrogate, plan: Plan) -> None:
    from dataclasses import replace

    studies = [plan.study.replace(plan.variants[2])]
    blind = replace(trained.model, hot={region: dofs[:1] for region, dofs in trained.model.regions.items()})
    ((_, seen),) = reduced_outcomes(trained.model, studies)
    ((_, looked),) = reduced_outcomes(blind, studies)
    assert isinstance(seen, Variant)
    assert isinstance(looked, Variant)
    assert looked.peaks["tyre"].temperature == pytest.approx(seen.peaks["tyre"].temperature, abs=1e-9)
    assert looked.peaks["tyre"].point == seen.peaks["tyre"].point
    assert isinstance(looked.readout, Readout)
    assert np.array_equal(looked.times, output_times(looked.tyre)[0])


def test_a_model_travels_as_arrays(trained: Surrogate, plan: Plan) -> None:
    import pickle

    packed = pickle.loads(pickle.dumps(pack(trained.model, plan.packed)))
    there = perform_reduced(ReducedTask([plan.variants[1]], None), packed)[0].answers
    here = trained.answers([plan.study.replace(plan.variants[1])])[0].answers
    assert temperature_error(there, here) < 1e-9
    assert json.dumps(there)
