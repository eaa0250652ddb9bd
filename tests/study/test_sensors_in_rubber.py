"""Thermocouples: inside the rubber, at its surface, and with lag."""

from __future__ import annotations

import numpy as np
import pytest

import tyrefem as tf
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
        ({"s": "1 in"}, "give either 's' and 'depth', or 'at"),
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
