"""Strain cycles by finite elements over a box, learnt from presses: their error, the certificate, the way back."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem import study
from tyrefem.api import Study
from tyrefem.errors import InputError
from tyrefem.reduced.learnt_cycles import Press, learnt, mechanical_numbers, press_count, press_of
from tyrefem.reduced.packed_model import ReducedTask, pack, perform_reduced
from tyrefem.reduced.surrogate import Surrogate, surrogate, temperature_error
from tyrefem.reduced.training import ReducedFineness
from tyrefem.reduced.training_rounds import Training
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.variants.outcomes import Answered
from tyrefem.variants.plan import Plan, plan_of
from tyrefem.variants.schedulers import Here
from tyrefem.variants.task import perform

BOX = {"drive.pressure": ("78 psi", "92 psi"), "materials.tread.loss_tangent.value": {"factor": [0.8, 1.2]}}


@pytest.fixture(scope="module")
def tyre() -> Study:
    quick = {"mesh.size": "15 mm", "drive.duration": "100 s", "output.every": "20 s"}
    return study("nasa-22x5.5-8pr", {"mechanics.strain": "fem", "mechanics.motion": "linear", **quick})


@pytest.fixture(scope="module")
def plan(tyre: Study) -> Plan:
    return plan_of(tyre, BOX, sample="sobol", count=24)


@pytest.fixture(scope="module")
def trained(plan: Plan) -> Surrogate:
    return surrogate(plan, tolerance=0.3)


def test_only_what_a_press_reads_is_learnt(tyre: Study, plan: Plan) -> None:
    """Pressure changes the footprint, tan delta and speed do not."""
    assert [plan.varied[n].key for n in mechanical_numbers(plan.study, plan.varied)] == ["drive.pressure"]
    speeds = plan_of(tyre, {"drive.speed": ("10 mph", "20 mph"), "section.crown_radius": ("3.4 in", "3.6 in")})
    assert [speeds.varied[n].key for n in mechanical_numbers(tyre, speeds.varied)] == ["section.crown_radius"]
    # Lists of phases have load cases of their own: every variant is pressed.
    phases = [[{"name": "roll", "duration": "60 s"}], [{"name": each, "duration": "60 s"} for each in ("roll", "on")]]
    of_phases = plan_of(tyre, {"drive.pressure": ("78 psi", "92 psi"), "drive.phases": phases})
    assert mechanical_numbers(tyre, of_phases.varied) == []
    arcs = tyre.replace({"mechanics.strain": "arcs"})
    assert mechanical_numbers(arcs, plan_of(arcs, BOX).varied) == []


def test_learnt_energies_are_those_of_a_fresh_press(trained: Surrogate, tyre: Study) -> None:
    cycles, base = trained.model.cycles, trained.model.base
    assert cycles is not None
    assert len(cycles.places) >= press_count(1)
    fresh = tyre.replace({"drive.pressure": "83.7 psi"})
    exact, learnt_schedule = press_of(RollingTyre(fresh, base)), cycles.schedule(fresh)
    (case,), (cycle,) = learnt_schedule.cases[0], learnt_schedule.cycles[0]
    energies = np.concatenate([cycle.energies[zone.name] for zone in cycles.zones])
    assert np.sqrt(((energies - exact.energies[0]) ** 2).mean()) < 0.03 * np.sqrt((exact.energies[0] ** 2).mean())
    load, deflection, _, area, radius = exact.contacts[0]
    assert case.load == load
    assert case.deflection == pytest.approx(deflection, rel=5e-3)
    assert case.contact.area == pytest.approx(area, rel=5e-2)
    assert case.contact.rolling_radius == pytest.approx(radius, rel=1e-3)
    with pytest.raises(InputError, match="nodes of the mesh only"):
        cycle.energy_density(cycles.zones[0].name, np.zeros((2, 3)))


def test_presses_of_full_runs_certify_them(trained: Surrogate, plan: Plan) -> None:
    certificate = trained.certificate
    assert certificate.good
    assert certificate.energies is not None
    outcomes = perform_reduced(ReducedTask(plan.variants[3:5]), pack(trained.model, plan.packed))
    for number, outcome in enumerate(outcomes, 3):
        assert isinstance(outcome, Answered)
        assert outcome.error is not None
        full = perform(plan.task(number)).answers
        assert temperature_error(outcome.answers, full) < 0.3
        assert temperature_error(outcome.answers, full) <= certificate.error_of(outcome.error)
        assert outcome.answers["rolling_resistance_N"] == pytest.approx(full["rolling_resistance_N"], rel=2e-2)


def test_where_the_energies_are_not_learnt_every_variant_is_pressed(plan: Plan) -> None:
    """A tolerance far below the presses' noise: two batches of presses, then the strain law itself."""
    reported: list[tuple[str, int]] = []
    training = Training(
        plan, Here(), ReducedFineness(), lambda what, done, total: reported.append((what, total)), seed=1
    )
    training.run([np.zeros(2), np.ones(2)], 1.0, "training", with_answers=False)
    training.learn_cycles(1e-7)
    assert training.cycles is None
    assert reported.count(("pressing", press_count(1))) == 2 * press_count(1)
    training.learn_cycles(1.0)
    assert training.cycles is not None


def test_a_quadratic_field_is_learnt_exactly(trained: Surrogate) -> None:
    cycles, base = trained.model.cycles, trained.model.base
    assert cycles is not None
    places = np.linspace(0.0, 1.0, 7)[:, None]
    n = sum(cycles.sizes)
    presses = [
        Press(np.full((1, n), 1e4) * (1 + u + 2 * u**2), np.array([[1e4, 0.02 * (1 + u), 0.1, 0.01, 0.3]]))
        for u in places[:, 0]
    ]
    exact = learnt(base, cycles.varied, places, presses)
    assert exact.error < 2e-2
    middle = base.study.replace({"drive.pressure": "85 psi"})
    schedule = exact.schedule(middle)
    assert schedule.cycles[0][0].energies[cycles.zones[0].name] == pytest.approx(2e4)  # type: ignore[attr-defined]
    assert schedule.cases[0][0].deflection == pytest.approx(0.03)
