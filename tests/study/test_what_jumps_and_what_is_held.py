"""Pulses of effects, lifted tyres, locked wheels and equal names: what a run must not step over, heat or lose."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.api import Result
from tyrefem.conduction.fixed_steps import fixed_step_solution
from tyrefem.conduction.sensitivity import Perturbed, stage_times, tangents
from tyrefem.diagnose.forward.fixed_step import breaks
from tyrefem.errors import InputError
from tyrefem.fatigue.duty import Duty
from tyrefem.lumped.card import ThermalCard
from tyrefem.lumped.identification import identify
from tyrefem.simulation.rolling_tyre import RollingTyre

SHORT = {"mesh.size": "14 mm", "mesh.element": "P1", "drive.duration": "1200 s"}
RIM = {"law": "lumped", "mass": "2 kg", "specific_heat": "900 J/kg/K", "film": "200 W/m**2/K", "cooling": "1 W/K"}
FLUX = {"name": "missing-flux", "station": "85 mm", "width": "10 mm", "into": "10000 W/m**2"}


def study(**changes: Any) -> tf.Study:
    return tf.study("nasa-22x5.5-8pr", SHORT | changes)


def taken(result: Result, name: str) -> float:
    """Energy that effects of a name bring, J."""
    rows = {key: energy for key, energy in result.heat_budget.energies.items() if key[0] == "lost" and name in key[1]}
    return -float(sum(energy[-1] for energy in rows.values()))


def test_a_run_does_not_step_over_a_pulse() -> None:
    always = study(effects=[FLUX]).run()
    pulse = study(effects=[FLUX | {"begins": "600 s", "ends": "620 s"}]).run()
    assert taken(pulse, "missing-flux") == pytest.approx(taken(always, "missing-flux") * 20 / 1200, rel=1e-6)


def test_a_reduced_model_does_not_step_over_a_pulse() -> None:
    heat = {"name": "missing-heat", "station": "85 mm", "width": "10 mm", "heat": "2 MW/m**3"}
    pulse = study(effects=[heat | {"begins": "1100 s", "ends": "1140 s"}])
    speeds = {"drive.speed": [f"{18 + 0.2 * n:.4g} mph" for n in range(24)]}
    full = pulse.sweep({"drive.speed": speeds["drive.speed"][-1:]}, reduced="never").table["hottest_degC"].iloc[0]
    by_model = pulse.sweep(speeds, reduced="always", tolerance=0.5).table
    assert set(by_model["by"]) == {"reduced"}
    assert by_model["hottest_degC"].iloc[-1] == pytest.approx(full, abs=0.5)


def test_two_fluxes_with_one_name_are_both_in_the_budget() -> None:
    parts = [FLUX | {"ends": "20 s"}, FLUX | {"begins": "20 s"}]
    both, whole = study(effects=parts).run(), study(effects=[FLUX]).run()
    assert taken(both, "missing-flux") == pytest.approx(taken(whole, "missing-flux"), rel=1e-6)
    lost = sum(float(energy[-1]) for (kind, _), energy in both.heat_budget.energies.items() if kind == "lost")
    assert lost == pytest.approx(both.heat_budget.total("lost"), rel=1e-12)


def test_a_lifted_tyre_takes_nothing_from_the_road() -> None:
    road = {"law": "constant", "coefficient": "1000 W/m**2/K", "temperature": "90 degC", "fraction": 0.1}
    lifted = study(**{"drive.load": "0 N", "boundaries.road": road}).run()
    assert lifted.history.maximum.temperature == pytest.approx(25.0, abs=1e-6)


def test_a_locked_wheel_does_no_work_on_its_brake() -> None:
    changes = {"mesh.size": "14 mm", "mesh.element": "P1", "boundaries.rim": RIM}
    skid = tf.study("nasa-brake-yaw-skid", changes)
    braked = skid.replace({"effects": [{"name": "brake-power", "power": "1 kW"}]})
    tyre = RollingTyre(braked)
    (effect,) = braked.effects
    names = [phase.name for phase in braked.card.drive.phases]
    locked = float(tyre.drive.starts[names.index("locked skid")]) + 0.1
    assert tyre.drive.locked_since(locked) is not None
    assert effect.rim_power(tyre, locked) == 0.0
    assert effect.rim_power(tyre, 1.0) == pytest.approx(1000.0)


def test_starts_of_reservoirs_have_tangents() -> None:
    base = study(**{"boundaries.contained_air.initial": "40 degC", "boundaries.rim": RIM})
    tyre = RollingTyre(base)
    times = stage_times(breaks(base))
    values, reservoirs = fixed_step_solution(tyre.problem, times, tyre.drive.initial)
    warmer = base.replace({"boundaries.contained_air.initial": "41 degC"})
    column = Perturbed(RollingTyre(warmer, tyre).problem, 1.0)
    found = tangents(tyre.problem, times, values, reservoirs, [column])
    other = fixed_step_solution(RollingTyre(warmer).problem, times, tyre.drive.initial)[1]
    names = list(tyre.problem.reservoirs)
    gas = names.index("contained-air")
    at = len(times) // 2
    assert found.reservoirs[0, 0, gas] == pytest.approx(1.0)
    assert found.reservoirs[0, at, gas] == pytest.approx(float(other[at, gas] - reservoirs[at, gas]), abs=2e-3)


def test_the_plateau_of_a_phase_is_its_own() -> None:
    phases = [{"name": "fast", "duration": "600 s"}, {"name": "standing", "duration": "600 s", "speed": "0 mph"}]
    result = study(**{"drive.duration": None, "drive.phases": phases, "output.every": "300 s"}).run()
    duty = Duty.of_run(result, plateau=True)
    temperatures = np.asarray(duty.temperatures(result.sensor_points[:1]))[:, 0]
    rolling = np.asarray(duty.times)[:-1] < 599.0
    end = float(result.at(result.sensor_points[:1])[np.searchsorted(result.times, 600.0 - 1e-6), 0])
    middle = (temperatures[1:] + temperatures[:-1]) / 2
    assert middle[rolling] == pytest.approx(end)


def test_uncertain_heat_counts_more_beside_a_known_film() -> None:
    card = {
        "title": "one body", "temperature_sd": "0.1 K", "time_sd": "1 %", "heat_sd": "3 %",
        "bodies": {"body": {"heat_share": 1.0, "heat_capacity": "5000 J/K"}},
        "films": [{"between": ["body", "air"]}, {"between": ["body", "road"], "conductance": "10 W/K"}],
        "runs": [{"name": "a", "speed": "10 m/s", "load": "3 kN", "rolling_resistance": "11 N", "air": "20 degC",
                  "road": "20 degC", "plateau": {"body": "30 degC"}}],
    }  # fmt: skip
    (number,) = identify(ThermalCard.check(card)).numbers
    assert number.value == pytest.approx(1.0, rel=1e-3)
    # 3 % of 11 W/K, and 0.1 K of 10 K.
    assert number.sd == pytest.approx(np.hypot(0.33, 0.11), rel=0.05)


def test_a_lumped_rim_s_temperature_is_its_start() -> None:
    with pytest.raises(InputError, match="a lumped rim only starts from it") as error:
        study(**{"boundaries.rim": RIM, "drive.rim_temperature": {"from": "25 degC", "to": "90 degC"}})
    assert str(error.value.field).endswith("rim_temperature")
    assert study(**{"boundaries.rim": RIM, "drive.rim_temperature": "60 degC"}).card.drive.initial == 25.0
