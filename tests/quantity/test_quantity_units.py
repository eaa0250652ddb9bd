"""Units at the boundary: what a person writes becomes SI once, and nothing else gets in."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tyrefem.errors import InputError
from tyrefem.quantity import Unit, convert, parse

pytestmark = pytest.mark.fast

PAIRS = {
    "m": ("in", "mm", "ft", "furlong"),
    "m/s": ("mph", "km/h", "ft/s"),
    "N": ("lbf", "kN"),
    "Pa": ("psi", "bar", "kPa"),
    "s": ("min", "h"),
    "W/m/K": ("cal/cm/s/K",),
    "W/m**2/K": ("cal/cm**2/s/K", "W/cm**2/K"),
    "J/kg/K": ("cal/g/K",),
    "rad": ("deg",),
    "1": ("percent",),
}


@settings(deadline=None, max_examples=60)
@given(
    st.sampled_from([(si, other) for si, others in PAIRS.items() for other in others]),
    st.floats(1e-9, 1e9),
)
def test_a_converted_number_reads_back_the_same(units, value):
    si, other = units
    shown = convert(value, "dimensionless" if si == "1" else si, other)
    assert parse(f"{shown!r} {other}", si) == pytest.approx(value, rel=1e-12)


# Definitions: the inch 25.4 mm, the pound-force 0.45359237 kg times 9.80665 m/s2, the thermochemical calorie 4.184 J.
@pytest.mark.parametrize(
    ("text", "unit"),
    [("10 rad/s", "Hz"), ("600 rpm", "Hz"), ("1 turn/s", "Hz"), ("2 deg", "1"), ("0.03 rad", "1"), ("5 %", "rad")],
)
def test_angles_are_no_numbers(text, unit):
    """pint gives angles no dimension: it would read 10 rad/s as 10 Hz, not as 10/(2 pi) Hz."""
    with pytest.raises(InputError, match=r"is (a|an) (angle|number)"):
        parse(text, unit)
    assert parse("10 1/s", "Hz") == parse("10 Hz", "Hz") == 10.0


@pytest.mark.parametrize(
    ("text", "unit", "exact"),
    [
        ("22 in", "m", 22 * 0.0254),
        ("20 mph", "m/s", 20 * 1609.344 / 3600),
        ("2700 lbf", "N", 2700 * 0.45359237 * 9.80665),
        ("83 psi", "Pa", 83 * 0.45359237 * 9.80665 / 0.0254**2),
        ("5e-4 cal/cm/s/K", "W/m/K", 0.2092),
        ("0.5 cal/g/K", "J/kg/K", 2092.0),
        ("1 g/cm**3", "kg/m**3", 1000.0),
        ("35 deg", "rad", math.radians(35)),
        ("20 %", "1", 0.2),
    ],
)
def test_definitions_of_units(text, unit, exact):
    assert parse(text, unit) == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "celsius"), [("77 degF", 25.0), ("298.15 K", 25.0), ("25 degC", 25.0), ("0 K", -273.15)]
)
def test_a_temperature(text, celsius):
    assert parse(text, "degC") == pytest.approx(celsius, abs=1e-9)


@pytest.mark.parametrize(("text", "kelvin"), [("9 delta_degF", 5.0), ("5 K", 5.0), ("5 delta_degC", 5.0)])
def test_a_difference_of_temperatures(text, kelvin):
    assert parse(text, "delta_degC") == pytest.approx(kelvin, rel=1e-12)


def test_temperature_and_difference_are_not_mixed_up():
    with pytest.raises(InputError, match="difference of temperatures is wanted: write 'delta_degC'"):
        parse("5 degC", "delta_degC")
    with pytest.raises(InputError, match="difference of temperatures, but a temperature is wanted"):
        parse("5 delta_degC", "degC")


@pytest.mark.parametrize("text", ["-274 degC", "-1 K", "-460 degF"])
def test_nothing_is_colder_than_absolute_zero(text):
    with pytest.raises(InputError, match="below absolute zero"):
        parse(text, "degC")


@pytest.mark.parametrize(
    "value", ["0.6", 0.6, 3, "", "m", "0.6 kg", "0.6 inchez", "1 m; 2 m", None, True, [], {}, "1 m" * 40]
)
def test_a_length_without_a_proper_unit_is_refused(value):
    with pytest.raises(InputError):
        parse(value, "m")


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, "nan m", "inf m", "1e999 m", "1e308 km", 10**400])
def test_what_is_not_a_finite_number_is_refused(value):
    for unit in ("m", "1"):
        with pytest.raises(InputError):
            parse(value, unit)


def test_the_error_gives_an_example():
    with pytest.raises(InputError, match="'20 mph' or '9 m/s'"):
        parse("20", "m/s")
    with pytest.raises(InputError, match="unknown unit 'mihp'"):
        parse("20 mihp", "m/s")


def test_bounds_are_named():
    positive = Unit("m", gt=0, le=1)
    assert positive("1 m") == 1.0
    with pytest.raises(InputError, match="must be more than 0 m"):
        positive("0 m")
    with pytest.raises(InputError, match="must be at most 1 m"):
        positive("1.01 m")


@pytest.mark.parametrize("text", ["60,5 s", "1,200 s", "0,5s"])
def test_a_comma_in_a_number_is_named(text: str) -> None:
    """Where a decimal comma is usual, ',5 s is not a unit' told nothing."""
    with pytest.raises(InputError, match=r"has a comma; numbers have a decimal point"):
        parse(text, "s")


@pytest.mark.parametrize(
    ("mass", "weight"), [("4500 kg", "44.13 kN"), ("10000 lb", "44.482 kN"), ("4.5 t", "44.13 kN")]
)
def test_a_mass_in_place_of_a_force_has_its_weight_in_the_message(mass: str, weight: str) -> None:
    with pytest.raises(InputError, match=f"a mass: its weight is '{weight}'"):
        parse(mass, "N")
    with pytest.raises(InputError, match="is not a unit of this quantity") as error:
        parse(mass, "Pa")
    assert "weight" not in str(error.value)
