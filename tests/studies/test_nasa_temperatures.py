"""Against an independent re-implementation of the NASA report's own finite differences (33 elements).

Its tread surface is deliberately not compared. It averages the *series* conductance through 4 mm of rubber to the road
and so loses like 18 W/m2/K there; a film at the surface, averaged over the revolution (f H_c = 1300 W/m2/K), holds the
tread near the road. Here the crown's outside comes out 12 to 28 K lower, the shoulder's outside 12 to 35 K, and the
crown's middle up to 10 K lower. The contained air is 2 to 9 K higher.
"""

from __future__ import annotations

import pytest
from nasa_runs import end, run

# After 600 s from 25 degC on a flat road, degC, with the report's air density.
CASES = {
    ("8PR", 2700, 83): {
        "crown-inner": 83,
        "crown-middle": 70,
        "shoulder-inner": 69,
        "sidewall-inner": 46,
        "sidewall-outer": 38,
    },
    ("8PR", 4350, 156): {
        "crown-inner": 86,
        "crown-middle": 81,
        "shoulder-inner": 73,
        "sidewall-inner": 47,
        "sidewall-outer": 40,
    },
    ("12PR", 4000, 78): {
        "crown-inner": 108,
        "crown-middle": 89,
        "shoulder-inner": 91,
        "sidewall-inner": 72,
        "sidewall-outer": 47,
    },
    ("12PR", 7100, 261): {
        "crown-inner": 87,
        "crown-middle": 115,
        "shoulder-inner": 76,
        "sidewall-inner": 33,
        "sidewall-outer": 29,
    },
}
SURFACE = {("8PR", 2700, 83): 62, ("8PR", 4350, 156): 71, ("12PR", 4000, 78): 80, ("12PR", 7100, 261): 104}
# F_rr / F_z with the whole tyre at 25 degC.
RESISTANCE = {
    ("8PR", 2700, 83): 0.012,
    ("8PR", 4350, 156): 0.009,
    ("12PR", 4000, 78): 0.017,
    ("12PR", 7100, 261): 0.011,
}


@pytest.mark.parametrize("case", CASES)
def test_temperatures_inside_and_in_the_sidewall(case):
    readings = end(run(*case, air="report"))
    for sensor, expected in CASES[case].items():
        assert readings[sensor] == pytest.approx(expected, abs=10), sensor


@pytest.mark.parametrize("case", CASES)
def test_the_road_cools_the_tread_s_surface_more_than_in_the_report_s_network(case):
    assert end(run(*case, air="report"))["crown-outer"] < SURFACE[case] - 5


@pytest.mark.parametrize("case", CASES)
def test_cold_rolling_resistance(case):
    assert run(*case, air="report").rolling_resistance.cold_coefficient == pytest.approx(RESISTANCE[case], rel=0.15)
