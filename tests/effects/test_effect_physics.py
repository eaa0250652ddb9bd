"""What single effects do, against exact or independent values."""

from __future__ import annotations

import math

import numpy as np
import pytest
from suitable import COARSE

import tyrefem as tf
from tyrefem.effects import Effect, catalogue
from tyrefem.geometry import load
from tyrefem.simulation.rolling_tyre import RollingTyre
from tyrefem.simulation.sensors import lagged, recorded, true_places
from tyrefem.simulation.surroundings import GAS

pytestmark = pytest.mark.fast


def tyre(effects: list[dict] | None = None, name: str = "example-validation", **changes: object) -> RollingTyre:
    """A coarse study with effects, ready to be asked for films and sources. ``drive__load`` is ``drive.load``."""
    dotted = {key.replace("__", "."): value for key, value in changes.items()}
    return RollingTyre(tf.study(name).replace({**COARSE, **dotted, "effects": effects or []}))


def only(rolling: RollingTyre) -> Effect:
    """The study's one effect."""
    (effect,) = rolling.study.effects
    return effect


def heat(rolling: RollingTyre, t: float = 10.0) -> dict[str, np.ndarray]:
    """Heat source of every zone at its nodes with the tyre at 25 degC, W/m3."""
    nodes = {zone: rolling.problem.points(zone) for zone in rolling.sources}
    return {zone: rolling.sources[zone](x, t, np.full(x.shape[1], 25.0)) for zone, x in nodes.items()}


def power(rolling: RollingTyre, t: float = 10.0) -> float:
    """Heat of all zones of the half tyre at 25 degC, W."""
    operators = rolling.problem.operators
    return sum(float((operators.source(zone) @ q).sum()) for zone, q in heat(rolling, t).items())


# -- boundaries --------------------------------------------------------------------------------------------------------


def test_contact_resistance_is_in_series() -> None:
    bare, thin = tyre(), tyre([{"name": "bead-contact-resistance", "resistance": "1e-3 m**2*K/W"}])
    assert 1 / thin.rim_film(0.0) == pytest.approx(1 / bare.rim_film(0.0) + 1e-3, rel=1e-12)
    stated = tyre(boundaries__rim={"law": "fixed", "contact_resistance": "1e-3 m**2*K/W"})
    assert thin.rim_film(0.0) == pytest.approx(stated.rim_film(0.0), rel=1e-12)


def test_the_whole_gas_mass_is_the_law_gas() -> None:
    amended = tyre([{"name": "gas-mass", "fraction": 1.0}], boundaries__contained_air={"law": "report"})
    real = tyre(boundaries__contained_air={"law": "gas"})
    capacity = [rolling_tyre.problem.reservoirs[GAS].heat_capacity for rolling_tyre in (amended, real)]
    assert capacity[0] == pytest.approx(capacity[1], rel=1e-12)


def test_road_film_with_the_exponent_of_cattani() -> None:
    speeds = ("10 m/s", "22 m/s")
    ours = [tyre([{"name": "road-film-speed", "exponent": 0.5}], drive__phases__rolling__speed=v) for v in speeds]
    theirs = [tyre(boundaries__road={"law": "cattani"}, drive__phases__rolling__speed=v) for v in speeds]
    ratio = [pair[1].road_film(1.0) / pair[0].road_film(1.0) for pair in (ours, theirs)]
    assert ratio[0] == pytest.approx(ratio[1], rel=1e-12)
    assert ours[0].road_film(1.0) == tyre().road_film(1.0)


def test_outside_film_keeps_still_air_and_changes_the_rest() -> None:
    other = tyre([{"name": "outside-film-speed", "exponent": -0.2}], drive__phases__rolling__speed="20 m/s")
    plain = tyre(drive__phases__rolling__speed="20 m/s")
    assert other.air_film(other.drive.end) == plain.air_film(plain.drive.end)
    forced = plain.air_film(1.0) - 5.44
    assert other.air_film(1.0) == pytest.approx(5.44 + forced * 2**-0.2, rel=1e-12)


def test_wet_road_raises_road_and_tread_but_not_the_sidewall() -> None:
    wet, dry = tyre([{"name": "wet-road", "film_gain": 1.1}]), tyre()
    assert wet.road_film(1.0) == pytest.approx(2.1 * dry.road_film(1.0))
    assert wet.tread_air_film(1.0) == pytest.approx((1 + 2.8 * 1.1) * dry.air_film(1.0))
    assert wet.air_film(1.0) == dry.air_film(1.0)
    assert wet.tread_air_film(wet.drive.end) == dry.air_film(dry.drive.end)


def test_gas_is_not_mixed_at_rest() -> None:
    mixed, still = tyre([{"name": "gas-mixing", "gain": 2.0}], drive__phases__rolling__speed="10 m/s"), tyre()
    assert mixed.gas_film(1.0) == pytest.approx(3 * still.gas_film(1.0))
    assert mixed.gas_film(mixed.drive.end) == still.gas_film(1.0)


def test_drift_carries_the_road_along_unless_it_has_a_temperature() -> None:
    drift = [{"name": "ambient-drift", "rate": "36 K/h"}]
    free, fixed = tyre(drift), tyre(drift, boundaries__road={"law": "constant", "temperature": "30 degC"})
    assert free.ambient(200.0) == pytest.approx(27.0)
    assert (free.road_temperature(200.0), fixed.road_temperature(200.0)) == (pytest.approx(27.0), 30.0)


def test_brake_warms_a_fixed_rim_with_its_lag() -> None:
    braked = tyre([{"name": "brake-heat", "warmer_by": "30 delta_degC", "lag": "100 s"}])
    assert braked.rim_temperature(0.0) == 25.0
    assert braked.rim_temperature(100.0) == pytest.approx(25 + 30 * (1 - 1 / math.e))


def test_a_brake_that_begins_late_warms_the_rim_from_then_on() -> None:
    late = {"name": "brake-heat", "warmer_by": "30 delta_degC", "lag": "100 s", "begins": "60 s"}
    braked = tyre([late])
    assert [braked.rim_temperature(t) for t in (0.0, 60.0)] == [25.0, 25.0]
    assert braked.rim_temperature(160.0) == pytest.approx(25 + 30 * (1 - 1 / math.e))


def test_brake_power_ends_in_the_rim() -> None:
    rim = {"law": "lumped", "mass": "9 kg", "cooling": "0 W/K", "film": "0 W/m**2/K"}
    changes = {"boundaries.rim": rim, "effects": [{"name": "brake-power", "power": "200 W"}]}
    readings = tf.study("example-validation").replace({**COARSE, **changes}).run().readings
    # 200 s of rolling, nothing in the 40 s at rest, nothing lost: P t / (m c)
    assert readings["rim"].iloc[-1] - 25 == pytest.approx(200 * 200 / (9 * 962.32), rel=1e-6)


def test_the_sun_s_power_is_the_flux_times_the_outer_surface() -> None:
    changes = {"effects": [{"name": "sun", "absorbed": "100 W/m**2"}], "drive.phases.rolling.speed": "0 m/s"}
    result = tf.study("example-validation").replace({**COARSE, **changes}).run()
    line = [result.study.section.boundary_line(side, 1e-4) for side in ("road", "outside_air")]
    area = 2 * sum(
        float(np.sum(2 * np.pi * (p[1:, 0] + p[:-1, 0]) / 2 * np.linalg.norm(np.diff(p, axis=0), axis=1)))
        for lines in line
        for p in lines
    )
    lost = sum(result.heat_budget.powers["lost", f"sun on the {side}"][0] for side in ("road", "outside air"))
    assert -lost == pytest.approx(100 * area, rel=0.01)


# -- heat --------------------------------------------------------------------------------------------------------------


def test_no_under_inflation_at_the_rated_load_and_pressure() -> None:
    flexing = [{"name": "under-inflation-flexing", "gain": 1.0}]
    rated = {"drive__load": "4350 lbf", "drive__pressure": "156.1 psi"}
    assert power(tyre(flexing, **rated)) == power(tyre(**rated))
    gains = []
    for pressure in ("125 psi", "94 psi"):
        low = {"drive__load": "4350 lbf", "drive__pressure": pressure}
        gains.append(power(tyre(flexing, **low)) / power(tyre(**low)))
    assert 1.02 < gains[0] < gains[1]


def test_under_inflation_leaves_crown_and_bead_alone() -> None:
    heavy = {"drive__load": "4000 lbf"}
    more, plain = heat(tyre([{"name": "under-inflation-flexing", "gain": 1.0}], **heavy)), heat(tyre(**heavy))
    rolling = tyre(**heavy)
    excess = rolling.schedule.cases[0][0].deflection / rolling.rated_deflection - 1
    assert np.allclose(more["V"], plain["V"], rtol=1e-12)
    crown = rolling.places(rolling.problem.points("II"))[0] < 0.2 * rolling.study.section.line.shoulder_s
    assert np.allclose(more["II"][crown], plain["II"][crown], rtol=2e-3 * (1 + excess))
    assert (more["III"] / plain["III"]).max() == pytest.approx(1 + excess, rel=0.02)


def test_belt_edge_shear_sits_between_tread_and_carcass_at_the_shoulder() -> None:
    rolling = tyre([{"name": "belt-edge-shear", "loss": "2e4 J/m**3"}], mesh__size="2 mm")
    added, plain = heat(rolling), heat(tyre(mesh__size="2 mm"))
    extra = {zone: added[zone] - plain[zone] for zone in added}
    best = max(extra, key=lambda zone: extra[zone].max())
    s, depth = rolling.places(rolling.problem.points(best)[:, [int(extra[best].argmax())]])
    section = rolling.study.section
    assert abs(s[0] - 0.95 * section.line.shoulder_s) < 2e-3
    assert abs(depth[0] - section.thickness("carcass", s)[0]) < 1e-3
    ratio = rolling.schedule.cases[0][0].deflection / rolling.rated_deflection
    rate = rolling.speed(1.0) / (2 * np.pi * rolling.schedule.cases[0][0].rolling_radius)
    assert extra[best].max() == pytest.approx(2e4 * rate * ratio**2, rel=0.05)


def test_belt_edge_shear_of_a_worn_tread_is_not_that_of_a_new_one() -> None:
    """Extents are kept by section and points: another section must not get them."""
    shear = {"name": "belt-edge-shear", "loss": "2e4 J/m**3"}
    new, worn = tyre([shear]), tyre([shear, {"name": "worn-tread", "fraction": 0.5}])
    zone = next(zone for zone in new.sources if new.region(zone) == "tread")
    x = worn.problem.operators.nodes(zone)
    T = np.full(x.shape[1], 40.0)
    effects = [
        next(effect for effect in each.acting.effects if effect.name == "belt-edge-shear") for each in (new, worn)
    ]
    heats = [effect.heat_addend(each, zone, x, 1.0, T) for effect, each in zip(effects, (new, worn), strict=True)]
    assert np.array_equal(heats[0], effects[0].heat_addend(new, zone, x, 1.0, T))
    section = worn.study.section
    s, depth = worn.places(x)
    across = (section.midline_offset(s, depth) - section.thickness("carcass", s) / 2) / 2.5e-3
    along = (s - 0.95 * section.line.shoulder_s) / 8e-3
    shape = np.exp(-(along**2 + across**2) / 2)
    assert heats[1] == pytest.approx(heats[1].max() / shape.max() * shape, rel=1e-9)


def test_loss_exponent_and_rate() -> None:
    x, T = np.zeros((2, 3)), np.array([25.0, 65.0, 105.0])
    fast = tyre([{"name": "loss-speed-exponent", "exponent": 0.2}], drive__phases__rolling__speed="20 m/s")
    assert only(fast).heat_factor(fast, "I", x, 1.0, T) == pytest.approx(2**0.2)
    steep = tyre([{"name": "loss-temperature-law", "rate": "0.005 1/delta_degC"}])
    card = tyre(materials__tread__loss_tangent__rate="0.0198 1/delta_degC")
    ours = steep.study.materials["tread"].loss_tangent(T) * only(steep).heat_factor(steep, "II", x, 1.0, T)
    assert ours == pytest.approx(card.study.materials["tread"].loss_tangent(T), rel=1e-12)


def test_standing_wave_sets_in_at_its_speed() -> None:
    def factor(speed: str) -> float:
        wave = tyre([{"name": "standing-wave", "gain": 4.0}], drive__phases__rolling__speed=speed)
        return float(only(wave).heat_factor(wave, "I", np.zeros((2, 1)), 1.0, np.zeros(1)))

    assert factor("25 m/s") < 1.003
    assert factor("75 m/s") == pytest.approx(1 + 4 * 0.5, rel=0.01)
    assert 1 < factor("25 m/s") < factor("49 m/s") < factor("51 m/s") < factor("75 m/s")


@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_strain_energy_goes_with_the_square_of_the_deflection_that_pressure_changes(factor: float) -> None:
    # What the effects of pressure assume of carcass and sidewall, against the strain law at the other pressure.
    zones = ("I", "III", "IV")
    now, then = heat(tyre()), heat(tyre(drive__pressure=f"{83 * factor} psi"))
    seen = sum(then[zone].sum() for zone in zones) / sum(now[zone].sum() for zone in zones)
    name, values = ("pressure-rise", {"rise": 0.1, "lag": "30 s"}) if factor > 1 else ("pressure-loss", {})
    values = values or {"rate": f"{83 * 6894.757 * 0.1 / 200} Pa/s"}
    rolling = tyre([{"name": name, **values}])
    ours = only(rolling).heat_factor(rolling, "I", np.zeros((2, 1)), 199.999, np.zeros(1))
    assert math.log(ours) == pytest.approx(math.log(seen), rel=0.35)


def test_slip_heats_as_roberts_and_yaw_as_slip_on_the_mean() -> None:
    slipping = tyre([{"name": "tread-slip", "slip": 0.02}], mesh__section="full")
    case, speed = slipping.schedule.cases[0][0], slipping.speed(1.0)
    tread, road = math.sqrt(0.2092 * 2.092e6), math.sqrt(1.5 * 2e6)
    expected = 0.8 * case.pressure * 0.02 * speed * case.road_fraction * tread / (tread + road)
    assert only(slipping).flux(slipping, "road", np.zeros((2, 1)), 1.0) == pytest.approx(expected, rel=1e-6)
    yawed = tyre([{"name": "yaw", "side": "left", "slip": 0.02}], mesh__section="full")
    left, right = only(yawed).flux(yawed, "road", np.array([[0.28, 0.28], [-0.03, 0.03]]), 1.0)
    assert left > right > 0
    assert (left + right) / 2 == pytest.approx(expected, rel=1e-6)


def test_camber_moves_heat_from_one_side_to_the_other() -> None:
    def sides(degrees: float) -> tuple[float, float]:
        leaning = tyre([{"name": "camber", "angle": f"{degrees} deg"}], mesh__section="full")
        nodes, q = leaning.problem.points("III"), heat(leaning)["III"]
        return float(q[nodes[1] < 0].sum()), float(q[nodes[1] > 0].sum())

    left, right = sides(2.0)
    assert right > 1.1 * left
    assert sides(-2.0) == pytest.approx((right, left), rel=1e-9)
    straight = sides(1e-9)
    # To first order nothing is added: only the square of z tan(angle) / D remains.
    assert 1 < (left + right) / sum(straight) < 1.02


# -- section and measurement -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["nasa-22x5.5-8pr", "nasa-22x5.5-12pr"])
def test_wear_takes_from_the_outside_and_moves_nothing(name: str) -> None:
    new = load(name)
    old = new.worn("tread", 0.4)
    s = np.linspace(0.0, new.line.length, 50)
    assert np.array_equal(old.interfaces(s)[:2], new.interfaces(s)[:2])
    crown = s < 0.5 * new.line.shoulder_s
    assert old.thickness("rubber", s)[crown] == pytest.approx(0.6 * new.thickness("rubber", s)[crown])
    assert np.array_equal(old.thickness("rubber", s)[-10:], new.thickness("rubber", s)[-10:])
    assert old.volume("carcass") == pytest.approx(new.volume("carcass"), rel=1e-12)
    assert old.gas_volume() == pytest.approx(new.gas_volume(), rel=1e-12)
    twice = old.worn("tread", 0.5)
    assert twice.thickness("tread", 0.0) == pytest.approx(0.3 * new.thickness("tread", 0.0))
    assert np.array_equal(twice.interfaces(s)[:2], new.interfaces(s)[:2])


def test_wear_keeps_the_mesh_s_layout() -> None:
    meshes = [tyre([{"name": "worn-tread", "fraction": x}] if x else []).mesh.mesh for x in (0.0, 0.05, 0.6)]
    assert all(np.array_equal(mesh.t, meshes[0].t) for mesh in meshes)


def test_a_thermocouple_in_worn_away_rubber_sits_on_the_surface() -> None:
    worn = tyre([{"name": "worn-tread", "fraction": 0.3}]).study
    new = worn.replace({"effects": []})
    places = true_places(worn)
    s, depth = worn.section.locate(np.array([places["surface"]]))
    assert depth[0] == pytest.approx(worn.section.total_thickness(s)[0], rel=1e-9)
    moved = {name for name, place in true_places(new).items() if place != places[name]}
    assert moved == {"surface", "shoulder-edge"}


def test_what_the_logger_makes_of_it() -> None:
    times = np.linspace(0.0, 100.0, 21)
    study = tyre().study
    names = list(study.sensors)
    truth = np.outer(times, 1 + np.arange(len(names))) + 20.0

    def read(*effects: dict) -> dict[str, np.ndarray]:
        return recorded(study.replace({"effects": list(effects)}), times, truth)

    plain, first, second = read(), names[0], names[1]
    swapped = read({"name": "swapped-channels", "sensor": first, "other": second})
    assert np.array_equal(swapped[first], plain[second])
    assert np.array_equal(swapped[second], plain[first])
    assert np.array_equal(swapped[names[2]], plain[names[2]])
    high = read({"name": "sensor-offset", "sensor": second, "too_high": "-3 delta_degC"})
    assert high[second] == pytest.approx(plain[second] - 3.0)
    slow = read({"name": "sensor-lag", "sensor": first, "slower_by": "6 s"})
    assert slow[first] == pytest.approx(lagged(times, truth[:, 0], study.sensors[first].lag + 6.0))
    late = read({"name": "clock-offset", "late": "10 s"})
    assert late[second][5] == pytest.approx(plain[second][7])
    both = read(
        {"name": "swapped-channels", "sensor": first, "other": second},
        {"name": "sensor-offset", "sensor": first, "too_high": "2 delta_degC"},
    )
    # The offset is the channel's, whatever is plugged in.
    assert both[first] == pytest.approx(plain[second] + 2.0)


def test_a_displaced_thermocouple_stays_in_the_rubber_and_moves_alone() -> None:
    far = [{"name": "sensor-misplaced", "sensor": "crown-inner", "along": "3 mm", "deeper": "-10 mm"}]
    moved, stated = true_places(tyre(far).study), true_places(tyre().study)
    section = tyre().study.section
    s, depth = section.locate(np.array([moved["crown-inner"]]))
    s0, _ = section.locate(np.array([stated["crown-inner"]]))
    assert s[0] - s0[0] == pytest.approx(3e-3, abs=1e-9)
    assert depth[0] == pytest.approx(0.0, abs=1e-9)
    assert {name for name in stated if moved[name] != stated[name]} == {"crown-inner"}


def test_a_constant_conductivity_stays_constant() -> None:
    # A number, not a function of temperature, so that it is assembled once.
    rolling = tyre([{"name": "cord-conduction", "gain": 1.0}])
    along, across = rolling.problem.regions["carcass"].conductivity
    assert along == pytest.approx(2 * across)
    assert set(catalogue()["cord-conduction"].ports()) == {"conductivity_factor"}


# -- time --------------------------------------------------------------------------------------------------------------

OF_DRIVE = sorted(name for name, effect in catalogue().items() if effect.of_drive)


def surroundings(rolling: RollingTyre, t: float) -> list[float]:
    """Everything that surrounds the tyre at a time."""
    films = [rolling.road_film(t), rolling.air_film(t), rolling.tread_air_film(t), rolling.gas_film(t)]
    sinks = [rolling.ambient(t), rolling.road_temperature(t), rolling.rim_temperature(t)]
    return [*films, rolling.rim_film(t), *sinks, rolling.acting.rim_power(t)]


@pytest.mark.parametrize("name", OF_DRIVE)
def test_what_follows_the_drive_is_constant_where_the_drive_is(name: str) -> None:
    choice = {"film": "road"} if name == "film-scale" else {}
    amplitude = catalogue()[name].parameters()[0]
    value = amplitude.prior.text(amplitude.prior.null + amplitude.prior.scale)
    lumped = {"boundaries__rim": {"law": "lumped", "mass": "9 kg", "cooling": "2 W/K"}} if name == "brake-power" else {}
    rolling, plain = tyre([{"name": name, **choice, amplitude.name: value}], **lumped), tyre(**lumped)
    assert rolling.acting.follows_drive
    times = np.random.default_rng(3).uniform(0.0, 200.0, 40)
    assert all(surroundings(rolling, float(t)) == surroundings(rolling, 0.0) for t in times)
    assert surroundings(rolling, 0.0) != surroundings(plain, 0.0)


def test_what_changes_by_itself_does_not_claim_to_follow_the_drive() -> None:
    assert len(OF_DRIVE) == 9
    drifting = tyre([{"name": "ambient-drift", "rate": "10 delta_degC/hour"}])
    assert not drifting.acting.follows_drive
    assert surroundings(drifting, 100.0) != surroundings(drifting, 0.0)
    # What acts on the heat alone leaves the surroundings as they are.
    assert tyre([{"name": "pressure-rise", "rise": 0.1}]).acting.follows_drive


def test_wind_has_no_part_in_another_power_of_speed() -> None:
    """h = 5.44 + forced (v / v_ref)^n + wind: what the wind adds does not follow the tyre's own speed."""
    law, wind = {"name": "outside-film-speed", "exponent": 0.5}, {"name": "wind", "air_speed": "6 m/s"}
    still, power, both = (tyre(effects, drive__phases__rolling__speed="30 m/s") for effects in ([], [law], [law, wind]))
    assert power.air_film(10.0) == pytest.approx(5.44 + (still.air_film(10.0) - 5.44) * 3**0.5, rel=1e-3)
    assert both.air_film(10.0) == pytest.approx(power.air_film(10.0) + 1.674 * 6.0)


def test_a_late_clock_shifts_every_channel_of_the_logger() -> None:
    late = [{"name": "clock-offset", "late": "20 s"}]
    rim = {"law": "lumped", "mass": "4 kg", "cooling": "2 W/K", "air": "0.5 W/K"}
    changes = {"boundaries__rim": rim, "boundaries__contained_air": {"law": "gas"}}
    plain, shifted = (tyre(effects, **changes).study.run() for effects in ([], late))
    times = plain.times
    for name in ("contained-air", "rim", "crown-inner"):
        before, after = plain.readings[name].to_numpy(), shifted.readings[name].to_numpy()
        assert after == pytest.approx(np.interp(times + 20.0, times, before), abs=1e-9), name
        assert np.abs(after - before).max() > 0.01, name
    # What the tyre's air really has is not changed by a clock.
    assert shifted.gas_temperature == pytest.approx(plain.gas_temperature)
