"""A drive whose tyre rolls, leans and corners with friction: heat of the rings, symmetry, budget, refusals."""

from __future__ import annotations

import functools
import math
import pickle

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics
from tyrefem.mechanics.nearby_cycles import NearbyCycles, SolvedCycles
from tyrefem.mechanics.rolling.roll import RolledStudy
from tyrefem.mechanics.rolling.rolled_footprint import RolledFootprint
from tyrefem.mechanics.rolling.rolling_motion import RollingMotion
from tyrefem.mechanics.rolling.steady_rolling import RollingLoads, SteadyRolling
from tyrefem.mechanics.rolling.turning import cycle_of
from tyrefem.mechanics.rolling.wheel_on_road import WheelOnRoad
from tyrefem.reports.figures.heat_source import heat_source_figure, unevenness, zone_heat
from tyrefem.reports.run_tables import slip_columns

BASE = {
    "mesh.size": "16 mm", "mechanics.strain": "fem", "mechanics.motion": "linear", "drive.load": "6 kN",
    "drive.duration": "120 s", "output.fields": 2, "output.every": "60 s", "materials.tread": "rubber-tread-passenger",
    "boundaries.sliding": "rolling",
}  # fmt: skip
FULL = {**BASE, "mesh.section": "full"}


def study(base=FULL, **changes):
    return tf.study("nasa-22x5.5-8pr", {**base, **{f"drive.{name}": value for name, value in changes.items()}})


@functools.cache
def run(**changes):
    return study(**changes).run()


def test_heat_of_the_rings_is_the_friction_power_of_roll():
    result = run(slip_angle="3 deg")
    rolled = result.study.roll(slip_angle=math.radians(3))
    sliding = result.tyre.sliding
    surface = sliding.surface
    power = sliding.friction_power(sliding.uncapped_flux(surface.x, 60.0), 60.0)
    assert power == pytest.approx(rolled.state.friction_power, rel=1e-9)
    friction = result.tyre.schedule.cycles[0][0].friction
    speed = result.tyre.motion(60.0).speed
    assert friction.work.sum() * speed == pytest.approx(rolled.state.friction_power, rel=1e-9)
    assert friction.friction == pytest.approx(abs(rolled.state.force[1]) / rolled.state.force[2], rel=1e-3)
    # The wheel turns as the rolling tyre does.
    assert 2 * math.pi * result.tyre.motion(60.0).revolutions_per_second == pytest.approx(rolled.state.spin, rel=1e-9)


def test_the_footprint_in_the_summary_is_that_of_the_rolling_tyre():
    """Length, width and area of one contact, with its harmonics and error."""
    result = run(camber="4 deg")
    rolled = result.study.roll(camber=math.radians(4))
    written = result.summary()["footprint"]
    wanted = rolled.summary()
    for name in ("length_m", "width_m", "area_m2"):
        assert written[name] == pytest.approx(wanted[f"footprint_{name}"], rel=1e-9)
    upright = result.tyre.schedule.cycles[0][0].footprint.tyre.footprint
    assert written["width_m"] != pytest.approx(upright.width, rel=1e-3)
    assert (written["harmonics"], written["error"]) == (wanted["harmonics"], pytest.approx(wanted["error"], rel=1e-6))


# In large motion without inertia and loss: below, with the friction of that drive.
@pytest.mark.parametrize(("motion", "rolling"), [("linear", False), ("linear", True), ("large", True)])
def test_hysteresis_is_that_of_roll(motion, rolling):
    """The heat source of the conduction at the initial temperature is the loss of the strain cycle that `roll` has."""
    of_motion = {"drive.load": "2 kN"} if motion == "large" else {}
    base = {**FULL, **of_motion, "mechanics.motion": motion, "mechanics.rolling": rolling, "drive.duration": "20 s"}
    tyre = study(base, slip_angle="3 deg")
    rolled = tyre.roll(slip_angle=math.radians(3), motion=motion)
    assert tyre.run().cold_power(10.0) == pytest.approx(rolled.hysteresis, rel=1e-9)
    if rolling and motion == "linear":
        # The contact takes the loss modulus at the strains without slip; without strain dependence both agree to 1e-6.
        assert rolled.state.loss_power == pytest.approx(rolled.hysteresis, rel=0.1)


def test_friction_heat_divides_by_effusivity_and_the_budget_closes():
    result = run(slip_angle="3 deg")
    phase, budget = result.sliding.phases[0], result.heat_budget
    share = result.tyre.sliding.passage(60.0).tread_share
    assert phase.tread_heat == pytest.approx(share * phase.friction_work, rel=1e-6)
    assert budget.total("sliding") == pytest.approx(phase.tread_heat, rel=1e-9)
    made, kept = budget.total("generated") + budget.total("sliding"), budget.total("stored") + budget.total("lost")
    assert made == pytest.approx(kept, rel=1e-9)
    assert budget.imbalance < 1e-9


def test_free_rolling_is_nearly_as_warm_as_without_friction():
    """A tread that sticks moves less along the road: it loses 7 % less."""
    free = run()
    without = tf.study("nasa-22x5.5-8pr", {**FULL, "boundaries.sliding": "constant"}).run()
    rise = without.highest[-1] - 25.0
    assert free.highest[-1] - 25.0 == pytest.approx(rise, rel=0.05)
    assert free.generated(-1)[0] == pytest.approx(without.generated(-1)[0], rel=0.1)
    assert free.heat_budget.total("sliding") < 0.02 * free.generated(-1)[0]


def test_without_friction_the_strains_are_those_of_the_footprint():
    cycle = run().tyre.schedule.cycles[0][0]
    wheel = _wheel(cycle)
    wheel._free[54] = wheel.rolling.roll(
        RollingMotion(), RollingLoads(load=6e3, travel=wheel.pressed.footprint.rolling_radius), 54,
        guess=(wheel.pressed.footprint.deflection, wheel.pressed.footprint.rolling_radius),
    )  # fmt: skip
    rolled = RolledFootprint.of_rolled(RolledStudy(wheel, wheel._free[54], 0.0), 1.0)
    upright = wheel.pressed.pressing.at_load(6e3, 54)
    assert cycle_of(rolled).storage_products == pytest.approx(
        StrainHarmonics(upright).storage_products, rel=1e-6, abs=1e-6 * rolled.pressing.state.storage.max() * 1e-6
    )
    assert rolled.area == pytest.approx(upright.area, rel=0.02)
    assert rolled.friction.total == pytest.approx(0.0, abs=1e-9)


def _wheel(cycle):
    pressed = cycle.footprint.tyre
    return WheelOnRoad(pressed, SteadyRolling(pressed.pressing, friction=0.0), 6e3, None, 1.0)


def test_the_other_slip_angle_is_the_mirror_image():
    left, right = run(slip_angle="3 deg"), run(slip_angle="-3 deg")
    places = np.array([[0.27, 0.03], [0.27, -0.03], [0.25, 0.06], [0.25, -0.06]])
    places = left._inside(places)
    mirrored = places * np.array([1.0, -1.0])
    assert left.at(places)[-1] == pytest.approx(right.at(mirrored)[-1], abs=1e-6)
    # Cornering heats the two sides differently, and more than rolling straight ahead.
    assert abs(left.at(places)[-1][0] - left.at(places)[-1][1]) > 0.3
    assert left.generated(-1)[0] > 1.1 * run().generated(-1)[0]


def test_camber_heats_the_side_that_comes_down():
    leaning = run(camber="4 deg")
    surface = leaning.tyre.sliding.surface
    flux = leaning.tyre.sliding.uncapped_flux(surface.x, 60.0)
    z = surface.x[1]
    assert surface.weight[z > 0] @ flux[z > 0] > 1.5 * surface.weight[z < 0] @ flux[z < 0]
    rubber = leaning.at(leaning._inside(np.array([[0.25, 0.06], [0.25, -0.06]])))[-1]
    assert rubber[0] > rubber[1] + 0.2


def test_half_section_brakes_as_the_full_one_and_torque_agrees_with_slip():
    full, half = run(slip_ratio=0.02), study(BASE, slip_ratio=0.02).run()
    assert half.heat_budget.total("sliding") == pytest.approx(full.heat_budget.total("sliding"), rel=1e-3)
    assert half.heat_budget.total("generated") == pytest.approx(full.heat_budget.total("generated"), rel=1e-3)
    braked = half.study.roll(slip=-0.02)
    by_torque = study(BASE, torque=f"{braked.state.torque:.9g} N m").run()
    assert by_torque.heat_budget.total("sliding") == pytest.approx(half.heat_budget.total("sliding"), rel=3e-3)
    assert by_torque.tyre.motion(60.0).revolutions_per_second == pytest.approx(
        half.tyre.motion(60.0).revolutions_per_second, rel=1e-4
    )


def test_a_ramp_of_slip_is_between_its_ends():
    ramp = (
        run(slip_angle=(("from", "0 deg"), ("to", "3 deg")))
        if False
        else study(slip_angle={"from": "0 deg", "to": "3 deg"}).run()
    )
    assert len(ramp.tyre.schedule.cycles[0]) == 9
    powers = ramp.sliding.series.friction_power_W.to_numpy()
    assert (np.diff(powers) > 0).all()
    assert powers[-1] == pytest.approx(run(slip_angle="3 deg").sliding.series.friction_power_W.iloc[-1], rel=1e-6)


def test_hysteresis_of_a_turning_tyre_is_the_loss_of_roll():
    """With inertia and loss; the rest is interpolation to the nodes of the conduction."""
    friction = {"coefficient": 1.0, "source": "estimate: example"}
    turning = {**FULL, "mechanics.rolling": True, "mechanics.loss_convention": "sinusoid"}
    turning["materials.tread"] = {"base": "nasa-tread", "friction": friction}
    result = study(turning, slip_angle="3 deg").run()
    rolled = result.study.roll(slip_angle=math.radians(3))
    assert result.cold_power(1.0) == pytest.approx(rolled.state.loss_power, rel=0.02)


LARGE = {**FULL, "mesh.size": "16 mm", "drive.load": "2 kN", "mechanics.motion": "large"}


def test_on_the_footprint_in_large_motion_friction_is_that_of_roll_and_turns_are_mirrored():
    """Mirrored within what the search for motions of the loaded tyre leaves."""
    left, right = (study(LARGE, slip_angle=angle).run() for angle in ("3 deg", "-3 deg"))
    rolled = left.study.roll(slip_angle=math.radians(3), motion="large")
    friction = left.tyre.schedule.cycles[0][0].friction
    assert friction.work.sum() * left.tyre.motion(60.0).speed == pytest.approx(rolled.state.friction_power, rel=1e-6)
    assert left.cold_power(10.0) == pytest.approx(rolled.hysteresis, rel=1e-9)
    assert left.generated(-1)[0] == pytest.approx(right.generated(-1)[0], rel=5e-3)
    assert left.heat_budget.imbalance < 1e-9


def test_in_large_motion_little_friction_leaves_the_pressed_tyre():
    """With hardly any friction the strains are those of the footprint; sticking changes its loss by some percent."""
    slippery = {"base": "nasa-tread", "friction": {"coefficient": 0.02, "source": "estimate: example"}}
    sticking = {"base": "nasa-tread", "friction": {"coefficient": 1.0, "source": "estimate: example"}}
    base = {**LARGE, "mesh.section": "half"}
    without = study({**base, "materials.tread": sticking, "boundaries.sliding": "constant"}).run().generated(-1)[0]
    for tread in (slippery, sticking):
        result = study({**base, "materials.tread": tread}).run()
        assert result.generated(-1)[0] == pytest.approx(without, rel=0.08)


def test_friction_over_speed_follows_speed_and_temperature_of_the_drive():
    """Sliding speeds below the peak: faster means more grip, warmer means less."""
    law = {
        "law": "savkoor", "coefficient": 1.2, "standstill": 0.4, "peak_speed": "20 m/s", "width": 0.5,
        "at": "30 degC", "decade": "20 K", "source": "estimate: example",
    }  # fmt: skip
    slow = study({**BASE, "materials.tread": {"base": "nasa-tread", "friction": law}}, slip_ratio="10 %")
    fast, warm = slow.replace({"drive.speed": "40 mph"}), slow.replace({"drive.initial": "60 degC"})
    slow, fast, warm = (each.run().tyre.schedule.cycles[0][0].friction.friction for each in (slow, fast, warm))
    assert warm < 0.97 * slow
    assert slow < 0.98 * fast


def test_a_result_keeps_its_friction_when_it_is_pickled():
    result = run(slip_angle="3 deg")
    again = pickle.loads(pickle.dumps(result))
    assert again.sliding.phases == result.sliding.phases


def test_strain_cycles_nearby_have_their_friction(tmp_path):
    """A stiffer tread: interpolated from the solution one standard deviation away, and read again from its file."""
    tread = {"base": "nasa-tread", "friction": {"coefficient": 1.0, "source": "estimate: example"}}
    uncertain = {"uncertainty": {"materials.tread.shear_modulus.value": 0.1}}
    middle = study({**BASE, "materials.tread": tread, **uncertain}, slip_ratio="3 %")
    near = NearbyCycles(middle, SolvedCycles(tmp_path))
    (number,) = near.numbers
    raised = middle.replace(number.changes(1 + number.sd))
    works = [NearbyCycles(middle, SolvedCycles(tmp_path)).schedule_of(raised).cycles[0][0].friction.total for _ in "12"]
    assert works[0] == pytest.approx(works[1], rel=1e-12)
    assert works[0] == pytest.approx(raised.run().tyre.schedule.cycles[0][0].friction.total, rel=1e-9)
    assert works[0] != pytest.approx(near.schedule.cycles[0][0].friction.total, rel=1e-3)


def test_pictures_and_tables_of_a_cornering_run():
    """Where one side is hotter, the picture shows the heat of both; the phases have their slip angle."""
    cornering, straight = run(slip_angle="3 deg"), run()
    uneven, even = (unevenness(zone_heat(result, len(result.times) - 1)) for result in (cornering, straight))
    assert even < 0.01 < 0.03 < uneven
    assert slip_columns(cornering.study.card.drive) == {"slip angle [°]": ["3"]}
    assert slip_columns(straight.study.card.drive) == {}
    # One colour bar in place of two.
    assert len(heat_source_figure(cornering).axes) == len(heat_source_figure(straight).axes) - 1


def test_a_study_without_the_law_is_not_changed_by_it():
    without = tf.study("nasa-22x5.5-8pr", {**FULL, "boundaries.sliding": "constant"})
    assert without.card.boundaries.sliding.rolls is False
    assert without.run().sliding is None


UNIFORM, HALF = {"boundaries.sliding": "constant"}, {"mesh.section": "half"}
REFUSED = {
    "a torque without the law": ({**UNIFORM, "drive.torque": "10 N m"}, "drive.torque", "'rolling'"),
    "a camber without the law": ({**UNIFORM, "drive.camber": "1 deg"}, "drive.camber", "'rolling'"),
    "no friction on a card": ({"materials.tread": "nasa-tread"}, "friction", "[friction]"),
    "another strain law": ({"mechanics.strain": "arcs"}, "boundaries.sliding", "strain = 'fem'"),
    "slip angle on a half": ({**HALF, "drive.slip_angle": "1 deg"}, "drive.slip_angle", "section = 'full'"),
    "camber on a half": ({**HALF, "drive.camber": "1 deg"}, "drive.camber", "section = 'full'"),
    "slip and torque": ({"drive.phases": [{"slip_ratio": 0.1, "torque": "10 N m"}]}, "torque", "not both"),
    "a locked wheel": ({"drive.slip_ratio": 1}, "drive.slip_ratio", "does not roll"),
    "a ramp to a locked wheel": ({"drive.slip_ratio": {"from": 0, "to": 1}}, "drive.slip_ratio", "does not roll"),
    "slip beyond a locked wheel": ({"drive.slip_ratio": 1.2}, "drive.slip_ratio", "1"),
    "a camber that falls over": ({"drive.camber": "40 deg"}, "drive.camber", "-30 to 30 deg"),
    "a torque at rest": ({"drive.speed": "0 m/s", "drive.torque": "10 N m"}, "drive.torque", "stands"),
    "the wrong unit": ({"drive.camber": "2 N"}, "drive.camber", "deg"),
}  # fmt: skip


@pytest.mark.fast
@pytest.mark.parametrize("case", REFUSED)
def test_refused(case):
    changes, field, words = REFUSED[case]
    with pytest.raises(InputError) as caught:
        tf.study("nasa-22x5.5-8pr", {**FULL, **changes})
    assert field in str(caught.value.field)
    assert words in str(caught.value)


def test_a_torque_beyond_the_grip_names_the_phase():
    with pytest.raises(InputError, match=r"cannot carry 5000 N m: at most") as caught:
        study(BASE, torque="5 kN m").run()
    assert caught.value.field == "drive.torque"
