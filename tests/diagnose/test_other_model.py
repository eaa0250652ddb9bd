"""Structural synthetic data: the model differs from the study's by stated parts, drawn from the seed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

import tyrefem as tf
from tyrefem.diagnose.blind.blind_case import STRUCTURAL, BlindCase, cases, measured, mesh_of, other_model
from tyrefem.diagnose.blind.other_model import (
    OUTSIDE_FILM,
    ROAD_FILM,
    OtherModel,
    heat_at_start,
    mode_sum,
    other_law,
    rms_of_modes,
)
from tyrefem.diagnose.blind.synthetic import Logger, theta_steps
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.cycle_schedule import cycle_schedule
from tyrefem.simulation.rolling_tyre import RollingTyre

#: Of the synthetic data.
COARSE = {"mesh.size": "8 mm", "mesh.element": "P1"}
NOISELESS = Logger(noise=0.0, gap=0.0)
#: Nothing differs in structure.
SAME = OtherModel("", 1.0, (0.0,), {}, {})


@pytest.fixture(scope="module")
def study() -> StudyData:
    return tf.study("hidden-effect")


@pytest.fixture(scope="module")
def drawn(study: StudyData) -> list[tuple[BlindCase, OtherModel]]:
    return [(case, other_model(study, case)) for case in cases(study, 30, 3)]


def quiet(case: BlindCase) -> BlindCase:
    """The case without any hidden value."""
    return replace(case, hidden=(), values={}, uncatalogued=None)


def readings(study: StudyData, case: BlindCase, model: OtherModel) -> NDArray[np.float64]:
    """(n_times, n_sensors) degC of the second run: 35 mph, above the speed to which the laws refer."""
    return np.asarray(measured(study, case, NOISELESS, COARSE, model)[1].temperatures.to_numpy(dtype=float))


def test_the_seed_decides_the_model(study: StudyData, drawn: list[tuple[BlindCase, OtherModel]]) -> None:
    again = [other_model(study, case) for case in cases(study, 30, 3)]
    other = [other_model(study, case) for case in cases(study, 30, 4)]
    assert again == [model for _, model in drawn]
    assert all(before != after for before, after in zip(again, other, strict=True))


def test_every_part_is_within_its_stated_range(drawn: list[tuple[BlindCase, OtherModel]]) -> None:
    laws = {model.law for _, model in drawn}
    assert laws == {"", "barrel"}
    for case, model in drawn:
        assert set(model.gauges) == {"carcass", "bead", "tread", "sidewall"}
        assert all(0.05 <= abs(factor - 1) <= 0.10 for factor in model.gauges.values())
        assert bool(model.modes) == (not model.law)
        if model.modes:
            assert 0.2 <= rms_of_modes(model.modes) <= 0.3
        hidden = {member.name for member in case.hidden}
        assert set(model.speed_laws) == {OUTSIDE_FILM, ROAD_FILM} - hidden
    # A film's speed law that is the hidden effect does not differ a second time.
    films = [case for case, _ in drawn if {OUTSIDE_FILM, ROAD_FILM} & {member.name for member in case.hidden}]
    assert films


def test_the_record_states_all_parts(drawn: list[tuple[BlindCase, OtherModel]]) -> None:
    model = next(model for _, model in drawn if model.law)
    record = model.to_dict(mesh_of(STRUCTURAL))
    assert record["strain_law"] == "barrel"
    assert record["strain_factor"] == model.factor
    assert record["gauges"] == model.gauges
    assert record["film_speed_exponents"] == model.speed_laws
    assert record["mesh"]["mesh.cell"] == "quad"
    assert "theta" in record["time_integration"]


def test_modes_multiply_the_energy_along_the_meridian(study: StudyData) -> None:
    model = replace(SAME, modes=(0.1, 0.2))
    stated, shaped = cycle_schedule(study), model.schedule(study, study)
    points = study.section.place([0.0, 0.03], [0.003, 0.003]).T
    ratio = shaped.cycles[0][0].energy_density("I", points) / stated.cycles[0][0].energy_density("I", points)
    place = np.array([0.0, 0.03]) / study.section.line.length
    assert np.log(ratio) == pytest.approx(0.1 + 0.2 * np.cos(np.pi * place), abs=1e-6)
    across = np.linspace(0.0, 1.0, 4001)
    exact = np.sqrt(np.trapezoid(mode_sum(across, (0.1, 0.2, -0.3)) ** 2, across))
    assert rms_of_modes((0.1, 0.2, -0.3)) == pytest.approx(exact, rel=1e-6)


def test_another_law_has_the_heat_of_the_study_elsewhere(study: StudyData) -> None:
    law, factor = other_law(study)
    assert law == "barrel"
    model = replace(SAME, law=law, factor=factor)
    schedule = model.schedule(study, study)
    assert heat_at_start(study, schedule) == pytest.approx(heat_at_start(study), rel=0.02)
    assert {zone.name for zone in schedule.zones} == set(study.section.regions)
    # The energy goes with the deflection squared.
    heavier = study.replace({"drive.load": "3000 lbf"})
    more = model.schedule(study, heavier)
    points = study.section.place([0.01], [0.003]).T
    energies = [each.cycles[0][0].energy_density("carcass", points)[0] for each in (schedule, more)]
    deflections = [each.cases[0][0].deflection for each in (schedule, more)]
    assert energies[1] / energies[0] == pytest.approx((deflections[1] / deflections[0]) ** 2, rel=1e-9)


def test_gauges_keep_the_sensors_in_the_rubber(study: StudyData) -> None:
    thin = dict.fromkeys(study.section.regions, 0.8)
    changed = replace(SAME, gauges=thin).changed(study, COARSE)
    assert changed.section.total_thickness([0.0])[0] == pytest.approx(0.8 * study.section.total_thickness([0.0])[0])
    outer, stated = changed.sensors["tread-outer"], study.sensors["tread-outer"]
    assert outer.s == pytest.approx(stated.s)
    assert outer.depth == pytest.approx(changed.section.rubber_thickness([stated.s])[0] - 2e-4)
    assert changed.sensors["crown-inner"].depth == pytest.approx(study.sensors["crown-inner"].depth)


@pytest.mark.parametrize(
    "part",
    [
        {"modes": (0.2, 0.1, -0.1)},
        {"gauges": {"carcass": 1.0, "bead": 1.0, "tread": 0.9, "sidewall": 1.0}},
        {"speed_laws": {OUTSIDE_FILM: -0.3}},
    ],
)
def test_each_part_changes_the_readings(study: StudyData, part: dict[str, object]) -> None:
    case = quiet(cases(study, 3, 1)[0])
    same, changed = readings(study, case, SAME), readings(study, case, replace(SAME, **part))  # type: ignore[arg-type]
    assert np.abs(changed - same).max() > 0.5, "K: more than the noise"


def test_the_theta_method_agrees_with_the_solver() -> None:
    study = tf.study("example-validation").replace({"mesh.size": "6 mm", "mesh.element": "P1"})
    tyre = RollingTyre(study)
    exact = tyre.problem.transient(np.linspace(0.0, 1200.0, 401), 25.0, 0.002, breakpoints=[600.0])

    def errors() -> Iterator[float]:
        for steps in (100, 400):
            times = np.linspace(0.0, 1200.0, steps + 1)
            values, gas = theta_steps(tyre.problem, times, 25.0)
            at = exact.values[:: 400 // steps]
            settled = (np.mod(times, 600.0) > 60.0) | (times == 600.0)
            yield float(np.abs(values - at)[settled].max())
            assert np.abs(gas[:, 0] - exact.reservoirs["contained-air"][:: 400 // steps]).max() < 0.3

    coarse, fine = errors()
    assert fine < 0.15, "K at 3 s"
    # Theta = 0.6 is of first order.
    assert coarse > 2.5 * fine
    assert all(before > after for before, after in pairwise((coarse, fine)))
