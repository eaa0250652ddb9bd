"""LifeData of shipped tyres on coarse meshes: temperature, Miner's sum, mean strain, what is left out, refusals."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import tyrefem
from tyrefem.errors import InputError, ResultWarning
from tyrefem.fatigue.life import LifeData, check, life
from tyrefem.fatigue.matrix_cycle import STEPS, MatrixCycle
from tyrefem.fatigue.places import APART, first_places
from tyrefem.fatigue.sensitivity import changed, shifts, shifts_of
from tyrefem.mechanics.cycle_schedule import cycle_schedule

#: A light load: large motion then takes a second.
TENTH = "1 kN"
COARSE = {"mesh.size": "14 mm", "mechanics.strain": "fem", "mechanics.motion": "linear", "drive.duration": "60 s"}


def tyre(**changes: Any) -> tyrefem.api.Study:
    return tyrefem.study("nasa-22x5.5-8pr", {**COARSE, **{key.replace("__", "."): v for key, v in changes.items()}})


@pytest.fixture(scope="module")
def at_60() -> LifeData:
    return life(tyre(), temperature=60.0)


def test_the_bead_has_no_table_and_is_left_out(at_60: LifeData) -> None:
    assert at_60.left_out == ("bead",)
    assert set(at_60.regions) == {"carcass", "tread", "sidewall"}
    assert np.isnan(at_60.km[at_60.members("bead")]).all()
    assert np.isfinite(at_60.km[at_60.members("carcass")]).all()


def test_its_arrays_cannot_be_changed_in_place(at_60: LifeData) -> None:
    for values in (at_60.km, at_60.normals, at_60.temperatures, at_60.element_km):
        with pytest.raises(ValueError, match="read-only"):
            values *= 1e3


def test_normals_are_unit_vectors_and_energies_are_ordered(at_60: LifeData) -> None:
    inside = np.isfinite(at_60.km)
    np.testing.assert_allclose(np.linalg.norm(at_60.normals[inside], axis=-1), 1.0, rtol=1e-12)
    assert (at_60.peak[inside] >= at_60.valley[inside]).all()
    np.testing.assert_allclose(at_60.shares[:, inside], 1.0, rtol=1e-12)


def test_warmer_rubber_lasts_shorter_by_its_temperature_factor(at_60: LifeData) -> None:
    hot = life(tyre(), temperature=110.0)
    inside = np.isfinite(hot.km) & (hot.km < 1e11)
    rate = at_60.study.materials["carcass"].fatigue.temperature_rate  # type: ignore[union-attr]
    np.testing.assert_allclose(hot.km[inside] / at_60.km[inside], np.exp(-50 * rate), rtol=1e-9)
    np.testing.assert_allclose(hot.temperatures[inside], 110.0)


def test_distance_does_not_depend_on_speed_or_duration_at_a_given_temperature(at_60: LifeData) -> None:
    other = life(tyre(drive__speed="35 mph", drive__duration="20 s"), temperature=60.0)
    inside = np.isfinite(at_60.km)
    np.testing.assert_allclose(other.km[inside], at_60.km[inside], rtol=1e-9)


def test_kilometres_are_those_of_the_road(at_60: LifeData) -> None:
    """A wheel that brakes with 20 % of slip turns 20 % less often on the same way."""
    braked = life(tyre(drive__slip_ratio=0.2, boundaries__sliding="constant"), temperature=60.0)
    assert braked.distance == pytest.approx(at_60.distance, rel=1e-9)
    inside = np.isfinite(at_60.km)
    np.testing.assert_allclose(braked.km[inside], at_60.km[inside] / 0.8, rtol=1e-6)


def test_miners_sum_of_two_loads() -> None:
    """1/L of a drive of two phases is the mean of both 1/L by distance, on the plane of the worse sum."""
    light, heavy = ({"name": name, "duration": "60 s", "load": load} for name, load in (("a", "6 kN"), ("b", "9 kN")))

    def of(*phases: dict[str, str]) -> LifeData:
        study = tyre()
        drive = {key: value for key, value in study.data["drive"].items() if key not in ("load", "duration")}
        return life(study.replace({"drive": {**drive, "phases": list(phases)}}), temperature=60.0)

    both, first, second = of(light, heavy), of(light), of(heavy)
    inside = np.isfinite(both.km)
    rates = (1 / first.km[inside] + 1 / second.km[inside]) / 2
    assert both.distance == pytest.approx(first.distance + second.distance)
    # Each alone chooses its plane, so that the sum of both is an upper bound; it is close where these agree.
    together = 1 / both.km[inside]
    print(np.sort(together / rates)[-5:], np.sort(together / rates)[:5], np.median(together / rates))
    assert (together <= 1.01 * rates).all()
    assert np.median(together / rates) > 0.95
    np.testing.assert_allclose(both.shares[:, inside].sum(axis=0), 1.0, rtol=1e-9)


def test_the_path_begins_at_rest_and_closes() -> None:
    cycle: Any = cycle_schedule(tyre()).cycles[0][0]
    matrix = MatrixCycle(cycle)
    members = np.asarray(cycle.tyre.mesh.subdomains["carcass"])
    energies = matrix.energies("carcass", members)
    assert np.abs(energies.strain[:, 0]).max() == 0.0
    assert np.abs(energies.stress[:, 0]).max() < 1e-6
    np.testing.assert_allclose(energies.strain[:, STEPS], energies.strain[:, -1], atol=1e-6)
    # Opposite the footprint the tyre has nearly its inflated strain, which is the mean of the cycle.
    f = np.moveaxis(cycle.tyre.deformation[:, :, members], (0, 1), (-2, -1))
    hoop = np.log(f[..., 2, 2]).ravel()
    assert np.abs(energies.strain[:, STEPS, 2] - hoop).max() < 0.1 * np.abs(energies.strain[..., 2]).max()


def test_stress_of_the_rubber_is_that_of_its_compound() -> None:
    """Deviator: that of the neo-Hookean law, 2 G e for small strain, whatever the cords bear."""
    cycle: Any = cycle_schedule(tyre()).cycles[0][0]
    members = np.asarray(cycle.tyre.mesh.subdomains["carcass"])
    energies = MatrixCycle(cycle).energies("carcass", members)
    modulus = cycle.tyre.body.parts["carcass"].compound.shear_modulus
    deviator, strain = energies.stress.copy(), energies.strain.copy()
    for values in (deviator, strain):
        values[..., :3] -= values[..., :3].mean(axis=-1, keepdims=True)
    small = np.abs(energies.strain).max(axis=-1) < 0.02
    assert small.any()
    np.testing.assert_allclose(deviator[small], 2 * modulus * strain[small], atol=0.05 * 2 * modulus * 0.02)


def test_temperatures_of_the_run_are_used() -> None:
    study = tyre()
    result = study.run()
    course, plateau = (life(study, result=result, plateau=late) for late in (False, True))
    inside = np.isfinite(course.km)
    assert (course.temperatures[inside] > 24.9).all()
    assert course.temperatures[inside].max() < result.peaks["tyre"].temperature
    assert plateau.temperatures[inside].mean() > course.temperatures[inside].mean() + 1
    hottest = int(np.nanargmax(plateau.temperatures.max(axis=1)))
    assert plateau.element_km[hottest] < course.element_km[hottest]


@pytest.mark.parametrize("plateau", [False, True])
def test_an_interrupted_run_has_no_life(plateau: bool) -> None:
    """The phases that it did not reach have no temperatures."""
    study = tyre()
    result = study.run()
    part = replace(result.history, times=result.times[:5], values=result.history.values[:5], interrupted=True)
    with pytest.raises(InputError, match=r"result: the run ends at .* s of 60 s"):
        life(study, result=replace(result, history=part), plateau=plateau)


@pytest.mark.parametrize("size", ["8 mm", "10 mm"])
def test_temperatures_are_known_where_the_meshes_differ(size: str) -> None:
    """Straight edges of the mechanical mesh lie up to their sagitta beyond the hollow side of the section."""
    warm = life(tyre(mesh__size=size))
    inside = np.isfinite(warm.km)
    assert warm.shortest > 0
    assert (warm.temperatures[inside] > 24.9).all()


def test_places_are_sorted_and_apart(at_60: LifeData) -> None:
    places = first_places(at_60)
    assert len(places) == 10
    lives = [place.km for place in places]
    assert lives == sorted(lives)
    assert lives[0] == at_60.shortest
    for number, place in enumerate(places):
        assert 0 <= place.plane_from_circumference <= 90
        assert place.region in place.reason
        for other in places[:number]:
            assert place.region != other.region or np.hypot(place.r - other.r, place.z - other.z) >= APART


def test_a_change_reaches_every_phase() -> None:
    study = tyrefem.study("nasa-taxi-takeoff")
    faster = study.replace(changed(study, "speed")).data["drive"]["phases"]
    assert faster[0]["speed"] == "22 mph"
    assert faster[2]["speed"] == {"from": "0 mph", "to": "176 mph"}
    assert changed(study, "pressure") == {"drive.pressure": "234.9 psi"}
    warmer = study.replace(changed(study, "ambient")).data["drive"]
    assert warmer["ambient"] == "35 degC"
    assert [phase.get("ambient") for phase in warmer["phases"]] == [None, None, None, "25 degC"]


def test_a_change_reaches_phases_that_give_all_and_are_named_by_numbers() -> None:
    phases = [
        {"name": "1", "speed": "10 mph", "ambient": "20 degC"},
        {"name": "0", "speed": {"from": "10 mph", "to": "30 mph"}, "ambient": "30 degC"},
    ]
    study = tyrefem.study("nasa-22x5.5-8pr", {"drive.phases": phases})
    faster = study.replace(changed(study, "speed")).data["drive"]["phases"]
    assert [phase["speed"] for phase in faster] == ["11 mph", {"from": "11 mph", "to": "33 mph"}]
    warmer = study.replace(changed(study, "ambient")).card.drive
    assert [phase.ambient.start for phase in warmer.phases] == [30.0, 40.0]


@pytest.mark.parametrize("law", ["arcs", "barrel"])
def test_a_law_without_strains_over_a_revolution_is_refused(law: str) -> None:
    with pytest.raises(InputError, match=r"mechanics\.strain = ") as caught:
        check(tyre(mechanics__strain=law))
    assert caught.value.field == "mechanics.strain"


def test_no_card_with_fatigue_is_refused() -> None:
    study = tyre().replace({f"materials.{region}": "nasa-bead" for region in ("carcass", "tread", "sidewall", "bead")})
    with pytest.raises(InputError, match=r"\[fatigue\]"):
        check(study)


def test_a_tyre_at_rest_has_no_life() -> None:
    with pytest.raises(InputError, match="never rolls"):
        life(tyre(drive__speed="0 mph"), temperature=60.0)


def test_a_change_that_the_drive_cannot_take_is_left_out(at_60: LifeData) -> None:
    """10 % more than 380 m/s is beyond what a drive may have; the other changes stay."""
    fast = replace(at_60, study=tyre(drive__speed="380 m/s"))
    with pytest.warns(ResultWarning, match=r"speed \+ 10 % is left out: '418 m/s' is out of range"):
        made = shifts(fast, ("speed", "ambient"))
    assert [shift.change for shift in made] == ["ambient + 10 K"]


def test_more_deflection_is_not_more_load(at_60: LifeData) -> None:
    study = tyre()
    drive = {key: value for key, value in study.data["drive"].items() if key != "load"}
    pressed = replace(at_60, study=study.replace({"drive": {**drive, "deflection": "20 mm"}}))
    (shift,) = shifts(pressed, ("load",))
    assert shift.change == "deflection + 10 %"


def test_large_motion_takes_the_gradient_of_the_balance() -> None:
    """H at the Gauss points is that of `WheelAngles.gradient`; rigid rotations leave no strain."""
    study = tyre(mechanics__motion="large", drive__load=TENTH)
    cycle: Any = cycle_schedule(study).cycles[0][0]
    matrix = MatrixCycle(cycle)
    members = np.asarray(cycle.tyre.mesh.subdomains["carcass"])
    whole = matrix.angles.gradient(cycle.footprint.amplitudes)[members]
    expected = whole.transpose(0, 2, 3, 1).reshape(*matrix._gradient(members).shape)
    np.testing.assert_allclose(matrix._gradient(members), expected, atol=1e-14)
    stretch, volume = matrix._stretch(members)
    f = expected + np.eye(3)
    np.testing.assert_allclose(stretch @ stretch, f.swapaxes(-1, -2) @ f, atol=1e-12)
    np.testing.assert_allclose(volume, np.linalg.det(f), rtol=1e-12)
    # The large motion has smaller strains in the carcass than the linear one, whose rotations strain it.
    energies = matrix.energies("carcass", members)
    assert np.abs(energies.strain).max() < 0.5


ROLLING = {
    "mesh__section": "full", "boundaries__sliding": "rolling", "drive__load": "4 kN",
    "materials__tread": {"base": "nasa-tread", "friction": {"coefficient": 1.0, "source": "estimate: example"}},
}  # fmt: skip


def test_a_cornering_tyre_lasts_shorter_and_as_long_in_the_other_turn() -> None:
    free, left, right = (
        life(tyre(**ROLLING, drive__slip_angle=angle), temperature=60.0) for angle in ("0 deg", "3 deg", "-3 deg")
    )
    assert left.shortest < 0.9 * free.shortest
    assert right.shortest == pytest.approx(left.shortest, rel=1e-3)
    places = left.rings.points.mean(axis=-1)
    mirrored = np.array([np.hypot(places[0] - r, places[1] + z).argmin() for r, z in places.T])
    # The planes tried are not mirror images of each other.
    inside = np.isfinite(left.element_km) & (left.element_km < 1e6)
    np.testing.assert_allclose(right.element_km[mirrored][inside], left.element_km[inside], rtol=0.05)
    sides = left.element_km[inside] / left.element_km[mirrored][inside]
    assert sides.max() > 1.5
    # The slip moves the life, too.
    assert shifts_of(left.study) == ("speed", "load", "pressure", "ambient", "slip")
    (shift,) = shifts(left, ("slip",))
    assert shift.ratio < 0.99


def test_a_cornering_tyre_in_large_motion_closes_its_path() -> None:
    study = tyre(**{**ROLLING, "drive__load": "1 kN"}, mechanics__motion="large", drive__slip_angle="2 deg")
    rolling: Any = cycle_schedule(study).cycles[0][0]
    members = np.asarray(rolling.tyre.mesh.subdomains["carcass"])
    path = MatrixCycle(rolling).energies("carcass", members)
    np.testing.assert_allclose(path.strain[:, STEPS], path.strain[:, -1], atol=1e-9)
    pressed = MatrixCycle(replace(rolling, footprint=rolling.footprint.tyre.footprint)).energies("carcass", members)
    swings = [np.ptp(each.strain[:, STEPS:], axis=1).max() for each in (path, pressed)]
    assert 0.8 * swings[1] < swings[0] < 3 * swings[1]


def test_the_path_of_a_rolling_tyre_closes_and_free_rolling_is_nearly_the_upright_tyre() -> None:
    rolling: Any = cycle_schedule(tyre(**ROLLING)).cycles[0][0]
    upright: Any = cycle_schedule(tyre(**{**ROLLING, "boundaries__sliding": "constant"})).cycles[0][0]
    members = np.asarray(rolling.tyre.mesh.subdomains["carcass"])
    paths = [MatrixCycle(cycle).energies("carcass", members) for cycle in (rolling, upright)]
    np.testing.assert_allclose(paths[0].strain[:, STEPS], paths[0].strain[:, -1], atol=1e-9)
    swings = [np.ptp(path.strain[:, STEPS:], axis=1)[:, :4] for path in paths]
    assert swings[0] == pytest.approx(swings[1], abs=0.1 * swings[1].max())
