"""strain = "given": the study's own energies become heat."""

from __future__ import annotations

import math

import numpy as np
import pytest
from constructions import RADIALS, coarse_run

import tyrefem as tf
from tyrefem.simulation.rolling_tyre import RollingTyre

PASSENGER = "passenger-205-55r16"


def cold_power(study):
    """Heat of every region of the half section at the initial temperature, W."""
    tyre = RollingTyre(study)
    powers = {}
    for zone, source in tyre.hysteresis.items():
        nodes = tyre.problem.points(zone)
        q = source(nodes, 1.0, np.full(nodes.shape[1], 25.0))
        powers[zone] = float((tyre.problem.operators.source(zone) @ q).sum())
    return powers


@pytest.fixture(scope="module")
def study():
    return tf.study(PASSENGER).replace({"mechanics.strain": "given", "mesh.size": "8 mm", "mesh.element": "P1"})


def test_a_cycle_loses_two_pi_u_tan_delta(study):
    """P = 2 pi U tan d V v / (2 pi r_r) in the bead, whose U is one number."""
    tyre = RollingTyre(study)
    card = study.card.mechanics
    ((_, energy),) = card.energy.regions["bead"]
    rolling_radius = study.section.outer_diameter / 2 - (4825 / 200e3) / 3
    revolutions = 80 / 3.6 / (2 * math.pi * rolling_radius)
    lost = 2 * math.pi * energy * float(study.materials["bead"].loss_tangent(25.0)) * tyre.mesh.volume("bead")
    assert cold_power(study)["bead"] == pytest.approx(lost * revolutions, rel=1e-9)


def test_heat_goes_with_the_square_of_the_load(study):
    """A stiffness that does not change: D is proportional to the load; only the rolling radius differs."""
    full, half = cold_power(study), cold_power(study.replace({"drive.load": "2412.5 N"}))
    radii = [study.section.outer_diameter / 2 - load / 200e3 / 3 for load in (4825.0, 2412.5)]
    for region, power in full.items():
        assert half[region] == pytest.approx(power / 4 * radii[0] / radii[1], rel=1e-6)
    assert set(cold_power(study.replace({"drive.load": "0 N"})).values()) == {0.0}


@pytest.mark.parametrize(("begins", "ends", "excess"), [(0.0, 4825.0, 0.0078), (2412.5, 6031.25, 0.0018)])
def test_a_ramp_of_load_has_the_heat_of_nine_points(study, begins, ends, excess):
    """The square of the load between nine points, as straight lines: h^2/6 (end - begin)^2 too much, h = 1/8."""
    ramp = study.replace({"drive.load": {"from": f"{begins} N", "to": f"{ends} N"}, "drive.duration": "80 s"})
    schedule = RollingTyre(ramp).schedule
    times = (np.arange(4000) + 0.5) * 80 / 4000
    squares = [
        sum(weight * schedule.cases[phase][knot].load ** 2 for phase, knot, weight in schedule.weights(time))
        for time in times.tolist()
    ]
    exact = (ends**3 - begins**3) / (3 * (ends - begins))
    assert np.mean(squares) / exact - 1 == pytest.approx(excess, abs=5e-5)
    assert np.mean(squares) - exact == pytest.approx((ends - begins) ** 2 / 384, rel=1e-4)


def test_rows_along_the_meridian_are_joined_by_straight_lines(study):
    cycle = RollingTyre(study).schedule.cycles[0][0]
    rows = study.card.mechanics.energy.regions["tread"]
    (s0, u0), (s1, u1) = rows[-2:]
    points = study.section.place([0.0, (s0 + s1) / 2, 0.2], [0.014, 0.014, 0.01]).T
    assert cycle.energy_density("tread", points) == pytest.approx([rows[0][1], (u0 + u1) / 2, u1], rel=1e-6)


@pytest.mark.parametrize("name", RADIALS)
def test_the_budget_closes_and_the_belt_edge_is_hottest(name):
    radial, result = RADIALS[name], coarse_run(name)
    budget = result.heat_budget
    assert np.isfinite(result.readings.to_numpy()).all()
    assert budget.imbalance < 1e-6
    assert budget.total("generated") == pytest.approx(budget.total("stored") + budget.total("lost"), rel=1e-6)
    low, high = radial.resistance
    assert low < result.rolling_resistance.coefficient < high
    hottest = result.extremes.iloc[0]
    edge = next(piece.end for piece in result.study.section.pieces if piece.region == radial.outermost_belt)
    assert abs(hottest["s_m"] - edge) < 0.12 * edge
    assert 45.0 < hottest["temperature_degC"] < 130.0
    assert (
        result.readings["belt-edge"].iloc[-1]
        > result.readings["crown-liner" if name != "aircraft" else "crown-inner"].iloc[-1] + 5
    )


def test_the_coarse_mesh_of_these_tests_is_fine_enough():
    """Linear elements of twice the size and a looser time step: hottest point within 1 K of the study as shipped."""
    coarse, shipped = coarse_run("aircraft"), tf.study(RADIALS["aircraft"].study, {"mechanics.strain": "given"}).run()
    peaks = [result.extremes["temperature_degC"].iloc[0] for result in (coarse, shipped)]
    assert peaks[0] == pytest.approx(peaks[1], abs=1.0)
    forces = [result.rolling_resistance.force for result in (coarse, shipped)]
    assert forces[0] == pytest.approx(forces[1], rel=0.01)
