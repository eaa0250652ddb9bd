"""Sliding in runs of a tyre: where the friction heat goes, a locked wheel against closed forms, and what is said."""

from __future__ import annotations

import functools
import json
import math
import re

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.boundaries import friction_names as sliding
from tyrefem.boundaries.friction_names import ASPHALT, LockedWheel, Solid
from tyrefem.cli import main
from tyrefem.reports.words import phase_lines
from tyrefem.simulation.rolling_tyre import RollingTyre

NAME = "nasa-22x5.5-8pr"
LOAD, SPEED = 2700 * 4.4482216152605, 20 * 0.44704
COARSE = (("mesh.size", "8 mm"), ("drive.duration", "10 s"), ("output.fields", 2))


@functools.cache
def run(*changes):
    return tf.study(NAME).replace(dict(changes)).run()


def coarse(**changes):
    return run(*COARSE, *((name.replace("__", "."), value) for name, value in changes.items()))


# -- no slip ---------------------------------------------------------------------------------------------------------


def test_without_slip_nothing_changes_to_the_bit():
    free = coarse()
    named = coarse(drive__slip_ratio=0, drive__slip_angle="0 deg", boundaries__sliding="brush")
    assert np.array_equal(free.history.values, named.history.values)
    assert free.sliding is named.sliding is None
    assert {kind for kind, _ in named.heat_budget.energies} == {"generated", "stored", "lost", "lumped"}
    assert "sliding" not in free.summary()
    assert free.rolling_resistance == named.rolling_resistance


# -- rolling with slip -----------------------------------------------------------------------------------------------


def test_friction_work_is_force_times_sliding_speed_and_the_budget_closes():
    yawed = coarse(drive__slip_angle="4 deg", boundaries__sliding__coefficient=0.5)
    phase, budget = yawed.sliding.phases[0], yawed.heat_budget
    power = 0.5 * LOAD * SPEED * math.sin(math.radians(4.0))
    assert yawed.sliding.series.friction_power_W.to_numpy() == pytest.approx(power, rel=1e-9)
    assert phase.friction_work == pytest.approx(10 * power, rel=1e-6)
    # The rubber takes its share by effusivity and nothing else: 661 against 1732.
    tread = yawed.study.materials["tread"]
    b = math.sqrt(float(np.ravel(tread.conductivity.law())[-1]) * tread.heat_capacity())
    share = b / (b + math.sqrt(1.5 * 2e6))
    assert phase.tread_heat == pytest.approx(share * phase.friction_work, rel=2e-3)
    assert budget.total("sliding") == pytest.approx(phase.tread_heat, rel=1e-12)
    made, kept = budget.total("generated") + budget.total("sliding"), budget.total("stored") + budget.total("lost")
    assert made == pytest.approx(kept, rel=1e-9)
    assert budget.imbalance < 1e-9


def test_rolling_resistance_is_hysteresis_at_the_wheel_s_own_speed():
    """Cold, a braked wheel loses as much per turn and turns 20 % less."""
    free, braked = coarse().rolling_resistance, coarse(drive__slip_ratio=0.2).rolling_resistance
    assert braked.cold_force == pytest.approx(0.8 * free.cold_force, rel=1e-12)
    # The hotter tread loses less still.
    assert braked.force < 0.8 * free.force


def test_braking_and_driving_heat_the_tread_more_than_rolling():
    free, braked, driven = coarse(), coarse(drive__slip_ratio=0.2), coarse(drive__slip_ratio=-0.2)
    surface = braked.tyre.sliding.surface
    ends = [surface.row @ r.history.values[-1][surface.dofs] / surface.area for r in (free, braked, driven)]
    assert min(ends[1:]) > ends[0] + 10
    works = [r.sliding.phases[0].friction_work for r in (braked, driven)]
    assert works[0] == pytest.approx(works[1], rel=1e-6)
    # The driven tread passes the road faster and takes more of the same heat.
    assert driven.sliding.phases[0].tread_heat > braked.sliding.phases[0].tread_heat


def test_exit_edge_is_the_meeting_temperature_plus_the_rise_of_the_contact():
    result = coarse(drive__slip_ratio=0.2)
    tyre, last = result.tyre, result.sliding.series.iloc[-1]
    L, b = tyre.schedule.cases[0][0].footprint_length, tyre.sliding.effusivities
    weights = b[0] * math.sqrt(0.8 * SPEED), b[1] * math.sqrt(SPEED)
    flux = 0.8 * last.contact_pressure_Pa * 0.2 * SPEED
    share = weights[0] / sum(weights)
    rise = 2 * flux * math.sqrt(L / math.pi) / sum(weights)
    expected = share * last.tread_hottest_degC + (1 - share) * 25.0 + rise
    assert last.exit_edge_degC == pytest.approx(expected, rel=1e-9)
    assert last.exit_edge_degC > last.tread_hottest_degC


def test_friction_gives_way_where_rubber_would_decompose():
    hot = coarse(drive__speed="60 m/s", drive__slip_ratio=0.6, drive__duration="2 s")
    phase = hot.sliding.phases[0]
    assert phase.capped
    assert phase.exit_edge_highest == pytest.approx(350.0, abs=1e-6)
    assert phase.friction_lowest < phase.friction == 0.8
    assert any("friction falls from 0.8 to" in line for line in hot.warnings)
    free = coarse(
        drive__speed="60 m/s",
        drive__slip_ratio=0.6,
        drive__duration="2 s",
        boundaries__sliding__decomposition_temperature="1900 degC",
    )
    assert not free.sliding.phases[0].capped
    assert free.sliding.phases[0].exit_edge_highest > 400
    assert free.heat_budget.total("sliding") > hot.heat_budget.total("sliding")


def test_a_tyre_off_the_road_does_not_rub():
    flying = coarse(drive__slip_ratio=1, drive__load="0 N")
    assert flying.heat_budget.total("sliding") == 0
    assert flying.sliding.phases[0].friction_work == 0
    assert flying.tyre.road_fraction(5.0) == 0
    assert not any("ring of such sections" in line for line in flying.warnings)


# -- locked ----------------------------------------------------------------------------------------------------------


def skid(speed, duration, every, size="3 mm", tolerance="0.1 delta_degC"):
    """A locked wheel on asphalt, its contact that of `LockedWheel`, cold at 20 degC."""
    law = {
        "law": "constant", "pressure": "300 kPa", "coefficient": 0.8,
        "road_conductivity": f"{ASPHALT.conductivity} W/m/K", "road_heat_capacity": f"{ASPHALT.heat_capacity} J/m**3/K",
    }  # fmt: skip
    return run(
        ("drive.speed", speed), ("drive.duration", duration), ("output.every", every), ("mesh.size", size),
        ("drive.slip_ratio", 1), ("drive.ambient", "20 degC"), ("output.fields", 2),
        ("mechanics.footprint.law", "given"), ("mechanics.footprint.length", "150 mm"),
        *((f"boundaries.sliding.{key}", value) for key, value in law.items()),
        ("numerics.tolerance", tolerance),
    )  # fmt: skip


def test_a_slow_skid_on_the_tyre_starts_as_equation_5():
    """0.3 m/min: the road stays under the wheel for 30 s, and for a few seconds both are half-spaces that touch."""
    result = skid("0.005 m/s", "3 s", "0.5 s", size="1.5 mm", tolerance="0.001 delta_degC")
    tread = Solid(result.tyre.tread[0], 1.0, result.tyre.tread[1])
    series = result.sliding.series[result.sliding.series.time_s >= 0.5]
    flux = 0.8 * 300e3 * 0.005
    expected = [sliding.shared_rise(flux, t, tread, ASPHALT) for t in series.time_s]
    assert expected[-1] > 1.0
    # What is left is the mean over the footprint, v t/(3 l) of the road's part at most.
    assert series.tread_mean_degC.to_numpy() - 20.0 == pytest.approx(expected, rel=0.025)
    assert series.tread_mean_degC.to_numpy() == pytest.approx(
        series.half_space_degC.to_numpy(), abs=0.01 * expected[-1]
    )


def test_a_locked_wheel_above_50_km_h_is_more_than_200_K_hotter():
    """The tyre's skid ends where `tyrefem slide locked-wheel` says: all heat in the road, at its mean rise."""
    result = skid("50 km/h", "1 s", "0.2 s")
    phase, car = result.sliding.phases[0], LockedWheel()
    rise = result.sliding.series.tread_mean_degC.iloc[-1] - 20.0
    assert rise > 200
    assert phase.half_space_highest - 20.0 > 200
    assert rise == pytest.approx(car.mean_rise(50 / 3.6), rel=0.03)
    assert phase.exit_edge_highest - 20.0 == pytest.approx(car.exit_rise(50 / 3.6), rel=0.03)
    assert not phase.capped
    assert skid("20 km/h", "1 s", "0.2 s").sliding.phases[0].half_space_highest - 20.0 < 200


def test_decomposition_limits_a_fast_skid_as_equation_13():
    result, car = skid("100 km/h", "1 s", "0.2 s"), LockedWheel()
    phase = result.sliding.phases[0]
    assert phase.capped
    assert phase.friction_lowest == pytest.approx(car.friction_at(100 / 3.6), rel=1e-6)
    assert 0.97 * 350 < phase.exit_edge_highest <= 350


def test_a_locked_wheel_makes_no_hysteresis_and_its_section_is_all_the_time_on_the_road():
    result = skid("50 km/h", "1 s", "0.2 s")
    state, budget = result.phases[0], result.heat_budget
    assert (state.locked, state.road_fraction, state.propagation_depth) == (True, 1.0, 0.0)
    assert budget.total("generated") == 0
    assert budget.total("sliding") > 0
    assert budget.imbalance < 1e-9
    assert budget.energies["lost", "road contact"][-1] == budget.energies["lost", "air at the tread"][-1] == 0
    assert result.rolling_resistance.force == 0
    assert result.rolling_reading is None
    ring = 1 / result.tyre.rolling_fraction(0.5)
    assert result.sliding.phases[0].tread_heat == pytest.approx(budget.total("sliding") / ring)
    assert any("a ring of such sections" in line for line in result.warnings)


def test_a_mesh_too_coarse_for_a_skid_is_said():
    warnings = [
        line for line in skid("50 km/h", "0.05 s", "0.01 s", size="8 mm").warnings if "smaller mesh.size" in line
    ]
    assert len(warnings) == 1
    assert not [line for line in skid("50 km/h", "1 s", "0.2 s").warnings if "mesh.size" in line]


# -- what is said ----------------------------------------------------------------------------------------------------


def test_report_shows_sliding_and_its_warnings_above_the_numbers(tmp_path):
    result = skid("100 km/h", "1 s", "0.2 s")
    page = result.report(tmp_path / "report.html").read_text(encoding="utf-8")
    assert len(result.warnings) >= 2
    top = page[: page.index('<ul class="numbers">')]
    # The apostrophes of phase names are escaped.
    assert [line.replace("'", "&#39;") in top for line in result.warnings] == [True] * len(result.warnings)
    assert "Sliding contact, exit edge" in page
    assert re.search(r"<td[^>]*>rolling \(locked\)</td><td>27\.78</td>", page)
    assert "from friction on the road" in page
    assert "Generated + sliding = stored + lost" in page
    # The card's number is that of the half-space, and the table has both.
    phase = result.sliding.hottest
    assert f"half-space {phase.half_space_highest:.1f} °C; phase" in page
    assert f"half-space {phase.half_space_highest:.1f} degC" in "\n".join(phase_lines(result.sliding))
    assert f"<td>{phase.tread_highest:.1f}</td><td>{phase.half_space_highest:.1f}</td>" in page
    assert "Free, straight rolling" not in page
    assert "Free, straight rolling" in coarse().report(tmp_path / "free.html").read_text(encoding="utf-8")


def test_summary_tables_and_terminal_name_the_contact(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    options = ["--set", "mesh.size=8 mm", "--set", "drive.duration=5 s", "--set", "drive.slip_ratio=0.3"]
    assert main(["run", NAME, *options, "--no-pictures", "--no-vtk", "--out", "out"]) == 0
    out = capsys.readouterr().out
    record = json.loads((tmp_path / "out/summary.json").read_text(encoding="utf-8"))
    entry = record["sliding"]["phases"][0]
    assert f"{entry['exit_edge_highest']:.1f} degC at the exit edge" in out
    assert f"mean tread {entry['tread_highest']:.1f} degC" in out
    assert record["heat_budget"]["sliding"]["friction on the road"]["energy_J"] > 0
    table = (tmp_path / "out/sliding.csv").read_text(encoding="utf-8")
    assert table.startswith("phase,time_s,sliding_speed_m_s,")


def test_slip_that_starts_in_a_later_phase_leaves_the_sections_before_alone():
    free = RollingTyre(tf.study("nasa-brake-yaw-skid"))
    assert free.sliding.mean_heat(None, 100.0, np.array([25.0])) == 0
    assert free.sliding.skid_film(100.0) == 0
    assert free.sliding.skid_film(339.5) > 1000
