"""Temperatures that act back on the strain cycle, against closed forms and an ordinary differential equation."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
import pytest
from lumped import RATE, lumped, rubber, softening
from scipy.integrate import solve_ivp

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.mechanics.cycle_schedule import cycle_schedule
from tyrefem.simulation import feedback
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.warm_cycles import WarmCycles, Warmth

pytestmark = pytest.mark.fast

FINE = {"tolerance": "0.01 delta_degC"}
BIAS = {"mesh.size": "8 mm", "mesh.element": "P1", "drive.duration": "300 s", "output.every": "30 s"}


def heating_rate(study: tf.Study) -> float:
    """K/s of a cold lumped tyre, the contained air warmed with it."""
    tyre = RollingTyre(study, None, cycle_schedule(study))
    volume = float(tyre.problem.operators.weight.sum())
    rubber_capacity = study.materials["tread"].heat_capacity() * volume
    gas = tyre.problem.reservoirs["contained-air"].heat_capacity
    q = next(iter(tyre.sources.values()))(tyre.problem.points("tread"), 0.0, np.full(1, 25.0))[0]
    return float(q * volume / (rubber_capacity + gas))


def test_a_modulus_that_falls_exponentially_heats_the_tyre_as_a_logarithm() -> None:
    """dT/dt = a exp(-c (T - T0)) has T = T0 + ln(1 + c a t)/c; the deflection is given, so only the modulus acts."""
    errors = []
    for knots in (5, 9, 17):
        study = lumped({**FINE, "knots": knots}, rubber(**softening()), deflection="30 mm", duration="900 s")
        result = study.run()
        assert result.feedback is not None
        assert result.feedback.converged
        times = result.times
        exact = 25 + np.log1p(RATE * heating_rate(study) * times) / RATE
        assert exact[-1] > 60
        errors.append(float(np.abs(result.gas_temperature - exact).max()))
        assert result.feedback.softened["tread"] == pytest.approx(np.exp(-RATE * (exact[-1] - 25)), rel=5e-3)
    # Heat is linear in time between knots: an error of second order.
    assert errors[2] < 0.02
    assert np.log2(errors[0] / errors[1]) > 1.7
    assert np.log2(errors[1] / errors[2]) > 1.7


def test_warm_air_lifts_the_tyre_as_an_ordinary_differential_equation_says() -> None:
    """dT/dt = a (D/D0)^2 r_r0/r_r, D = D(F, p(T)), p + p_atm = (p0 + p_atm) T/T0; air and rubber are as warm."""
    study = lumped({**FINE, "knots": 17}, rubber(), load="12 kN", duration="900 s")
    result = study.run()
    law, rating, radius = study.card.mechanics.load_law, study.section.rating, study.section.outer_diameter / 2
    assert rating is not None

    def deflection(T: float) -> float:
        return law.deflection(12e3, (572e3 + 101325.0) * (T + 273.15) / 298.15 - 101325.0, rating)

    cold, rate = deflection(25.0), heating_rate(study)

    def slope(_t: float, T: np.ndarray) -> list[float]:
        d = deflection(float(T[0]))
        return [rate * (d / cold) ** 2 * (radius - cold / 3) / (radius - d / 3)]

    exact = solve_ivp(slope, (0, 900), [25.0], rtol=1e-9, atol=1e-9, t_eval=result.times).y[0]
    alone = 25 + rate * result.times
    assert alone[-1] - exact[-1] > 3
    assert np.abs(result.gas_temperature - exact).max() < 0.02
    feedback = result.feedback
    assert feedback is not None
    assert feedback.start.deflection == pytest.approx(cold, rel=1e-12)
    assert feedback.end.deflection == pytest.approx(deflection(exact[-1]), rel=1e-4)
    assert feedback.end.pressure == pytest.approx(result.gas_pressure[-1], rel=1e-4)


@functools.cache
def plain() -> tf.Result:
    return tf.study("nasa-22x5.5-8pr", BIAS).run()


@functools.cache
def coupled() -> tf.Result:
    return tf.study("nasa-22x5.5-8pr", {**BIAS, "mechanics.feedback.pressure": True}).run()


def test_warm_air_cools_a_bias_tyre() -> None:
    """8PR, 2700 lbf, 83 psi, 20 mph: p_abs rises with T_abs, the deflection falls, so does the heat."""
    uncoupled, two = plain(), coupled()
    feedback = two.feedback
    assert feedback is not None
    assert feedback.converged
    warmed = (two.gas_temperature[-1] + 273.15) / 298.15
    pressure = (572.26e3 + 101325) * warmed - 101325
    assert feedback.end.pressure == pytest.approx(pressure, rel=1e-3)
    assert 0.9 < feedback.end.deflection / feedback.start.deflection < 0.97
    law, rating = two.study.card.mechanics.load_law, two.study.section.rating
    assert rating is not None
    assert law.load(feedback.end.deflection, feedback.end.pressure, rating) == pytest.approx(2700 * 4.44822, rel=1e-3)
    cooler = uncoupled.extremes["temperature_degC"] - two.extremes["temperature_degC"]
    assert cooler[0] > 1.0
    assert (cooler > -0.02).all()
    # Every run disagrees less: the heat that a kelvin takes away is far less than a kelvin's.
    assert len(feedback.changes) > 1
    assert all(after < 0.3 * before for before, after in zip(feedback.changes, feedback.changes[1:], strict=False))
    assert two.heat_budget.imbalance < 1e-6


def test_the_fixed_point_does_not_depend_on_the_start() -> None:
    study = coupled().study
    hot = feedback.run(study, start=Warmth.even(study, 60.0))
    assert hot.feedback is not None
    assert hot.feedback.converged
    assert hot.feedback.changes[0] > 20
    assert hot.gas_temperature == pytest.approx(coupled().gas_temperature, abs=0.1)
    assert hot.history.values == pytest.approx(coupled().history.values, abs=0.15)


def test_what_nothing_changes_is_the_same_to_the_bit() -> None:
    """No card softens, the air is held: one run, and every number as without feedback."""
    held = {**BIAS, "boundaries.contained_air": {"law": "held", "temperature": "40 degC"}}
    uncoupled = tf.study("nasa-22x5.5-8pr", held).run()
    two = tf.study("nasa-22x5.5-8pr", {**held, "mechanics.feedback.modulus": True}).run()
    assert two.feedback is not None
    assert two.feedback.changes == (0.0,)
    assert np.array_equal(uncoupled.history.values, two.history.values)


def test_what_does_not_converge_says_so() -> None:
    study = coupled().study.replace({"mechanics.feedback.iterations": 1})
    result = study.run()
    assert result.feedback is not None
    assert not result.feedback.converged
    assert any("has not converged: after 1 runs" in line for line in result.warnings)
    assert result.summary()["feedback"]["converged"] is False
    assert "NOT converged" in result.feedback.words


def test_a_soft_hot_carcass_takes_its_part_of_the_strain_energy_with_it() -> None:
    """At a given deflection sidewall rubber far from the plies' influence: U = G (e_phi^2 + e_theta^2), so U ~ G(T)."""
    soft = {"base": "nasa-sidewall", **softening()}
    changes = {**BIAS, "materials.sidewall": soft, "mechanics.feedback.pressure": False}
    study = tf.study("nasa-22x5.5-8pr", changes)
    result = study.run()
    assert result.feedback is not None
    assert result.feedback.converged
    cycles, x = result.tyre.schedule.cycles[0], result.tyre.problem.points("IV")
    ratio = cycles[-1].energy_density("IV", x) / cycles[0].energy_density("IV", x)
    assert ratio == pytest.approx(result.feedback.softened["sidewall"], rel=2e-3)
    mean = Warmth.of(result).regions["sidewall"][-1]
    assert ratio.mean() == pytest.approx(np.exp(-RATE * (mean - 25)), rel=2e-3)


def test_ramps_and_later_phases_take_the_pressure_of_their_time() -> None:
    phases = [
        {"name": "rolling", "duration": "200 s"},
        {"name": "heavier", "duration": "60 s", "load": {"from": "2700 lbf", "to": "3500 lbf"}},
    ]
    study = tf.study("nasa-22x5.5-8pr", {**BIAS, "mechanics.feedback.pressure": True, "drive.phases": phases})
    result = study.run()
    assert result.feedback is not None
    assert result.feedback.converged
    times = np.array([0.0, 100.0, 199.0, 230.0, 259.9])
    pressure = [result.tyre.schedule.mean(lambda case: case.pressure, t) for t in times]
    assert pressure == pytest.approx(np.interp(times, result.times, result.gas_pressure), rel=2e-3)
    assert [state.pressure for state in result.phases] == sorted(state.pressure for state in result.phases)


def test_an_effect_that_would_count_twice_is_refused() -> None:
    rise = {"name": "pressure-rise", "rise": 0.1}
    with pytest.raises(InputError, match="rises with the contained air already"):
        tf.study("nasa-22x5.5-8pr", {"mechanics.feedback.pressure": True, "effects": [rise]})


def test_a_diagnosis_of_a_study_with_feedback_is_refused() -> None:
    from tyrefem.diagnose.forward.fixed_step import fixed_step_run

    with pytest.raises(InputError, match=r"mechanics.feedback: only a run computes"):
        fixed_step_run(coupled().study)


def test_the_outcome_is_in_the_summary() -> None:
    feedback = coupled().summary()["feedback"]
    assert coupled().feedback is not None
    assert feedback["change_K"] == list(dataclasses.asdict(coupled().feedback)["changes"])  # type: ignore[arg-type]
    assert feedback["start"]["gauge_pressure_Pa"] < feedback["end"]["gauge_pressure_Pa"]
    assert "feedback" not in plain().summary()


def test_ctrl_c_between_two_runs_keeps_the_latest(monkeypatch: pytest.MonkeyPatch) -> None:
    """Strain cycles by finite elements take minutes between two runs."""

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(WarmCycles, "update", stop)
    study = lumped({"tolerance": "0.001 delta_degC"}, rubber(**softening()), deflection="30 mm", duration="90 s")
    with pytest.raises(KeyboardInterrupt):
        study.run()
    result = study.run(partial=True)
    assert result.history.interrupted
    assert result.times[-1] == 90.0
    assert result.feedback is not None
    assert not result.feedback.converged
