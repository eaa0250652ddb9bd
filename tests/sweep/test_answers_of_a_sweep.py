"""What a table of variants says: limits, the Pareto front, tolerances, indices, the envelope."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pytest

from tyrefem import study
from tyrefem.errors import InputError
from tyrefem.studies import Study
from tyrefem.sweep.envelope import envelope
from tyrefem.sweep.indices import indices, indices_plan
from tyrefem.sweep.pareto import front, undominated
from tyrefem.sweep.plan import plan_of
from tyrefem.sweep.sweep import Sweep, sweep
from tyrefem.sweep.tornado import tornado, tornado_plan


@pytest.fixture(scope="module")
def tyre() -> Study:
    return study("nasa-22x5.5-8pr", {"mesh.size": "12 mm", "numerics.tolerance": "0.5 K", "drive.duration": "120 s"})


@pytest.fixture(scope="module")
def swept(tyre: Study) -> Sweep:
    plan = plan_of(
        tyre,
        {"drive.speed": ("10 mph", "30 mph", 3), "materials.tread.loss_tangent.value": ["0.1", "0.3"]},
        limits={"hottest_degC": {"below": 40.0}},
        time_to="35 degC",
    )
    return sweep(plan)


def test_every_variant_is_the_run_of_its_study(swept: Sweep, tyre: Study) -> None:
    row = swept.table.iloc[3]
    alone = tyre.replace({"drive.speed": "20 mph", "materials.tread.loss_tangent.value": "0.3"}).run()
    assert row["hottest_degC"] == pytest.approx(alone.history.maximum.temperature, abs=1e-6)
    assert row["rolling_resistance_coefficient"] == pytest.approx(alone.rolling_resistance.coefficient, rel=1e-9)
    assert row["contained-air_degC"] == pytest.approx(float(alone.gas_temperature[-1]), abs=1e-6)
    shares = [name for name in swept.table if name.endswith("_share") and name.startswith(("lost", "stored"))]
    assert row[shares].sum() == pytest.approx(1.0, abs=1e-3)


def test_limits_say_what_is_feasible(swept: Sweep) -> None:
    assert (swept.table["feasible"] == (swept.table["hottest_degC"] < 40.0)).all()
    assert 0 < swept.table["feasible"].sum() < len(swept.table)


def test_hotter_variants_reach_a_temperature_sooner(swept: Sweep) -> None:
    reached = swept.table.dropna(subset=["time_to_limit_s"]).sort_values("hottest_degC")
    assert len(reached) >= 2
    assert (np.diff(reached["time_to_limit_s"]) < 0).all()
    assert (swept.table["time_to_limit_s"].isna() == (swept.table["hottest_degC"] < 35.0)).all()


def test_one_failing_variant_is_recorded_and_the_sweep_goes_on(tyre: Study) -> None:
    # Each value alone is possible; together the load is more than the tyre carries at that pressure.
    plan = plan_of(tyre, {"drive.load": ["2000 lbf", "5000 lbf"], "drive.pressure": ["60 psi", "156 psi"]})
    found = sweep(plan)
    assert found.complete
    assert len(found.failed) + int((found.table["failure"] == "").sum()) == 4


@pytest.mark.parametrize("count", [1, 40])
def test_the_front_beats_everything_else(count: int) -> None:
    values = np.random.default_rng(1).random((count, 3))
    kept = undominated(values)
    for i in range(count):
        beaten = any((values[j] <= values[i]).all() and (values[j] < values[i]).any() for j in range(count))
        assert kept[i] == (not beaten)


def test_front_knows_what_is_better_and_refuses_unknown_answers(swept: Sweep) -> None:
    best = front(swept.table, {"hottest_degC": "min"})
    assert best["hottest_degC"].tolist() == [swept.table["hottest_degC"].min()]
    most = front(swept.table.assign(feasible=True), {"hottest_degC": "max"})
    assert most["hottest_degC"].tolist() == [swept.table["hottest_degC"].max()]
    with pytest.raises(InputError, match="did you mean 'hottest_degC'"):
        front(swept.table, {"hotest_degC": "min"})


def test_tornado_moves_every_number_alone(tyre: Study) -> None:
    given = {"materials.tread.loss_tangent.value": 0.2, "materials.carcass.loss_tangent.value": 0.1}
    found = tornado(sweep(tornado_plan(tyre, given)), "hottest_degC")
    assert set(found["number"]) == set(given)
    assert (found["more"] > 0).all()
    assert (found["less"] < 0).all()
    assert found["range"].is_monotonic_decreasing


class _Formula:
    """Answers by a formula in place of runs: its Sobol indices are known."""

    def outcomes(self, work: Any, tasks: Any) -> Any:
        for place, task in enumerate(tasks):
            x = float(task.changes["drive.speed"].split()[0])
            y = float(task.changes["drive.ambient"].split()[0])
            yield place, {"answers": {"hottest_degC": 2.0 * x + y}}


def test_indices_of_a_sum_are_its_shares_of_variance(tyre: Study) -> None:
    plan = plan_of(tyre, {"drive.speed": ("10 m/s", "11 m/s"), "drive.ambient": ("10 degC", "11 degC")})
    wanted = indices_plan(tyre, plan.varied, 256)
    found = indices(sweep(wanted, scheduler=_Formula(), reduced="never"), "hottest_degC").set_index("number")
    assert found.loc["drive.speed", "first"] == pytest.approx(0.8, abs=0.02)
    assert found.loc["drive.ambient", "total"] == pytest.approx(0.2, abs=0.02)


class _Heating:
    """A tyre whose temperature is 20 + speed x load."""

    def outcomes(self, work: Any, tasks: Any) -> Any:
        for place, task in enumerate(tasks):
            speed = float(task.changes["drive.speed"].split()[0])
            load = float(task.changes["drive.load"].split()[0])
            yield place, {"answers": {"hottest_degC": 20.0 + speed * load}}


def test_the_envelope_ends_where_the_limit_is_reached(tyre: Study) -> None:
    found = envelope(tyre, ["2 kN", "5 kN", "1000 kN"], ["500 kPa"], limit=120.0, scheduler=_Heating())
    speeds = found.table["speed_m_s"].tolist()
    assert speeds[0] == pytest.approx(50.0, rel=0.01)
    assert speeds[1] == pytest.approx(20.0, rel=0.01)
    assert np.isnan(speeds[2])
    assert found.table["at_limit"].tolist() == [True, True, False]
    assert found.runs < 30


def test_an_empty_sweep_has_an_empty_table(tyre: Study) -> None:
    plan = plan_of(tyre, {"drive.speed": ("10 mph", "30 mph", 3)})
    assert isinstance(Sweep(plan, {}).table, pd.DataFrame)
    assert Sweep(plan, {}).table.empty
