"""Heat generation from strain energy (Clark & Dodge 1980, eqs 25 and 26) and heat of ramps."""

from __future__ import annotations

import functools
import math

import numpy as np
import pint
import pytest

import tyrefem as tf
from tyrefem.inputs.loading import TrR64
from tyrefem.mechanics.solved_cases import ramp_knots
from tyrefem.simulation.rolling_tyre import RollingTyre

pytestmark = pytest.mark.fast

CONSTANT = {f"materials.{r}.loss_tangent.law": "constant" for r in ("carcass", "tread", "sidewall", "bead")}
COARSE = {"mesh.size": "4 mm", "mesh.element": "P1", **CONSTANT}


def rolling(name="nasa-22x5.5-8pr", **drive):
    return RollingTyre(tf.study(name).replace({**COARSE, **{f"drive.{key}": value for key, value in drive.items()}}))


def test_the_printed_equation_in_its_printed_units():
    """q = 0.00988 U v tan d / (r_0 - D/3): cal/cm3/s, in-lbf/in3, ft/s, in."""
    u = pint.UnitRegistry()
    tyre = rolling()
    source, case = tyre.sources["II"], tyre.schedule.cases[0][0]
    x = tyre.study.section.place(np.array([0.01, 0.03]), np.array([0.01, 0.012])).T
    U = u.Quantity(source.energy_density(x, 0.0), "J/m**3").to("inch*lbf/inch**3").magnitude
    v = u.Quantity(tyre.speed(0.0), "m/s").to("ft/s").magnitude
    r = u.Quantity(case.outer_radius - case.deflection / 3, "m").to("inch").magnitude
    printed = 0.00988 * U * v * 0.2 / r
    q = u.Quantity(source(x, 0.0, np.full(2, 25.0)), "W/m**3").to("cal/cm**3/s").magnitude
    # The report rounds its calorie: 252 cal to the Btu of 778 ft-lbf.
    assert q == pytest.approx(printed, rel=1e-3)


def test_one_loss_per_revolution():
    """W = pi U tan d per revolution (25) times v / (2 pi r_r) revolutions a second."""
    tyre = rolling()
    source, case = tyre.sources["III"], tyre.schedule.cases[0][0]
    x = tyre.study.section.place(np.array([0.08]), np.array([0.003])).T
    revolutions = tyre.speed(0.0) / (2 * math.pi * case.rolling_radius)
    assert tyre.schedule.revolutions_per_second(0.0) == pytest.approx(revolutions, rel=1e-14)
    loss = math.pi * source.energy_density(x, 0.0) * 0.1
    assert source(x, 0.0, np.array([90.0])) == pytest.approx(loss * revolutions, rel=1e-12)


def test_the_strict_sinusoid_loses_twice_as_much():
    """W = 2 pi U tan d with U = E' e0^2 / 2, against the report's pi U tan d."""
    x = rolling().study.section.place(np.array([0.01]), np.array([0.01])).T
    study = tf.study("nasa-22x5.5-8pr")
    q = [
        RollingTyre(study.replace({"mechanics.loss_convention": name})).sources["II"](x, 0.0, np.array([25.0]))
        for name in ("nasa", "sinusoid")
    ]
    assert q[1] == pytest.approx(2 * q[0], rel=1e-12)


def test_a_hot_tyre_makes_less_heat():
    x = rolling().study.section.place(np.array([0.01]), np.array([0.01])).T
    source = RollingTyre(tf.study("nasa-22x5.5-8pr")).sources["II"]
    cold, hot = (source(x, 0.0, np.array([T])) for T in (25.0, 75.0))
    assert hot / cold == pytest.approx(math.exp(-0.0148 * 50), rel=1e-12)


def test_no_heat_without_rolling_or_without_load():
    for tyre in (rolling(speed="0 mph"), rolling(load="0 lbf")):
        assert len(tyre.sources) == 5
        for zone, source in tyre.sources.items():
            nodes = tyre.problem.points(zone)
            assert np.all(source(nodes, 0.0, np.full(nodes.shape[1], 25.0)) == 0)


def generated(tyre, t):
    """W of the whole tyre at a time, by the conduction solver's own quadrature."""
    total = 0.0
    for zone, source in tyre.sources.items():
        nodes = tyre.problem.points(zone)
        total += float((tyre.problem.operators.source(zone) @ source(nodes, t, np.full(nodes.shape[1], 25.0))).sum())
    return 2 * total


def test_a_speed_ramp_makes_the_heat_of_its_distance():
    """With tan d constant q is proportional to v: the heat is the resisting force times the distance v_max t / 2."""
    steady = rolling(speed="20 m/s")
    force = generated(steady, 0.0) / 20.0
    ramp = rolling(speed={"from": "0 m/s", "to": "20 m/s"}, duration="60 s").study.run()
    assert ramp.heat_budget.total("generated") == pytest.approx(force * 600.0, rel=1e-6)


@functools.cache
def steady_power(load):
    return generated(rolling("nasa-22x5.5-12pr", load=f"{load} lbf"), 0.0)


def flattening_load():
    """Load that just flattens the 12PR's crown, where the strain law has its kink, lbf."""
    cycle = rolling("nasa-22x5.5-12pr").schedule.cycles[0][0]
    law, rating = TrR64(), cycle.section.rating
    return law.load(cycle.full_flattening, cycle.case.pressure, rating) / 4.4482216152605


@pytest.mark.parametrize("ends", [(0, 7100), (7100, 700)])
def test_a_load_ramp_makes_the_heat_of_the_loads_it_passes(ends):
    """The integral of the steady power over the loads, by Gauss either side of the kink; within 0.3 %."""
    x, w = np.polynomial.legendre.leggauss(6)
    low, high, kink = min(ends), max(ends), flattening_load()
    mean = 0.0
    for start, stop in ((low, kink), (kink, high)):
        powers = [steady_power(round(load, 6)) for load in start + (stop - start) * (x + 1) / 2]
        mean += (stop - start) / (high - low) * float(w @ powers) / 2
    ramp = rolling("nasa-22x5.5-12pr", load={"from": f"{ends[0]} lbf", "to": f"{ends[1]} lbf"}, duration="60 s")
    assert ramp.study.run().heat_budget.total("generated") == pytest.approx(60.0 * mean, rel=3e-3)


def test_knots():
    assert tuple(ramp_knots(False)) == (0.0,)
    assert ramp_knots(True)[0] == 0.0
    assert ramp_knots(True)[-1] == 1.0


def test_a_source_does_not_depend_on_what_it_was_asked_before():
    speeds = {"drive.speed": {"from": "5 mph", "to": "25 mph"}}
    study = tf.study("nasa-22x5.5-8pr").replace({**COARSE, **speeds})
    used_tyre = RollingTyre(study)
    x = used_tyre.study.section.place(np.array([0.01, 0.03]), np.array([0.01, 0.012])).T
    other, T = x[:, ::-1].copy(), np.full(2, 25.0)
    for nodes, t in [(x, 0.0), (x, 60.0), (other, 60.0), (x, 0.0), (x, 60.0)]:
        fresh = RollingTyre(study).sources["II"](nodes, t, T)
        assert np.array_equal(used_tyre.sources["II"](nodes, t, T), fresh)
    assert used_tyre.sources["II"](x, 60.0, T)[0] > 1.01 * used_tyre.sources["II"](x, 0.0, T)[0]
