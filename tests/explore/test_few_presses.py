"""Strain laws by finite elements: training repeats a few load cases, and workers share those of the tables."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import tyrefem
from tyrefem.api import Study
from tyrefem.realtime.box_runs import FullHistory, SettingTask, perform_history
from tyrefem.realtime.default_box import default_box
from tyrefem.realtime.drive_inputs import drive_inputs
from tyrefem.realtime.few_presses import FewPresses, few_presses, shared_pairs
from tyrefem.realtime.settings import TablePoints
from tyrefem.realtime.tables import Probe
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.variants.plan import Plan, plan_of
from tyrefem.variants.samples import changes_at
from tyrefem.variants.schedulers import Here

VARY = {
    "drive.speed": ("10 mph", "30 mph"),
    "drive.load": ("2400 lbf", "3000 lbf"),
    "drive.pressure": ("80 psi", "90 psi"),
    "materials.tread.loss_tangent.value": {"factor": [0.7, 1.3]},
}


@pytest.fixture(scope="module")
def pressed() -> Study:
    changes = {"mesh.size": "15 mm", "mesh.through": 1, "mechanics.strain": "fem", "mechanics.motion": "linear"}
    return tyrefem.study("nasa-22x5.5-8pr", {**changes, "drive.duration": "60 s"})


@pytest.fixture(scope="module")
def plan(pressed: Study) -> Plan:
    return plan_of(pressed, VARY, sample="sobol", count=1)


@pytest.fixture(scope="module")
def few(plan: Plan) -> FewPresses:
    return few_presses(plan, np.random.default_rng(1))


@pytest.mark.fast
def test_load_and_pressure_change_the_strain_cycle_and_tan_delta_does_not(few: FewPresses) -> None:
    assert few.numbers == (1, 2)
    assert few.patterns.tolist() == [[0.0, 0.0], [0.0, 1.0], [0.5, 0.5], [1.0, 0.0], [1.0, 1.0]]


@pytest.mark.fast
def test_training_has_few_load_cases_and_keeps_all_other_numbers(few: FewPresses, plan: Plan) -> None:
    places = list(np.random.default_rng(2).random((32, 4)))
    repeated = few.repeated(places)
    cases = [
        tuple(changes_at(plan.varied, place)[key] for key in ("drive.load", "drive.pressure")) for place in repeated
    ]
    assert len(set(cases)) == 5
    # Equal cases stand together, so that a worker solves each once.
    assert sum(a != b for a, b in pairwise(cases)) == 4
    others = [0, 3]
    np.testing.assert_array_equal(np.array(repeated)[:, others], np.array(places)[:, others])


def test_tables_of_the_workers_are_those_of_one_process(plan: Plan) -> None:
    changes = changes_at(plan.varied, [0.5] * 4)
    box, base = drive_inputs(plan.study, plan.varied).box(), RollingTyre(plan.study)
    probe = Probe(plan.study.replace(changes), box, base, TablePoints(speed=3, bend=2, pressure=2))
    ticks: list[tuple[int, int]] = []
    shared = shared_pairs(Here(), plan.packed, changes, box, lambda done, total: ticks.append((done, total)))
    alone, together = probe.tables(), probe.tables(shared)
    np.testing.assert_allclose(together.heat, alone.heat, rtol=1e-12)
    np.testing.assert_allclose(together.films, alone.films, rtol=1e-12)
    assert ticks == [(1, 2), (2, 2)]


def test_the_model_is_certified_with_load_and_pressure(pressed: Study) -> None:
    model = pressed.explore(VARY, tolerance=1.0)
    assert model.certificate.worst < 1.0
    place = np.array([0.3, 0.4, 0.7, 0.2])
    full = perform_history(SettingTask(model.plan.packed, changes_at(model.plan.varied, place)))
    assert isinstance(full, FullHistory)
    assert model.solve(model.numbers(place)).answers["hottest_degC"] == pytest.approx(
        full.answers["hottest_degC"], abs=1
    )


@pytest.mark.fast
def test_the_default_box_leaves_out_rubber_that_the_strain_law_reads() -> None:
    radial = tyrefem.study("passenger-205-55r16")
    box = default_box(radial)
    assert "materials.body-ply.loss_tangent.value" not in box
    assert {"materials.body-ply.conductivity.value", "materials.tread.loss_tangent.value", "drive.load"} <= set(box)
    # No equilibrium in large motion far from the study's own load and pressure.
    assert box["drive.load"] == {"from": "3600 N", "to": "6100 N"}
    assert box["drive.pressure"] == {"from": "170 kPa", "to": "250 kPa"}
    assert few_presses(plan_of(radial, box, sample="sobol", count=1), np.random.default_rng(0)).numbers == (1, 2)
