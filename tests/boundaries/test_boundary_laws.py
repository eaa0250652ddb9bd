"""Films and heat capacities of the surroundings against numbers worked by hand or printed."""

from __future__ import annotations

import pytest

import tyrefem as tf
from tyrefem.boundaries import Contact, LawOf
from tyrefem.errors import InputError
from tyrefem.quantity import parse
from tyrefem.simulation.rolling_tyre import RollingTyre

pytestmark = pytest.mark.fast


def law(side, name, **numbers):
    return LawOf(side, name)({"law": name, **numbers})


def test_the_report_s_films():
    """Appendix I in cal/(cm2 s K): 1.3e-4 + 4e-7 V[cm/s], 1e-4, 0.5 and 0.25."""

    def cal(x):
        return parse(f"{x} cal/cm**2/s/K", "W/m**2/K")

    outside = law("outside_air", "nasa")
    for speed in (0.0, 8.9408, 70.0):
        assert outside.film(speed) == pytest.approx(cal(1.3e-4 + 4e-7 * speed * 100), rel=1e-12)
    assert outside.film(0.0) == pytest.approx(5.44, abs=0.005)
    assert outside.film(1.0) - outside.film(0.0) == pytest.approx(1.674, abs=0.001)
    assert law("contained_air", "gas").film == pytest.approx(cal(1e-4))
    assert law("rim", "fixed").total_film == pytest.approx(cal(0.5))
    assert law("road", "constant").film(Contact(9.0, 0.2, 0.2, 2e6)) == pytest.approx(cal(0.25))


# Cattani et al. 2023, table 2: speed km/h, footprint length m, H_c W/m2/K, with lambda = 0.25 W/m/K, C = 2e6 J/m3/K.
@pytest.mark.parametrize(
    ("speed", "length", "printed"), [(10, 0.10, 3726.78), (130, 0.14, 11356.42), (300, 0.18, 15214.52)]
)
def test_cattani_table_2(speed, length, printed):
    road = law("road", "cattani")
    assert road.film(Contact(speed / 3.6, length, 0.25, 2e6)) == pytest.approx(printed, abs=0.006)
    given = law("road", "cattani", conductivity="0.25 W/m/K", heat_capacity="2e6 J/m**3/K")
    assert given.film(Contact(speed / 3.6, length, 9.0, 9.0)) == pytest.approx(printed, abs=0.006)


def test_no_contact_no_film():
    assert law("road", "cattani").film(Contact(10.0, 0.0, 0.25, 2e6)) == 0.0
    assert law("road", "cattani").film(Contact(0.0, 0.2, 0.25, 2e6)) == 0.0


def test_a_table_of_films():
    table = law("outside_air", "table", table=[["0 m/s", "5 W/m**2/K"], ["10 m/s", "25 W/m**2/K"]])
    assert [table.film(v) for v in (0.0, 5.0, 10.0, 90.0)] == pytest.approx([5.0, 15.0, 25.0, 25.0])
    with pytest.raises(InputError, match="speeds rise"):
        law("outside_air", "table", table=[["10 m/s", "5 W/m**2/K"], ["0 m/s", "25 W/m**2/K"]])


def test_contact_resistance_is_in_series():
    """1/h = 1/1000 + 1/1000."""
    rim = law("rim", "fixed", film="1000 W/m**2/K", contact_resistance="0.001 m**2*K/W")
    assert rim.total_film == pytest.approx(500.0)
    assert law("rim", "fixed", film="0 W/m**2/K").total_film == 0.0


def test_gas_in_the_tyre_by_hand():
    """10 litres at 5 bar gauge and 20 degC: m = 601325 x 0.01 / (287.05 x 293.15) = 0.07146 kg; m c_v = 51.31 J/K."""
    gas = law("contained_air", "gas")
    assert gas.heat_capacity(0.01, 5e5, 20.0) == pytest.approx(51.31, abs=0.01)
    report = law("contained_air", "report")
    assert report.heat_capacity(0.01, 5e5, 20.0) == pytest.approx(1.3 * 0.01 * 0.24 * 4184, rel=1e-12)
    assert law("contained_air", "held", temperature="30 degC").heat_capacity(0.01, 5e5, 20.0) is None


def test_the_report_s_air_is_that_of_an_open_tyre():
    """At 83 psi gauge the gas is (83 + 14.7)/14.7 = 6.6 times denser than the air at 1 atm that the report takes."""
    gas = law("contained_air", "gas")
    inflated, open_tyre = (gas.heat_capacity(0.01, parse(p, "Pa"), 25.0) for p in ("83 psi", "0 psi"))
    assert inflated / open_tyre == pytest.approx(6.6, abs=0.06)
    # At 0 degC the open tyre's air has the printed density, 0.0013 g/cm3.
    assert gas.heat_capacity(1.0, 0.0, 0.0) / 718.0 == pytest.approx(1.3, abs=0.01)


@pytest.mark.parametrize(("name", "field"), [("held", "temperature"), ("gas", "initial")])
def test_a_gas_at_absolute_zero_has_no_pressure(name, field):
    law("contained_air", name, **{field: "1 K"})
    with pytest.raises(InputError, match=r"'0 K' is out of range: must be more than -273\.15 degC"):
        tf.study("nasa-22x5.5-8pr", {"boundaries.contained_air": {"law": name, field: "0 K"}})


def test_a_held_gas_has_no_initial_temperature():
    held = {"law": "held", "temperature": "30 degC"}
    plain, both = (
        tf.study("nasa-22x5.5-8pr", {"boundaries.contained_air": {**held, **more}})
        for more in ({}, {"initial": "90 degC"})
    )
    (warning,) = set(both.warnings) - set(plain.warnings)
    assert str(warning).endswith("boundaries.contained_air.initial: does not act: the gas keeps its 'temperature'")


def conditions(**changes):
    return RollingTyre(tf.study("nasa-22x5.5-8pr").replace({k.replace("__", "."): v for k, v in changes.items()}))


def test_at_standstill_the_road_takes_nothing():
    still = conditions(drive__speed="0 mph")
    assert still.road_fraction(0.0) == 0.0
    assert still.air_film(0.0) == pytest.approx(5.44, abs=0.005)
    rolling = conditions()
    assert rolling.road_fraction(0.0) == pytest.approx(rolling.schedule.cases[0][0].road_fraction)
    assert conditions(boundaries__road__fraction="10 %").road_fraction(0.0) == pytest.approx(0.1)


def test_road_temperature_is_the_drive_s_then_the_law_s_then_the_ambient():
    assert conditions().road_temperature(0.0) == 25.0
    law_says = {"boundaries__road__temperature": "40 degC"}
    assert conditions(**law_says).road_temperature(0.0) == 40.0
    assert conditions(**law_says, drive__road_temperature="50 degC").road_temperature(0.0) == 50.0


def test_a_hot_road_heats_a_cold_tyre():
    heat = {
        hot: tf.study("nasa-22x5.5-8pr")
        .replace(
            {
                "drive.road_temperature": hot,
                "drive.duration": "30 s",
                "drive.load": "200 lbf",
                "mesh.size": "4 mm",
                "mesh.element": "P1",
            }
        )
        .run()
        .heat_budget.energies["lost", "road contact"][-1]
        for hot in ("25 degC", "60 degC")
    }
    assert heat["60 degC"] < 0 < heat["25 degC"]


def test_a_lumped_rim_stores_what_the_beads_give_less_what_it_passes_on():
    rim = {"law": "lumped", "mass": "2 kg", "cooling": "1 W/K"}
    result = (
        tf.study("nasa-22x5.5-8pr").replace({"boundaries.rim": rim, "mesh.size": "4 mm", "mesh.element": "P1"}).run()
    )
    budget, temperature = result.heat_budget.energies, result.readings["rim"].to_numpy()
    assert temperature[-1] > temperature[0] + 0.5
    assert budget["lumped", "rim: stored"][-1] == pytest.approx(
        2 * 0.23 * 4184 * (temperature[-1] - temperature[0]), rel=1e-9
    )
    passed = budget["lumped", "rim: passed on"][-1]
    assert budget["lost", "rim"][-1] == pytest.approx(budget["lumped", "rim: stored"][-1] + passed, rel=1e-9)
    # Newton cooling, 1 W/K over the ambient: the integral by the trapezium of the readings.
    above = temperature - 25.0
    assert passed == pytest.approx(
        ((above[1:] + above[:-1]) / 2 * (result.times[1:] - result.times[:-1])).sum(), rel=1e-3
    )


@pytest.mark.parametrize("side", ["road", "outside_air", "contained_air", "rim", "sliding"])
def test_an_unknown_law_lists_the_known(side):
    with pytest.raises(InputError, match="unknown law 'nothing'"):
        law(side, "nothing")
    for wrong in ([], {}, 3, None):
        with pytest.raises(InputError):
            LawOf(side, "nothing")({"law": wrong})
