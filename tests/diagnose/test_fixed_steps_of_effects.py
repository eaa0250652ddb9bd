"""What an effect changes: fixed steps of a fit, and of synthetic data, say what full runs with error control say."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import tyrefem as tf
from tyrefem.conduction.points import located
from tyrefem.conduction.problem import Conduction
from tyrefem.diagnose.blind.synthetic import backward, theta_steps
from tyrefem.diagnose.forward.fixed_step import fixed_step_run
from tyrefem.diagnose.forward.forward_model import ForwardModel
from tyrefem.diagnose.forward.sampling import DriveSampling, SensorSampling
from tyrefem.diagnose.unknowns.candidates import Candidate, catalogue_candidates
from tyrefem.diagnose.unknowns.unknown import base_unknowns, with_values
from tyrefem.inputs.study import StudyData
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.run import run

Array = NDArray[np.float64]
CAPACITY = "heat-capacity-temperature"


def on_tyre(study: StudyData) -> dict[str, Candidate]:
    """One variant of each effect, by name."""
    candidates = [each for each in catalogue_candidates(study) if not each.unknowns[0].measures]
    return {each.name: each for each in reversed(candidates)}


STUDY = tf.study("hidden-effect").replace(
    {"measured": [], "mesh.size": "8 mm", "mesh.element": "P1", "numerics.tolerance": "0.005 delta_degC"}
)
EFFECTS = on_tyre(STUDY)
GRID = np.arange(0.0, STUDY.card.drive.end, 15.0)


def with_effect(name: str) -> StudyData:
    """The study with one standard deviation of an effect."""
    unknowns = EFFECTS[name].unknowns
    return with_values(STUDY, {each: 1.0 if each.fixed else min(each.sd, 0.9 * each.high) for each in unknowns})


def full(study: StudyData) -> Array:
    """(n_sensors, n_times) degC with error control."""
    readings = run(study).readings
    return np.array([np.interp(GRID, readings["time_s"], readings[name]) for name in STUDY.sensors])


def fixed(study: StudyData) -> Array:
    """The same in the steps of a fit."""
    simulated = fixed_step_run(study)
    return np.array([np.interp(GRID, simulated.grid, simulated.readings[name]) for name in STUDY.sensors])


@pytest.fixture(scope="module")
def unchanged() -> tuple[Array, Array]:
    return full(STUDY), fixed(STUDY)


@pytest.mark.parametrize("name", sorted(EFFECTS))
def test_the_steps_of_a_fit_follow_every_effect(name: str, unchanged: tuple[Array, Array]) -> None:
    changed = with_effect(name)
    wanted, found = full(changed) - unchanged[0], fixed(changed) - unchanged[1]
    assert np.abs(found - wanted).max() < 0.01 * np.abs(wanted).max() + 0.005


def test_the_catalogue_was_tried() -> None:
    assert {CAPACITY, "conductivity-temperature", "radiation", "hot-road", "gas-mass"} <= EFFECTS.keys()


@pytest.mark.parametrize("integrate", [backward, theta_steps])
def test_synthetic_data_follow_a_heat_capacity_that_rises(
    integrate: Callable[[Conduction, Array, float], tuple[Array, Array]], unchanged: tuple[Array, Array]
) -> None:
    times = np.arange(0.0, STUDY.card.drive.end + 1.0, 5.0)

    def histories(study: StudyData) -> Array:
        tyre = RollingTyre(study)
        values, _ = integrate(tyre.problem, times, tyre.drive.initial)
        s, depth = study.section.locate(np.array(list(study.stated_places.values())))
        points = study.section.place(*study.section.clamp(s, depth, tyre.mesh.size**2 / 0.1))
        at = located(tyre.problem.operators, points).value() @ values.T
        return np.array([np.interp(GRID, times, history) for history in at])

    changed = with_effect(CAPACITY)
    wanted, found = full(changed) - unchanged[0], histories(changed) - histories(STUDY)
    # The logger's lag is in the readings of the full run only.
    assert np.abs(found - wanted).max() < 0.05 * np.abs(wanted).max()


def test_sensitivities_beside_a_heat_capacity_that_rises_are_those_of_two_simulations() -> None:
    sampling = SensorSampling("crown-inner", np.arange(15.0, 1500.0, 15.0), 0.5, 0.0, 100.0)
    model = ForwardModel(STUDY, (DriveSampling("as driven", {}, False, (sampling,)),))
    (slope,) = EFFECTS[CAPACITY].unknowns
    unknowns = (*base_unknowns(STUDY), slope)
    at = {slope: 0.9 * slope.sd}
    found, wanted = model.jacobian(0, unknowns, at), model.differences(0, unknowns, at)
    sd = np.array([each.sd for each in unknowns])
    assert np.abs((found - wanted) * sd).max() < 0.02 * np.abs(wanted * sd).max()
    assert np.abs((found - wanted)[:, -1]).max() < 0.05 * np.abs(wanted[:, -1]).max()
