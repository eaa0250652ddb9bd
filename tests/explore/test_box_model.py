"""The model of all settings: as the full model at fresh settings, as the real-time export at each of them."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tyrefem
from tyrefem.api import Exploration, Study
from tyrefem.errors import InputError
from tyrefem.realtime.box_certificate import differences, is_temperature
from tyrefem.realtime.box_checks import limited_answers
from tyrefem.realtime.box_model import explored as explored_box
from tyrefem.realtime.box_runs import FullHistory, SettingTask, perform_history, perform_skin, series_of
from tyrefem.realtime.default_box import default_box
from tyrefem.realtime.drive_inputs import drive_inputs, inputs_of
from tyrefem.realtime.export import write
from tyrefem.realtime.inputs import NAMES
from tyrefem.realtime.setting_tyre import step_lengths
from tyrefem.realtime.tyre import Inputs, RealTimeTyre
from tyrefem.reduced.training import Snapshots
from tyrefem.reports.explore_data import changes_of_file
from tyrefem.variants.answers import answer_names
from tyrefem.variants.plan import plan_of
from tyrefem.variants.samples import changes_at

pytestmark = pytest.mark.fast


def test_fresh_full_runs_agree_within_the_certificate(explored: Exploration) -> None:
    worst = 0.0
    for place in np.random.default_rng(77).random((3, len(explored.plan.varied))):
        task = SettingTask(explored.plan.packed, changes_at(explored.plan.varied, place))
        full = perform_history(task)
        assert isinstance(full, FullHistory)
        errors = differences(explored.solve(explored.numbers(place)), full)
        worst = max(worst, *(error for name, error in errors.items() if is_temperature(name)))
        assert errors["rolling_resistance_N"] < 0.01 * full.answers["rolling_resistance_N"]
        for way in ("lost: rim", "lost: outside air", "generated: tread"):
            assert errors[way] < 0.03 * np.abs(full.series[way]).max() + 0.5
    assert worst < explored.certificate.tolerance
    assert explored.certificate.worst <= explored.certificate.tolerance


def test_the_error_of_the_coefficient_is_that_of_the_whole_drive(explored: Exploration) -> None:
    """As that of the force: the page shows both over time."""
    place = np.full(len(explored.plan.varied), 0.9)
    full = perform_history(SettingTask(explored.plan.packed, changes_at(explored.plan.varied, place)))
    assert isinstance(full, FullHistory)
    errors = differences(explored.solve(explored.numbers(place)), full)
    assert errors["rolling_resistance"] > 1.01 * errors["rolling_resistance_N"]
    ratio = errors["rolling_resistance"] / errors["rolling_resistance_coefficient"]
    assert ratio == pytest.approx(full.answers["load_N"], rel=0.01)


def test_the_skin_of_a_drive_of_half_a_second() -> None:
    """All phases are shorter than the first time after a jump at which the skin is taken."""
    short = {"mesh.size": "20 mm", "drive.duration": "0.5 s"}
    plan = plan_of(tyrefem.study("nasa-22x5.5-8pr", short), {"drive.ambient": ["10 degC", "30 degC"]})
    skin = perform_skin(SettingTask(plan.packed, plan.variants[0]))
    assert isinstance(skin, Snapshots)
    assert len(skin.fields) == len(skin.sources) == 1


def test_a_drive_to_rest_has_the_rolling_resistance_of_a_run() -> None:
    """At its last reading before rest, not at the end of the phase before, or at the start."""
    phases = [
        {"name": "start", "speed": "10 m/s", "duration": "20 s"},
        {"name": "to rest", "speed": {"from": "10 m/s", "to": "0 m/s"}, "duration": "100 s"},
    ]
    drive = {"load": "2700 lbf", "pressure": "83 psi", "phases": phases}
    study = tyrefem.study("nasa-22x5.5-8pr", {"mesh.size": "20 mm", "drive": drive})
    box = explored_box(study, {"drive.ambient": ("24 degC", "26 degC")})
    answers, resistance = box.solve(box.numbers([0.5])).answers, study.run().rolling_resistance
    assert answers["rolling_resistance_N"] == pytest.approx(resistance.force, rel=1e-3)
    assert answers["rolling_resistance_coefficient"] == pytest.approx(resistance.coefficient, rel=1e-3)
    assert box.certificate.errors["rolling_resistance_N"] < 0.001 * resistance.force


def test_the_arrays_are_those_of_the_real_time_export(explored: Exploration, tmp_path: Path) -> None:
    """`RealTimeTyre` marches the arrays of the box's middle, in steps of its own, to the same temperatures."""
    number = np.array([n.number(0.5) for n in explored.plan.varied])
    solution = explored.solve(number)
    names = [*explored.about["read"], "contained-air", "hottest", "gas_pressure", "rolling_resistance"]
    box = {name: [-1e9, 1e9] for name in NAMES}
    outputs = [{"name": name, "unit": ""} for name in names]
    about = {"outputs": outputs, "box": box, "initial": solution.coefficients.initial}
    # Only numbers of the middle stand in the plain arrays: tan delta and films of the box's middle.
    tyre = RealTimeTyre(write(tmp_path / "tyre.npz", explored.arrays, about))
    tyre.reset()
    now = np.zeros(len(names))
    for second in range(120):
        now = tyre.step(1.0, Inputs(*solution.inputs(second + 0.5).tolist()))
        if second in (9, 79):
            shown = solution.at(second + 1.0)
            computed = dict(zip(tyre.names, now.tolist(), strict=True))
            for name in ("skin", "deep", "rim", "contained-air", "hottest"):
                assert computed[name] == pytest.approx(shown[name], abs=0.05), (second, name)
            assert computed["gas_pressure"] == pytest.approx(shown["gas_pressure"], abs=30)
            assert computed["rolling_resistance"] == pytest.approx(shown["rolling_resistance"], rel=2e-3)


def test_heat_flows_close_with_what_bodies_store(explored: Exploration) -> None:
    """Generated - lost = capacity x rate of temperature, from the states alone."""
    solution = explored.solve(explored.numbers([0.3] * len(explored.plan.varied)))
    arrays, reduced = explored.arrays, explored.reduced
    rows = np.array(list(reduced.stored_row.values())) @ arrays["turn"][: reduced.size, : reduced.size]
    capacity = 2.0 * solution.coefficients.bodies[:, 2]
    stored = [float(capacity @ rows @ solution.state(t)[: reduced.size]) for t in (39.5, 40.5)]
    assert stored[1] - stored[0] == pytest.approx(solution.at(40.0)["stored"], rel=0.02)


def test_numbers_beside_the_drive_act_as_in_the_study(explored: Exploration) -> None:
    middle = explored.numbers([0.5] * len(explored.plan.varied))
    keys = [number.key for number in explored.plan.varied]

    def changed(key: str, value: float) -> dict[str, float]:
        numbers = middle.copy()
        numbers[keys.index(key)] = value
        return explored.solve(numbers).at(80.0)

    base = explored.solve(middle).at(80.0)
    more_loss = changed("materials.tread.loss_tangent.value", 1.3)
    assert more_loss["generated: tread"] == pytest.approx(1.3 * base["generated: tread"], rel=0.03)
    assert more_loss["generated: sidewall"] == pytest.approx(base["generated: sidewall"], rel=1e-3)
    assert changed("boundaries.road.coefficient", 2000.0)["skin"] > base["skin"]
    assert changed("drive.load", 3200.0)["rolling_resistance"] > 1.1 * base["rolling_resistance"]


def test_inputs_follow_the_numbers(small: Study) -> None:
    plan = plan_of(
        small, {"drive.speed": ("10 mph", "30 mph"), "drive.ambient": ("50 degF", "104 degF")}, sample="sobol", count=1
    )
    inputs = drive_inputs(small, plan.varied)
    phases, initial = inputs.at(np.array([25.0, 68.0]))
    exact, start = inputs_of(small.replace({"drive.speed": "25 mph", "drive.ambient": "68 degF"}))
    np.testing.assert_allclose(phases, exact, rtol=1e-7, atol=1e-7)
    assert initial == pytest.approx(start) == pytest.approx(20.0)
    ranges = inputs.box().ranges
    assert ranges["speed"] == pytest.approx((4.4704, 13.4112))
    assert ranges["road_temperature"] == pytest.approx((10.0, 40.0))


def test_steps_fill_their_phase() -> None:
    for duration in (0.5, 7.0, 60.0, 600.0, 10_800.0):
        for ramp in (False, True):
            lengths = step_lengths(duration, ramp=ramp)
            assert sum(lengths) == pytest.approx(duration)
            assert all(b <= 2.001 * a for a, b in pairwise(lengths))
            assert len(lengths) <= 70


def test_default_box_holds_the_study_and_its_measured_runs(small: Study) -> None:
    box = default_box(small)
    assert {"drive.speed", "drive.load", "drive.pressure", "drive.ambient", "drive.road_temperature"} <= set(box)
    assert {"materials.tread.loss_tangent.value", "boundaries.road.coefficient"} <= set(box)
    plan = plan_of(small, box, sample="sobol", count=1)
    by_key = {number.key: number for number in plan.varied}
    for value in ("20 mph", "12 mph"):
        assert by_key["drive.speed"].contains(value)
    assert by_key["drive.pressure"].contains("90 psi")
    ranges = drive_inputs(small, plan.varied).box().ranges
    assert ranges["load"][0] < 2500 * 4.448 < 2700 * 4.448 < ranges["load"][1]


def test_limits_are_of_answers_that_a_page_computes(explored: Exploration) -> None:
    start = [number.number(0.5) for number in explored.plan.varied]
    computed = set(explored.solve(start).answers)
    assert set(limited_answers(explored.plan.study)) == computed & set(answer_names(explored.plan.study))


@pytest.mark.parametrize(
    ("vary", "options", "message"),
    [
        ({"materials.tread": ["nasa-tread", "rubber-tread-aircraft"]}, {}, "a list has no slider"),
        ({"drive.phases.rolling.duration": ("60 s", "90 s")}, {}, "a duration has no slider"),
        ({"drive.phases.rolling.duration": ("60 s", "90 s")}, {}, "Sliders move speed, load, pressure"),
        ({"mesh.size": ("12 mm", "14 mm")}, {}, "vary.mesh.size: has no slider: it needs another mesh"),
        ({"mechanics.strain": ["arcs", "barrel"]}, {}, "a list has no slider"),
        ({"drive.sped": ("10 mph", "20 mph")}, {}, "speed"),
        ({"drive.speed": ("10 mph", "20 mph")}, {"axes": ("drive.load", "drive.speed")}, "'drive.load' does not vary"),
        (
            {"drive.speed": ("10 mph", "20 mph")},
            {"axes": ("drive.speed", "drive.speed")},
            "axes: must be two different",
        ),
        ({"drive.speed": ("10 mph", "20 mph")}, {"axes": "drive.speed"}, "axes: must be two different numbers"),
        ({"drive.speed": ("10 mph", "20 mph")}, {"tolerance": 1e-4}, "numerics.tolerance"),
        ({"drive.speed": ("10 mph", "20 mph")}, {"limits": {"hotest_degC": {"below": 1}}}, "hottest_degC"),
        (
            {"drive.speed": ("10 mph", "20 mph")},
            {"limits": {"mass_kg": {"below": 9}}},
            "limits: 'mass_kg' is an answer of a sweep only, a page does not compute it; allowed: hottest_degC, ",
        ),
    ],
)
def test_what_cannot_be_explored_is_refused(small: Study, vary: dict, options: dict, message: str) -> None:
    with pytest.raises(InputError) as refused:
        small.explore(vary, **options)
    assert message in str(refused.value)


def test_a_deflection_is_refused(small: Study) -> None:
    bent = small.replace({"drive.deflection": "1 in"})
    with pytest.raises(InputError, match="needs a load"):
        bent.explore({"drive.speed": ("10 mph", "20 mph")})


def test_the_study_may_choose(small: Study) -> None:
    chosen = small.replace(
        {
            "explore": {
                "vary": {"drive.speed": {"from": "15 mph", "to": "20 mph"}},
                "limits": {"hottest_degC": {"below": 35}},
                "tolerance": "1 delta_degC",
            }
        }
    )
    model = chosen.explore()
    assert [number.key for number in model.plan.varied] == ["drive.speed"]
    assert model.plan.limits["hottest_degC"].below == 35
    assert model.certificate.tolerance == 1.0
    with pytest.raises(InputError, match="explore"):
        small.replace({"explore": {"vary": {"drive.sped": {"from": "15 mph", "to": "20 mph"}}}}).explore()


def test_a_case_of_a_campaign_is_needed() -> None:
    with pytest.raises(InputError, match="campaign"):
        tyrefem.study("nasa-campaign").explore()


def test_what_differs_from_the_file_is_known_by_dotted_names(small: Study) -> None:
    lumped = {"law": "fixed"}
    changed = small.replace(
        {"drive.load": "2500 lbf", "boundaries.rim": lumped, "drive.phases.rolling.duration": "70 s"}
    )
    changes = changes_of_file(changed)
    assert set(changes) == {"mesh.size", "drive.load", "drive.phases", "boundaries.rim"}
    assert Study.load(str(small.file), changes).data == changed.data
    assert changes_of_file(Study.load(str(small.file))) == {}


@pytest.mark.parametrize(
    "entry", [("10 mph", "30 mph", 3), {"from": "10 mph", "to": "30 mph", "levels": 3}], ids=["tuple", "mapping"]
)
def test_a_slider_has_no_levels(small: Study, entry: Any) -> None:
    with pytest.raises(InputError, match=r"vary\.drive\.speed: a slider has no levels"):
        small.explore({"drive.speed": entry})
    nested = small.replace({"explore": {"vary": {"drive": {"speed": {"from": "10 mph", "to": "30 mph", "levels": 3}}}}})
    with pytest.raises(InputError, match=r"explore\.vary\.drive\.speed: a slider has no levels"):
        nested.explore()


def test_at_a_jump_the_outputs_of_a_full_run_are_those_before_it() -> None:
    """As `Solution.at` has them; else the certificate states the jump of the pressure as an error."""
    pressures = {"first": "83 psi", "second": "90 psi"}
    phases = [{"name": name, "duration": "10 s", "pressure": pressure} for name, pressure in pressures.items()]
    coarse = {"mesh.size": "12 mm", "mesh.through": 1, "mesh.element": "P1", "numerics.tolerance": "0.5 delta_degC"}
    result = tyrefem.study("nasa-22x5.5-8pr", {**coarse, "drive.phases": phases}).run()
    jump = int(np.searchsorted(result.times, 10.0))
    assert result.times[jump] == 10.0
    pressure = series_of(result)["gas_pressure"]
    assert pressure[jump] == pytest.approx(pressure[jump - 1], rel=1e-3)
    assert pressure[jump + 1] - pressure[jump] == pytest.approx(7 * 6894.757, rel=0.02)
