"""Every shipped study: its heat budget closes, and its answer does not hang on mesh, half or time step."""

from __future__ import annotations

import functools

import numpy as np
import pytest

import tyrefem as tf
from tyrefem import library

SHIPPED = sorted(library.names("study"))
STEADY = [name for name in SHIPPED if len(tf.study(name).card.drive.phases) == 1]
ROLLING = "nasa-22x5.5-8pr"
#: Mesh of a tyre with mechanics by finite elements: over that of its study, and at least, m.
COARSER, COARSE = 1.8, 14e-3


@functools.cache
def run(name, *changes):
    """A shipped study; footprints by the quick look, coarse: energy balances in any motion, moduli and mesh."""
    study = tf.study(name)
    quick = {}
    if study.card.mechanics.strain == "fem":
        quick = {
            "mechanics.motion": "linear",
            "mechanics.moduli": "card",
            "mesh.size": f"{max(COARSER * study.card.mesh.size, COARSE):g} m",
        }
    return study.replace({**quick, **dict(changes)}).run()


def gap(*changes, base=()):
    """Largest difference of any reading over the run, K."""
    return float(np.abs((run(ROLLING, *changes).readings - run(ROLLING, *base).readings).to_numpy()).max())


@pytest.mark.parametrize("name", SHIPPED)
def test_what_is_made_is_stored_plus_lost(name):
    budget = run(name).heat_budget
    stored, lost = (budget.total(kind) for kind in ("stored", "lost"))
    assert budget.total("generated") > 0
    assert budget.made == pytest.approx(stored + lost, rel=1e-6)
    assert budget.imbalance < 1e-6
    # Energies close to rounding; powers as well as the slope of the time integration's interpolant does.
    made = budget.power("generated") + budget.power("sliding")
    assert made == pytest.approx(budget.power("stored") + budget.power("lost"), abs=1e-2 * made.max())


@pytest.mark.parametrize("name", STEADY)
def test_rolling_resistance_is_the_generated_power_over_speed(name):
    result = run(name)
    state, resistance = result.phases[-1], result.rolling_resistance
    assert resistance.force * state.speed == pytest.approx(result.heat_budget.power("generated")[-1], rel=1e-12)
    assert resistance.coefficient == pytest.approx(resistance.force / state.load, rel=1e-12)
    # At the start the whole tyre is cold.
    assert resistance.cold_force * state.speed == pytest.approx(result.heat_budget.power("generated")[0], rel=1e-6)


@pytest.mark.parametrize("name", SHIPPED)
def test_gas_heat_is_what_left_through_the_inner_surface(name):
    result = run(name)
    budget = result.heat_budget.energies
    through = budget["lost", "contained air"][-1]
    kept = budget["lumped", "contained-air: stored"][-1] + budget["lumped", "contained-air: passed on"][-1]
    assert kept == pytest.approx(through, rel=1e-6)


def test_full_section_equals_half():
    full, half = run(ROLLING, ("mesh.section", "full")), run(ROLLING)
    assert gap(("mesh.section", "full")) < 1e-6
    for key, energy in half.heat_budget.energies.items():
        assert full.heat_budget.energies[key] == pytest.approx(energy, rel=1e-9, abs=1e-3)
    assert full.rolling_resistance.force == pytest.approx(half.rolling_resistance.force, rel=1e-9)


def test_quadrilaterals_and_triangles_agree():
    """Within 0.05 K of some 60 K, second-order elements of the default size."""
    assert gap(("mesh.cell", "tri")) < 0.05


def test_linear_elements_approach_quadratic_ones():
    """P1 of the same size within 0.5 K; half the size leaves less than half of it."""
    same, half = gap(("mesh.element", "P1")), gap(("mesh.element", "P1"), ("mesh.size", "1.5 mm"))
    assert same < 0.5
    assert half < same / 2


def test_the_time_step_does_not_matter():
    assert gap(("numerics.tolerance", "0.001 delta_degC")) < 0.01


def test_a_phase_that_stands_still_makes_no_heat():
    """Taxi, hold, take-off, cool-down: power only while rolling; afterwards the tyre cools towards the ambient."""
    result = run("nasa-taxi-takeoff")
    power = result.heat_budget.power("generated")
    speed = np.array([result.study.card.drive.value("speed", t) for t in result.times])
    inside = np.array([not any(abs(t - p.end) < 1e-6 for p in result.phases) for t in result.times])
    assert np.all(power[inside & (speed == 0)] == 0)
    assert np.all(power[inside & (speed > 0)] > 0)
    stop = result.phases[-1].start
    peaks = result.readings[result.times >= stop + 60].drop(columns=["time_s", "rim", "contained-air"])
    assert np.all(np.diff(peaks.max(axis=1)) < 1e-6)
