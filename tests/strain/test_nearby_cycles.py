"""Strain cycles near a study: exact where they were solved, close between, of few solutions; None elsewhere."""

from __future__ import annotations

import functools
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.mechanics.cycle_schedule import cycle_schedule
from tyrefem.mechanics.nearby_cycles import NearbyCycles, SolvedCycles
from tyrefem.simulation.rolling_tyre import RollingTyre

SD = {
    "materials.tread.shear_modulus.value": 0.2,
    "materials.carcass.cord.ply_shear_modulus": 0.2,
    "drive.load": 0.05,
    "materials.tread.conductivity.value": 0.15,
}
COARSE = {"mesh.size": "14 mm", "mesh.element": "P1", "drive.duration": "60 s", "uncertainty": SD}
COARSE["mechanics.motion"] = "linear"


@functools.cache
def study(law: str = "fem") -> tf.Study:
    return tf.study("nasa-22x5.5-8pr", {"mechanics.strain": law, **COARSE})


@functools.cache
def near(law: str = "fem") -> NearbyCycles:
    return NearbyCycles(study(law))


def moved(law: str = "fem", **factors: float) -> tf.Study:
    changed = study(law)
    for key, factor in factors.items():
        changed = changed.scaled({"tread": "materials.tread.shear_modulus.value", "load": "drive.load",
                                  "plies": "materials.carcass.cord.ply_shear_modulus"}[key], factor)  # fmt: skip
    return changed


def parts(schedule: Any) -> dict[str, float]:
    """Mean strain energy density of the Gauss points by region, J/m3."""
    ((cycle,),) = schedule.cycles
    energies = getattr(cycle, "energies", cycle)
    return {
        region: float(energies.density[members].mean())
        for region, members in energies.points.members.items()
        if region in study().materials
    }


def test_only_what_moves_the_strain_cycle_is_solved_for() -> None:
    assert {number.key for number in near().numbers} == set(SD) - {"materials.tread.conductivity.value"}


@pytest.mark.parametrize("law", ["fem", "barrel"])
def test_a_number_at_its_deviation_is_exact(law: str) -> None:
    other = moved(law, tread=1.2)
    nearby, full = near(law).schedule_of(other), cycle_schedule(other)
    assert nearby is not None
    assert parts(nearby) == pytest.approx(parts(full), rel=1e-9)
    case, exact = nearby.cases[0][0], full.cases[0][0]
    assert (case.load, case.deflection) == pytest.approx((exact.load, exact.deflection), rel=1e-9)
    assert case.rolling_radius == pytest.approx(exact.rolling_radius, rel=1e-9)
    assert case.footprint_length == pytest.approx(exact.footprint_length, rel=1e-9)


def test_several_numbers_at_once_are_close() -> None:
    """All one standard deviation off, two of them down: what is left is of second order."""
    factors = {"tread": 1 / 1.2, "plies": 1.2, "load": 0.95}
    nearby, full = (parts(item) for item in (near().schedule_of(moved(**factors)), cycle_schedule(moved(**factors))))
    before = parts(near().schedule)
    change = np.array([math.log(full[item] / before[item]) for item in before])
    off = np.array([math.log(nearby[item] / full[item]) for item in before])
    assert np.abs(change).max() > 0.08
    assert np.abs(off).max() < 0.25 * np.abs(change).max()
    deflection = near().schedule_of(moved(**factors)).cases[0][0].deflection
    assert deflection == pytest.approx(cycle_schedule(moved(**factors)).cases[0][0].deflection, rel=0.01)


def test_the_load_is_the_drives_to_the_digit() -> None:
    nearby = near().schedule_of(moved(load=0.97))
    assert nearby.cases[0][0].load == cycle_schedule(moved("arcs", load=0.97)).cases[0][0].load


def test_another_tyre_is_not_near() -> None:
    assert near().schedule_of(study().replace({"materials.bead.youngs_modulus.value": "10e6 psi"})) is None
    assert near().schedule_of(study().replace({"mesh.size": "12 mm"})) is None
    assert near().schedule_of(study().replace({"mechanics.loss_convention": "sinusoid"})) is None
    other = study().replace({"materials.tread.conductivity.value": "0.3 W/m/K"})
    assert near().schedule_of(other).cases[0][0] == near().schedule.cases[0][0]


def worn(law: str, fraction: float, study: tf.Study | None = None) -> tf.Study:
    return (study or moved(law)).replace({"effects": [{"name": "worn-tread", "fraction": fraction}]})


@pytest.mark.parametrize("law", ["fem", "barrel"])
def test_a_worn_section_is_exact_where_it_is_solved_and_close_between(law: str) -> None:
    for fraction, off in ((0.2, 1e-9), (0.25, 2e-3)):
        tyre = worn(law, fraction)
        nearby, full = near(law).schedule_of(tyre), cycle_schedule(tyre)
        assert nearby is not None
        change = {item: math.log(value / parts(near(law).schedule)[item]) for item, value in parts(full).items()}
        assert max(map(abs, change.values())) > 0.015
        assert parts(nearby) == pytest.approx(parts(full), rel=off)
        ((cycle,),), ((exact,),) = nearby.cycles, full.cycles
        np.testing.assert_allclose(cycle.points.points, exact.energies.points.points, rtol=0, atol=1e-6)
        assert nearby.cases[0][0].deflection == pytest.approx(full.cases[0][0].deflection, rel=off)


def test_numbers_of_a_worn_section_act_in_proportion() -> None:
    tyre = worn("barrel", 0.2, moved("barrel", load=1.05))
    nearby, full = near("barrel").schedule_of(tyre), cycle_schedule(tyre)
    assert parts(nearby) == pytest.approx(parts(full), rel=0.02)
    assert parts(nearby) != pytest.approx(parts(cycle_schedule(worn("barrel", 0.2))), rel=0.05)


def test_a_tread_worn_in_another_way_is_solved_by_itself() -> None:
    base = worn("barrel", 0.1)
    assert NearbyCycles(base).schedule_of(worn("barrel", 0.3)) is None


def test_tyres_like_a_tyre_take_its_nearby_cycles(monkeypatch: pytest.MonkeyPatch) -> None:
    base = RollingTyre(study(), near=near())
    _ = near().schedule_of(moved(tread=1.1, plies=0.9, load=1.02))

    def refuse(*_: Any) -> Any:
        raise AssertionError("a strain cycle was solved again")

    monkeypatch.setattr("tyrefem.mechanics.solid.inflation.inflate", refuse)
    first = RollingTyre(moved(tread=1.3, plies=0.8), base)
    second = RollingTyre(moved(tread=0.7, load=1.05), first)
    assert parts(first.schedule) != pytest.approx(parts(base.schedule), rel=0.01)
    assert parts(second.schedule) == pytest.approx(parts(near().schedule_of(second.study)))


def test_other_processes_read_worn_sections(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tyre = worn("barrel", 0.1)
    schedule = NearbyCycles(study("barrel"), SolvedCycles(tmp_path)).schedule_of(tyre)
    second = NearbyCycles(study("barrel"), SolvedCycles(tmp_path))
    _ = second.schedule
    monkeypatch.setattr("tyrefem.mechanics.barrel.provider", lambda _: lambda _: pytest.fail("solved again"))
    again = second.schedule_of(tyre)
    assert parts(again) == parts(schedule)
    np.testing.assert_array_equal(again.cycles[0][0].points.points, schedule.cycles[0][0].points.points)


def test_other_processes_read_what_was_solved(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = NearbyCycles(study(), SolvedCycles(tmp_path))
    schedule = first.schedule_of(moved(tread=1.1))
    assert len(list(tmp_path.glob("*.npz"))) == 1
    second = NearbyCycles(study(), SolvedCycles(tmp_path))
    _ = second.schedule
    monkeypatch.setattr(
        "tyrefem.mechanics.footprint.contact.Pressing.solve", lambda *_, **__: pytest.fail("solved again")
    )
    again = second.schedule_of(moved(tread=1.1))
    assert parts(again) == parts(schedule)
    assert again.cases == schedule.cases
