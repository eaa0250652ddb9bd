"""Wear by ring: energy of a passing, the card's law, worn sections that load, refusals."""

from __future__ import annotations

import copy
import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import tomli_w

import tyrefem as tf
from tyrefem import library
from tyrefem.errors import InputError
from tyrefem.geometry import load
from tyrefem.geometry.builder import section_of
from tyrefem.inputs.loading import LoadCase
from tyrefem.materials.card import MaterialCard
from tyrefem.materials.wear import Wear
from tyrefem.mechanics.cycle_schedule import CycleSchedule
from tyrefem.mechanics.rolling.friction_rings import FrictionRings
from tyrefem.reports.wear import unresolved
from tyrefem.wear.drive_wear import drive_wear
from tyrefem.wear.ring_wear import RingWear, tread_table
from tyrefem.wear.worn_section import LEFT, WornFace, WornProfile, worn_section
from tyrefem.wear.worn_shoulder import WornShoulder

TABLE = {"depth": "5 nm", "energy": "1 kJ/m**2", "source": "test"}
STUDY = "passenger-205-55r16"


def rings(power: float = 50.0, count: int = 41, exponent: float = 1.0) -> RingWear:
    """Rings of the shipped passenger's tread with one friction power each."""
    section = load(STUDY)
    s = np.linspace(-0.0775, 0.0775, count)
    places = section.place(s, section.total_thickness(s)).T
    table = Wear.check({**TABLE, "exponent": exponent})
    return RingWear(places, np.full(count, 0.155 / count), np.full(count, power / count), 70.0, 1.95, table)


@pytest.mark.fast
def test_rings_with_negative_friction_power_are_mentioned() -> None:
    """They count as not worn, so that the wear of a coarse mesh is too high."""
    wear = rings()
    assert unresolved(wear) == []
    power = wear.power.copy()
    power[[3, 4, 20]] = -1.0
    (line,) = unresolved(replace(wear, power=power))
    assert "3 of 41 rings is negative, -3 W in all" in line
    assert "mesh.size is too coarse" in line


@pytest.mark.fast
def test_all_friction_energy_is_shared_out() -> None:
    wear = rings()
    # Energy of one revolution, J, over the rings.
    assert float((wear.energy * wear.areas).sum()) == pytest.approx(50.0 * 2 * np.pi / 70.0, rel=1e-12)
    # Exponent 1: volume per km = 5e-12 m3/J times the energy of a kilometre.
    per_km = 50.0 * 2 * np.pi / 70.0 * 1e3 / 1.95
    assert wear.volume_per_km == pytest.approx(5e-12 * per_km, rel=1e-12)


@pytest.mark.fast
def test_its_arrays_cannot_be_changed_in_place() -> None:
    """``depth *= 1e3`` for millimetres would have changed what `save` writes."""
    wear = rings()
    for values in (wear.depth_per_km, wear.places, wear.power):
        with pytest.raises(ValueError, match="read-only"):
            values *= 1e3


@pytest.mark.fast
def test_exponent_and_slipping_backwards() -> None:
    once, twice = rings(50.0, exponent=2.0), rings(100.0, exponent=2.0)
    np.testing.assert_allclose(twice.depth_per_km / once.depth_per_km, 4.0, rtol=1e-12)
    assert Wear.check(TABLE).of([-1.0, 0.0]).tolist() == [0.0, 0.0]


@pytest.mark.fast
def test_transverse_grooves_bear_no_friction() -> None:
    """The same power on less rubber wears deeper, and the same volume (exponent 1)."""
    solid = rings()
    cut = replace(solid, rubber=0.8)
    # The mean depth, over the area of the rubber, is the volume.
    assert cut.mean * 0.8 * cut.areas.sum() == pytest.approx(cut.volume_per_km, rel=1e-12)
    np.testing.assert_allclose(cut.depth_per_km, solid.depth_per_km / 0.8, rtol=1e-12)
    assert cut.volume_per_km == pytest.approx(solid.volume_per_km, rel=1e-12)


def test_the_sections_pattern_counts_in_state_and_drive() -> None:
    pattern = {"void": 0.1, "block_length": "20 mm", "source": "test"}
    study = tf.study("nasa-22x5.5-8pr", {**DRIVE, "drive.duration": "10 s", "section.pattern": pattern})
    full, half = (study.replace({"mesh.section": name}).roll(slip_angle=0.01).wear() for name in ("full", "half"))
    assert [full.rubber, study.wear().rubber] == pytest.approx([0.9, 0.9])
    # In a turn to the left each side has its own friction, of a half section, too.
    left, right = ([float(each.power[side * each.places[1] > 0].sum()) for each in (full, half)] for side in (1, -1))
    assert left[1] == pytest.approx(left[0], rel=1e-3)
    assert right[1] == pytest.approx(right[0], rel=1e-3)
    assert abs(left[0] / right[0] - 1) > 0.01


DRIVE = {
    "mesh.size": "14 mm", "mesh.section": "full", "mechanics.strain": "fem", "mechanics.motion": "linear",
    "drive.load": "4 kN", "boundaries.sliding": "rolling",
    "materials.tread": {"base": "nasa-tread", "friction": {"coefficient": 1.0, "source": "test"}, "wear": TABLE},
}  # fmt: skip


def test_a_drive_wears_as_its_phases_by_their_distance() -> None:
    phases = [
        {"name": "left", "slip_angle": "2 deg", "duration": "100 s"},
        {"name": "straight", "duration": "300 s", "speed": "10 mph"},
        {"name": "stop", "duration": "50 s", "speed": "0 m/s"},
    ]
    study = tf.study("nasa-22x5.5-8pr", {**DRIVE, "drive.phases": phases})
    wear = study.wear()
    rolled = study.roll(slip_angle=math.radians(2)).wear()
    left, straight = wear.by_phase["left"], wear.by_phase["straight"]
    assert set(wear.by_phase) == {"left", "straight"}
    assert left[2] == pytest.approx(rolled.mean, rel=1e-9)
    assert wear.distance == pytest.approx(left[0] + straight[0])
    assert left[0] / straight[0] == pytest.approx(200 / 300)
    assert wear.mean == pytest.approx((left[0] * left[2] + straight[0] * straight[2]) / wear.distance, rel=1e-12)
    # The work of the phase is power times time.
    assert left[1] == pytest.approx(rolled.power.sum() * 100, rel=1e-9)
    assert float(wear.power.sum()) * 450 == pytest.approx(left[1] + straight[1], rel=1e-3)
    # Exponent 1: the volume is in proportion to the energy of a metre.
    assert wear.volume_per_km == pytest.approx(
        5e-12 * float((wear.energy * wear.areas).sum()) * 1e3 / wear.travel, rel=0.01
    )


@pytest.mark.fast
def test_rolling_without_load_counts_for_the_distance(monkeypatch: pytest.MonkeyPatch) -> None:
    """Half of a drive under load wears half as much per kilometre; a ramp of the load loses no distance."""
    phases = [
        {"name": "rise", "load": {"from": "0 kN", "to": "4 kN"}, "duration": "100 s"},
        {"name": "lifted", "load": "0 kN", "duration": "300 s"},
    ]
    study = tf.study("nasa-22x5.5-8pr", {**DRIVE, "drive.phases": phases})
    even, one = rings(50.0, count=5), np.ones(5)
    friction = FrictionRings(even.places, even.widths, 2.0 * one, 0.1 * one, 0.1, 0.02, 1.0, 0.3)
    under_load: Any = SimpleNamespace(friction=friction, footprint=object())
    free: Any = SimpleNamespace(friction=None, footprint=None)
    case = LoadCase(4e3, 0.01, 5e5, 0.28)
    schedule = CycleSchedule(
        study.card.drive, ((0.0, 1.0), (0.0,)), ((case, case), (case,)), ((free, under_load), (free,))
    )
    monkeypatch.setattr("tyrefem.wear.drive_wear._schedule", lambda study: schedule)
    wear = drive_wear(study)
    way = study.card.drive.phases[0].speed.start * 400.0
    assert wear.distance == pytest.approx(way)
    assert [wear.by_phase[name][0] for name in ("rise", "lifted")] == pytest.approx([way / 4, way * 3 / 4])
    assert [wear.by_phase[name][1] for name in ("rise", "lifted")] == pytest.approx([10.0 * way / 8, 0.0])
    (state,) = wear.states
    assert wear.mean == pytest.approx(state.mean / 8)
    assert wear.travel == pytest.approx(state.travel)
    assert wear.energy == pytest.approx(state.energy / 8)


@pytest.mark.fast
@pytest.mark.parametrize("name", [STUDY, "truck-295-80r22.5"])
def test_shipped_treads_wear(name: str) -> None:
    assert tread_table(tf.study(name)).depth == pytest.approx(5e-9)


@pytest.mark.fast
def test_the_wear_of_a_drive_needs_rolling() -> None:
    with pytest.raises(InputError, match=r"needs boundaries\.sliding = 'rolling'"):
        tf.study(STUDY).wear()


@pytest.mark.fast
def test_a_worn_section_loads_and_is_thinner_by_the_wear(tmp_path: Path) -> None:
    study, wear = tf.study(STUDY), rings()
    new = study.section
    data = worn_section(study, wear, 10_000.0)
    (tmp_path / "worn.toml").write_text(tomli_w.dumps(data), encoding="utf-8")
    old = load(str(tmp_path / "worn.toml"))
    s = np.array([0.0, 0.03, 0.06])
    gone = new.total_thickness(s) - old.total_thickness(s)
    worn = WornFace.of(new, wear)
    np.testing.assert_allclose(gone, worn.profile(s) * worn.ring_kilometres(10_000.0), rtol=1e-3)
    beyond = np.array([0.09, 0.12])
    np.testing.assert_allclose(old.total_thickness(beyond), new.total_thickness(beyond), atol=1e-6)
    changes = {"section": str(tmp_path / "worn.toml"), "sensors.shoulder-surface.depth": "13 mm", "mesh.size": "8 mm"}
    replaced = study.replace(changes)
    assert replaced.mesh().n_nodes > 100
    assert replaced.section.outer_diameter == pytest.approx(new.outer_diameter - 2 * gone[0], abs=2e-6)


@pytest.mark.fast
def test_a_worn_section_loses_the_volume_of_its_rings() -> None:
    """Means over 10 mm alone change it by 1 % where wear grows towards the edges."""
    even = rings()
    edges = replace(even, power=even.power * np.linspace(-2.0, 2.0, len(even.power)) ** 4)
    profile = WornProfile.of(load(STUDY), edges)
    s = load(STUDY).locate(edges.places.T)[0]
    assert profile(s) @ edges.areas == pytest.approx(edges.volume_per_km, rel=1e-9)


@pytest.mark.fast
def test_a_shoulder_with_transverse_grooves_is_in_the_volume_of_the_rings() -> None:
    """Transverse grooves of a fifth counted as rubber of the shoulder: 1.4 % of the volume was left on the tread."""
    section, cut = load(STUDY), replace(rings(), rubber=0.8)
    worn, kilometres = WornFace.of(section, cut), 3e-3 / cut.mean
    ring_km = worn.ring_kilometres(kilometres)
    depths = worn.profile(section.locate(cut.places.T)[0]) * ring_km
    face = float(depths @ cut.areas) + worn.shoulder.volume(ring_km * float(worn.profile.depth[-1]))
    assert 0.8 * face == pytest.approx(cut.volume_per_km * kilometres, rel=1e-6)


@pytest.mark.fast
def test_the_worn_face_goes_on_to_the_shoulder() -> None:
    """No step at the last ring; the shoulder's rubber is in the volume of the rings."""
    study, even = tf.study(STUDY), rings(150.0, count=401)
    new, kilometres = study.section, 20_000.0
    rubber = ~new.in_groove(new.locate(even.places.T)[0])
    sides = np.stack([np.ones(401), np.sign(np.linspace(-1, 1, 401))])
    widths = np.hypot(*np.gradient(even.places * sides, axis=1))[rubber]
    wear = replace(even, places=even.places[:, rubber], widths=widths, power=even.power[rubber])
    old = section_of((worn_section(study, wear, kilometres), Path("worn.toml"), "worn"))
    s = np.linspace(0.0, 0.12, 2401)
    gone = new.total_thickness(s) - old.total_thickness(s)
    end, deepest = 0.0775, gone[s <= 0.0775].max()
    beyond = (s > end + 0.5e-3) & (gone > 0.1 * deepest)
    assert deepest > 1.5e-3
    assert beyond.sum() * (s[1] - s[0]) > 1e-3
    assert np.abs(np.diff(gone)).max() < s[1] - s[0]
    lost = (2 if new.half else 1) * (new.volume() - old.volume())
    assert lost == pytest.approx(wear.volume_per_km * kilometres, rel=0.01)


def test_the_shoulder_of_a_cylinder_is_cut_along_its_face() -> None:
    """A tread 0.3 m from the axis whose shoulder falls by 45 degrees: as far outwards as down, a triangle."""
    s = np.linspace(0.0, 0.02, 201)
    places = np.column_stack([0.3 - s, 0.07 + s])
    shoulder = WornShoulder(s, places, np.tile([1.0, 0.0], (201, 1)), s, np.ones(201))
    assert shoulder.reach(4e-3) == pytest.approx(4e-3)
    np.testing.assert_allclose(
        shoulder.depth(np.array([-0.01, 1e-3, 3e-3, 5e-3]), 4e-3), [0.0, 3e-3, 1e-3, 0.0], atol=1e-9
    )
    radius = 0.3 - 4e-3 * 2 / 3
    assert shoulder.volume(4e-3) == pytest.approx(2 * 2 * np.pi * radius * 8e-6, rel=1e-4)


def test_a_tread_that_is_worn_through_is_refused() -> None:
    study, wear = tf.study(STUDY), rings()
    with pytest.raises(InputError, match=r"worn through .* km leave 0\.5 mm") as caught:
        worn_section(study, wear, 1e6)
    assert caught.value.field == "distance"
    most = float(caught.value.message.split(": ")[1].split(" km")[0].replace(",", ""))
    last = section_of((worn_section(study, wear, most - 1), Path("worn.toml"), "worn"))
    assert last.layers[-1].thickness(np.linspace(0.0, 0.0775, 400)).min() == pytest.approx(0.5e-3, abs=1e-4)
    # Hard cornering wears more than the radius of the wheel in some thousand km.
    for kilometres in (3e7, 1e12):
        with pytest.raises(InputError, match=rf"worn through .* {round(most):,d} km leave 0\.5 mm"):
            worn_section(study, wear, kilometres)


@pytest.mark.fast
@pytest.mark.parametrize(
    ("changes", "field"), [({"depth": "-5 nm"}, "wear.depth"), ({"exponent": 0}, "wear.exponent"), ({"law": 1}, "wear")]
)
def test_refused_numbers_of_a_card(changes: dict[str, object], field: str) -> None:
    data = copy.deepcopy(library.load("material", "rubber-tread-passenger")[0])
    with pytest.raises(InputError) as caught:
        MaterialCard.check({**data, "wear": {**TABLE, **changes}})
    assert caught.value.field == field


@pytest.mark.fast
def test_inner_layers_of_a_worn_section_keep_their_factors() -> None:
    """The sidewall's factor holds in the layers below the outermost one too."""
    study = tf.study(STUDY, {"section.thickness_scale": {"sidewall": 1.3, "belt-1": 1.1}})
    old = section_of((worn_section(study, rings(), 10_000.0), Path("worn.toml"), "worn"))
    s = np.linspace(0.0, study.section.line.length, 60)
    for before, after in zip(study.section.layers[:-1], old.layers[:-1], strict=True):
        np.testing.assert_allclose(after.thickness(s), before.thickness(s), rtol=1e-6)


@pytest.mark.fast
def test_a_table_that_ends_with_the_meridian_is_worn_too() -> None:
    """Its last station is not rounded to one before the end of the meridian."""
    name = "truck-295-80r22.5"
    section = load(name)
    table, length = section.layers[-1].thickness, section.line.length
    stations = {"unit": "m", "values": [*(s for s in table.s if s < length), length]}
    values = {"unit": "m", "values": table(np.array(stations["values"])).tolist()}
    study = tf.study(name, {"section.layers.tread.s": stations, "section.layers.tread.thickness": values})
    assert study.section.layers[-1].thickness.s[-1] == length
    worn = section_of((worn_section(study, rings(), 10_000.0), Path("worn.toml"), "worn"))
    assert worn.line.length == pytest.approx(length)


@pytest.mark.fast
def test_layers_that_would_move_as_the_tread_wears_are_refused() -> None:
    with pytest.raises(InputError, match="placed by 'total'") as caught:
        worn_section(tf.study("nasa-22x5.5-12pr"), rings(), 1000.0)
    assert caught.value.field == "section.line.reference"


@pytest.mark.fast
def test_a_thin_sidewall_is_not_worn_through() -> None:
    """Where nothing wears the outermost layer may be thinner than the tread that must be left."""
    study = tf.study(STUDY, {"section.thickness_scale.sidewall": 0.15, "sensors": {}})
    assert min(study.section.layers[-1].thickness.values) < LEFT
    worn = section_of((worn_section(study, rings(), 10_000.0), Path("worn.toml"), "worn"))
    assert worn.layers[-1].thickness(0.13) == pytest.approx(study.section.layers[-1].thickness(0.13), rel=1e-4)
