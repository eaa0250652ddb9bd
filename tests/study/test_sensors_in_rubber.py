"""Thermocouples: inside the rubber, at its surface, and with lag."""

from __future__ import annotations

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.errors import InputError
from tyrefem.simulation.sensors import lagged

pytestmark = pytest.mark.fast

QUICK = {"mesh.size": "4 mm", "mesh.element": "P1", "drive.duration": "60 s"}


@pytest.fixture(scope="module")
def study():
    return tf.study("nasa-22x5.5-8pr").replace(QUICK)


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ({"s": "1 in", "depth": "40 mm"}, "depth = 40.00 mm is outside the rubber"),
        ({"s": "9 in", "depth": "1 mm"}, "is off the section; allowed: 0.0 to 147.8 mm"),
        ({"s": "-1 in", "depth": "1 mm"}, "is off the section"),
        ({"at": ["0.2 m", "0 m"]}, "the sensor is outside the rubber"),
        ({"at": ["0.27 m", "-5 mm"]}, "the sensor is outside the rubber"),
        ({"s": "1 in"}, "give either 's' and 'depth', 's' and 'below_surface', 'at"),
        ({"s": "1 in", "depth": "1 mm", "below_surface": "1 mm"}, "give either 's' and 'depth'"),
        ({"at": ["0.27 m", "0 m"], "below_surface": "1 mm"}, "give either 's' and 'depth'"),
        (
            {"s": "1 in", "below_surface": "40 mm"},
            "below_surface = 40.00 mm is outside the rubber, which is 18.84 mm thick at s = 25.4 mm",
        ),
    ],
)
def test_a_sensor_outside_the_rubber_is_named(study, place, message):
    with pytest.raises(tf.InputError, match=message) as caught:
        study.replace({"sensors.crown-inner": place})
    assert "sensors.crown-inner" in str(caught.value)


def test_sensors_on_the_very_surface_read(study):
    thickness = float(study.section.total_thickness([0.03])[0])
    places = {
        "inner": {"s": "30 mm", "depth": "0 mm"},
        "outer": {"s": "30 mm", "depth": f"{thickness!r} m"},
        "crown": {"s": "0 mm", "depth": "0 mm"},
        "bead": {"s": f"{study.section.line.length!r} m", "depth": "0 mm"},
    }
    result = study.replace({f"sensors.{name}": place for name, place in places.items()}).run()
    assert result.readings[list(places)].iloc[-1].between(25, 60).all()
    assert np.isfinite(result.gradient_at_sensors.to_numpy()).all()


def test_a_sensor_below_the_outer_surface_is_that_far_from_it(study):
    """As far from the surface as it says, along the normal; the surface itself at nought."""
    below = study.replace({"sensors.b": {"s": "1 in", "below_surface": "2 mm"}}).stated_places["b"]
    surface = study.replace({"sensors.b": {"s": "1 in", "below_surface": "0 mm"}}).stated_places["b"]
    assert np.hypot(below[0] - surface[0], below[1] - surface[1]) == pytest.approx(2e-3, rel=1e-9)
    assert study.section.locate([surface])[1][0] == pytest.approx(study.section.rubber_thickness([0.0254])[0])
    thick = study.replace({"sensors.b": {"s": "1 in", "below_surface": "2 mm"}, "section.thickness_scale.tread": 1.1})
    moved = thick.stated_places["b"]
    assert thick.section.rubber_thickness([0.0254])[0] - thick.section.locate([moved])[1][0] == pytest.approx(2e-3)


def test_below_the_surface_of_a_groove_is_below_its_bottom():
    study = tf.study("passenger-205-55r16").replace({"sensors": {"g": {"s": "14.801 mm", "below_surface": "1 mm"}}})
    wall = float(study.section.rubber_thickness([14.801e-3])[0])
    assert wall < float(study.section.total_thickness([14.801e-3])[0]) - 5e-3
    assert study.section.locate([study.stated_places["g"]])[1][0] == pytest.approx(wall - 1e-3)


def test_one_way_of_placing_replaces_the_other(study):
    below = study.replace({"sensors.crown-inner.below_surface": "2 mm"})
    assert below.sensors["crown-inner"].depth is None
    assert below.replace({"sensors.crown-inner.depth": "3 mm"}).sensors["crown-inner"].below_surface is None
    assert below.replace({"sensors.crown-inner.at": ["0.27 m", "0 m"]}).sensors["crown-inner"].s is None


def test_a_misplaced_sensor_moves_from_below_the_surface_as_from_its_depth(study):
    """Its reading with the effect `sensor-misplaced` is the same, however the place was given."""
    depth = float(study.section.rubber_thickness([0.0254])[0]) - 2e-3
    moved = {"effects": [{"name": "sensor-misplaced", "sensor": "x", "deeper": "1 mm"}]}
    readings = [
        study.replace({"sensors": {"x": {"s": "1 in", **place}}, **moved}).run().readings["x"].to_numpy()
        for place in ({"below_surface": "2 mm"}, {"depth": f"{depth!r} m"})
    ]
    assert readings[0] == pytest.approx(readings[1], abs=1e-9)


def test_two_ways_of_placing_read_the_same(study):
    r, z = study.section_place(study.sensors["shoulder-inner"])
    result = study.replace({"sensors.same": {"at": [f"{float(r)!r} m", f"{float(z)!r} m"]}}).run()
    assert result.readings["same"].to_numpy() == pytest.approx(result.readings["shoulder-inner"].to_numpy(), abs=1e-6)


def test_a_sensor_lags_as_a_first_order_system():
    """Step of the temperature from 0 to 1 at t = 0: reading 1 - exp(-t/lag). Ramp: it trails by slope times lag."""
    t = np.linspace(0.0, 60.0, 61)
    assert lagged(t, 0.5 * t, 4.0)[-1] == pytest.approx(0.5 * (60.0 - 4.0), abs=1e-6)
    step = np.where(t > 0, 1.0, 0.0)
    fine = np.concatenate([[0.0, 1e-9], t[1:]])
    reading = lagged(fine, np.concatenate([[0.0, 1.0], step[1:]]), 4.0)
    assert reading[2:] == pytest.approx(1 - np.exp(-t[1:] / 4.0), abs=1e-8)
    assert lagged(t, 0.5 * t, 0.0) == pytest.approx(0.5 * t)


def test_lag_reaches_the_readings(study):
    slow = study.replace({"sensors.slow": {"s": "0.30 in", "depth": "0.12 in", "lag": "10 s"}}).run()
    behind = slow.readings["crown-inner"] - slow.readings["slow"]
    assert behind.iloc[0] == 0
    assert (behind.iloc[1:] > 0).all()


def test_a_place_in_another_world_is_out_of_range():
    """Its square is no number, of which numpy warned on the screen."""
    with pytest.raises(InputError, match=r"sensors\.far\.at\.0: '1e300 m' is out of range: must be at most 20 m"):
        tf.study("nasa-22x5.5-8pr", {"sensors.far": {"at": ["1e300 m", "0 m"]}})


@pytest.mark.parametrize("name", [" crown-inner", "hottest ", "two\nlines"])
def test_a_name_that_no_table_gives_back_is_refused(name):
    """`readings.csv` had two columns of one sensor, or a heading of two lines: no command read it again."""
    with pytest.raises(InputError, match=r"sensors: .* is no name of a column"):
        tf.study("nasa-22x5.5-8pr", {"sensors": {name: {"s": "0.30 in", "depth": "0.12 in"}}})
