"""What Clark & Dodge (1980) and NASA TP-2195 say of their measurements in words, on the shipped studies."""

from __future__ import annotations

import numpy as np
import pytest
from nasa_runs import end, run

from tyrefem.simulation.sensors import lagged

pytestmark = pytest.mark.fast


def test_1_the_gradient_reverses_between_sidewall_and_tread_at_full_pressure():
    """12PR at 261 psi: the sidewall is hotter inside, while the tread rubber is hotter than the carcass under it."""
    readings = end(run("12PR"))
    assert readings["sidewall-inner"] > readings["sidewall-outer"] + 3
    assert readings["crown-middle"] > readings["crown-inner"] + 3


def test_1_at_low_pressure_the_carcass_is_hottest():
    readings = end(run("12PR", 4000, 78))
    assert readings["crown-inner"] > readings["crown-middle"] + 3
    assert readings["sidewall-inner"] > readings["sidewall-outer"] + 3


@pytest.mark.parametrize("tyre", ["8PR", "12PR"])
@pytest.mark.parametrize("place", ["crown", "shoulder", "sidewall"])
def test_2_in_free_rolling_the_inner_wall_is_hotter_than_the_outer_surface(tyre, place):
    readings = end(run(tyre))
    assert readings[f"{place}-inner"] > readings[f"{place}-outer"] + 3


@pytest.mark.parametrize(
    ("tyre", "pressure", "loads"), [("8PR", 83, (2700, 3270, 4000)), ("12PR", 55, (2560, 3150, 4000))]
)
def test_3_more_deflection_heats_shoulder_and_sidewall(tyre, pressure, loads):
    """The report's own series of rising load at one pressure: every step warms shoulder and sidewall by 3 K or more."""
    runs = [run(tyre, load, pressure) for load in loads]
    assert np.all(np.diff([result.phases[0].deflection for result in runs]) > 0)
    for sensor in ("shoulder-inner", "shoulder-outer", "sidewall-inner", "sidewall-outer"):
        assert np.all(np.diff([end(result)[sensor] for result in runs]) > 3), sensor


@pytest.mark.parametrize("speed", [35, 50])
def test_4_speed_raises_the_tread_moderately_and_the_carcass_hardly(speed):
    """12PR, 4000 lbf, 78 psi, after the same 5.4 km at 20, 35 and 50 mph.

    The heat per metre is the same; less time is left to lose it. Moderately: the rise near the tread's surface grows by
    10 to 40 %; hardly: that of the carcass under the crown by less than 10 %, and by less than a third of the tread's.
    """
    slow, fast = end(run("12PR", 4000, 78)) - 25, end(run("12PR", 4000, 78, speed)) - 25
    tread, carcass = (fast[name] / slow[name] - 1 for name in ("crown-outer", "crown-inner"))
    assert 0.10 < tread < 0.40
    assert 0 <= carcass < 0.10
    assert carcass < tread / 3


@pytest.mark.parametrize("air", ["gas", "report"])
def test_5_contained_air_lags_the_inner_surface(air):
    """Appendix G: m c dT/dt = h A (mean of the inner surface - T), so the gas trails it with tau = m c / (h A)."""
    result = run("8PR", air=air)
    section, law = result.study.section, result.study.card.boundaries.contained_air
    s = (np.arange(300) + 0.5) / 300 * section.line.length
    points = section.place(s, np.full(300, 5e-5))
    # Equal steps along the meridian; on the inner face an element of arc is (1 + kappa y) as long.
    stretch = 1 + section.line.curvature(s) * section.interfaces(s)[0]
    surface = np.average(result.at(points), axis=1, weights=points[:, 0] * stretch)
    gas = result.gas_temperature
    assert np.all(gas[1:] < surface[1:])
    capacity = law.heat_capacity(section.gas_volume(), result.phases[0].pressure, 25.0)
    tau = capacity / (law.film * section.inner_surface_area())
    assert gas == pytest.approx(lagged(result.times, surface, tau), abs=0.5)
