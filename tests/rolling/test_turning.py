"""`mechanics.rolling = true`: press and heat source with spin, inertia and lag; at rest and without loss as today."""

from __future__ import annotations

import functools
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.cli import main
from tyrefem.errors import InputError, ResultWarning
from tyrefem.mechanics.cycle_schedule import cycle_schedule, same_cycles
from tyrefem.mechanics.footprint.press import Pressed
from tyrefem.mechanics.rolling.lagging_strains import LaggingStrains
from tyrefem.mechanics.rolling.press import press

RAMP = {"from": "0 mph", "to": "60 mph"}
COARSE = {"mesh.size": "16 mm", "mechanics.strain": "fem", "mechanics.motion": "linear"}


def study(**changes: Any) -> tf.Study:
    return tf.study("nasa-22x5.5-8pr", {**COARSE, **{key.replace("__", "."): value for key, value in changes.items()}})


@functools.lru_cache(8)
def pressed(rolling: bool, speed: str = "20 mph") -> Pressed:
    return press(study(mechanics__rolling=rolling, drive__speed=speed), deflection=0.02)


def test_resistance_both_ways_and_growth_at_speed() -> None:
    turning = pressed(True, "60 mph").turning
    assert turning is not None
    numbers = turning.summary()
    assert numbers["rolling_resistance_by_offset_N"] == pytest.approx(numbers["rolling_resistance_by_loss_N"], rel=1e-2)
    assert 1e-3 < numbers["pressure_offset_m"] < 5e-3
    # rho W^2 R^2 h / (stiffness): nine times that of a third of the speed.
    slow = pressed(True, "20 mph").turning
    assert slow is not None
    ratio = numbers["centrifugal_growth_m"] / slow.summary()["centrifugal_growth_m"]
    assert ratio == pytest.approx(9.0, rel=0.12)
    assert isinstance(pressed(True, "60 mph").cycle, LaggingStrains)


def test_slow_rolling_is_todays_press() -> None:
    """W -> 0: no spin, no inertia; the lag changes amplitudes by the second power of tan delta."""
    slow, still = pressed(True, "1 mm/s"), pressed(False, "1 mm/s")
    assert slow.footprint.load == pytest.approx(still.footprint.load, rel=1e-7)
    assert slow.tyre.radius_growth == pytest.approx(still.tyre.radius_growth, rel=1e-7)
    assert slow.loss is not None
    assert still.loss is not None
    assert slow.loss.rolling_resistance == pytest.approx(still.loss.rolling_resistance, rel=3e-2)


def test_without_the_key_nothing_turns() -> None:
    assert pressed(False).turning is None
    assert "rolling" not in pressed(False).summary()
    assert pressed(True).summary()["rolling"]["angular_speed_rad_s"] == pytest.approx(
        8.9408 / pressed(True).footprint.rolling_radius, rel=1e-4
    )


def test_strain_cycles_of_a_drive_follow_its_speed() -> None:
    """A phase that accelerates has cycles at nine speeds; the heat of each grows with inertia and loss."""
    ramp = study(mechanics__rolling=True, drive__speed=RAMP)
    schedule = cycle_schedule(ramp)
    assert len(schedule.knots[0]) == 9
    assert [case.speed for case in schedule.cases[0]] == pytest.approx(np.linspace(0, 26.8224, 9))
    assert len(cycle_schedule(study(drive__speed=RAMP)).knots[0]) == 1
    radii = [case.rolling_radius for case in schedule.cases[0]]
    assert radii[-1] > radii[1] + 3e-4
    energies = [float(cycle.energies.density.mean()) for cycle in schedule.cycles[0]]
    assert all(math.isfinite(energy) and energy > 0 for energy in energies)
    assert energies[-1] != pytest.approx(energies[1], rel=1e-3)


def test_density_and_loss_change_the_cycles_of_a_turning_tyre_only() -> None:
    for rolling in (False, True):
        tyre = study(mechanics__rolling=rolling)
        for key, factor in (("materials.tread.density.value", 1.1), ("materials.tread.loss_tangent.value", 1.1)):
            assert same_cycles(tyre, tyre.scaled(key, factor)) is not rolling


def test_large_motion_has_inertia_and_no_lag() -> None:
    heavy = press(study(mechanics__rolling=True, mechanics__motion="large", drive__speed="60 mph"), deflection=0.012)
    still = press(study(mechanics__motion="large", drive__speed="60 mph"), deflection=0.012)
    assert heavy.turning is not None
    assert heavy.turning.summary()["pressure_offset_m"] is None
    assert "without offset" in heavy.turning.words
    assert heavy.balanced
    assert heavy.tyre.radius_growth > still.tyre.radius_growth + 1e-3
    # Tension of the grown tyre and its inertia nearly cancel: the load of a deflection hardly changes.
    assert heavy.footprint.load == pytest.approx(still.footprint.load, rel=0.02)
    assert heavy.footprint.loaded_radius > still.footprint.loaded_radius + 1e-3


def test_beyond_a_critical_speed_it_warns_and_beyond_all_it_refuses() -> None:
    with pytest.warns(ResultWarning, match="70 m/s are beyond the critical speed of waves that only loss limits"):
        limited = press(study(mechanics__rolling=True, drive__speed="70 m/s"), deflection=0.02)
    assert limited.turning is not None
    with pytest.warns(ResultWarning, match="180 harmonics: the rolling contact has no unique solution"):
        assert "no resistance by offset" in limited.turning.words
    with (
        pytest.warns(ResultWarning, match="beyond the critical speed"),
        pytest.raises(InputError, match="130 m/s are beyond a critical speed of the tyre"),
    ):
        press(study(mechanics__rolling=True, drive__speed="130 m/s"), deflection=0.02)


@pytest.mark.parametrize("rolling", [False, True])
def test_a_negative_speed_is_refused(rolling: bool) -> None:
    with pytest.raises(InputError, match="must be at least 0 m/s, not -3 m/s") as caught:
        press(study(mechanics__rolling=rolling), speed=-3.0)
    assert caught.value.field == "speed"


def test_other_strain_laws_do_not_turn() -> None:
    with pytest.raises(InputError, match='rolling: needs strain = "fem"'):
        tf.study("nasa-22x5.5-8pr", {"mechanics.rolling": True}).card  # noqa: B018


def test_command_prints_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    sets = [part for key, value in COARSE.items() for part in ("--set", f"{key}={value}")]
    line = ["press", "nasa-22x5.5-8pr", *sets, "--set", "mechanics.rolling=true", "--no-pictures", "--no-vtk"]
    assert main([*line, "--deflection", "20 mm", "--out", "out"]) == 0
    text = capfd.readouterr().out
    assert " by spin; pressure " in text
    assert " N by offset, " in text
