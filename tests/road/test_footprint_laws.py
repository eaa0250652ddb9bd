"""Footprint laws: the default as it always was, the chord as geometry has it, a measured length."""

from __future__ import annotations

import math

import numpy as np
import pytest

import tyrefem as tf
from tyrefem.boundaries.road_film import hedekel_length, radial_deflection
from tyrefem.errors import InputError
from tyrefem.inputs.loading import GivenFootprint, HedekelFootprint, LoadCase
from tyrefem.simulation.phases import deep_contacts, phase_states
from tyrefem.simulation.rolling_tyre import RollingTyre

R, D = 0.28, 0.03
HEDEKEL = HedekelFootprint(law="hedekel")
GIVEN = GivenFootprint.check({"law": "given", "length": "0.14 m"})


@pytest.mark.parametrize("drum", [math.inf, 1.7, 3.048])
def test_the_default_is_the_same_to_the_bit(drum):
    for deflection in (0.0, 0.003, 0.0271, 0.1):
        d = 2 * R
        x = deflection / d
        before = 1.7 * d * math.sqrt(max(x - x * x, 0.0)) / math.sqrt(1 + d / drum)
        assert LoadCase(1e4, deflection, 6e5, R, drum).footprint_length == before


def test_hedekel_is_the_chord_of_the_free_circle():
    length = LoadCase(1e4, D, 6e5, R, footprint=HEDEKEL).footprint_length
    assert math.hypot(length / 2, R - D) == pytest.approx(R, rel=1e-12)
    corrected = HedekelFootprint.check({"law": "hedekel", "correction": 0.85})
    assert LoadCase(1e4, D, 6e5, R, footprint=corrected).footprint_length == pytest.approx(0.85 * length)
    assert LoadCase(0.0, 0.0, 6e5, R, footprint=HEDEKEL).footprint_length == 0.0


def test_hedekel_on_a_drum_is_the_common_chord_of_two_circles():
    drum, dz = 1.5, 2e-3
    apart = R + drum - dz
    along = (apart**2 + R**2 - drum**2) / (2 * apart)
    chord = 2 * math.sqrt(R**2 - along**2)
    case = LoadCase(1e4, dz, 6e5, R, 2 * drum, HEDEKEL)
    assert case.footprint_length == pytest.approx(chord, rel=2 * dz / R)
    assert case.footprint_length < LoadCase(1e4, dz, 6e5, R, footprint=HEDEKEL).footprint_length


def test_a_measured_length_holds_on_any_drum_while_there_is_contact():
    assert LoadCase(1e4, D, 6e5, R, 0.5, GIVEN).footprint_length == 0.14
    assert LoadCase(0.0, 0.0, 6e5, R, footprint=GIVEN).footprint_length == 0.0
    assert LoadCase(1e4, D, 6e5, R, footprint=GIVEN).contact_time(10.0) == pytest.approx(0.014)


def tyre(**changes):
    return RollingTyre(tf.study("nasa-22x5.5-8pr").replace({k.replace("__", "."): v for k, v in changes.items()}))


def test_in_a_study_hedekel_follows_load_over_stiffness():
    stiff = {"law": "vertical-stiffness", "stiffness": "400 N/mm", "source": "test"}
    rolling = tyre(mechanics__load_law=stiff, mechanics__footprint={"law": "hedekel"}, drive__load="10 kN")
    (case,) = rolling.schedule.cases[0]
    assert case.footprint_length == pytest.approx(hedekel_length(radial_deflection(10e3, 400e3), case.outer_radius))
    assert rolling.road_fraction(0.0) == pytest.approx(case.footprint_length / (2 * np.pi * case.rolling_radius))


def test_in_a_study_the_film_follows_the_footprint():
    """H_c ~ 1/sqrt(L), depth ~ sqrt(L)."""
    long, short = (
        tyre(boundaries__road__law="half-space", mechanics__footprint={"law": "given", "length": length})
        for length in ("0.20 m", "0.05 m")
    )
    assert short.road_film(0.0) == pytest.approx(2 * long.road_film(0.0))
    assert long.propagation_depth(0.0) == pytest.approx(2 * short.propagation_depth(0.0))
    assert tyre(drive__speed="0 mph").propagation_depth(0.0) == 0.0


@pytest.mark.parametrize(("begins", "ends"), [(30.0, 0.0), (30.0, 5.0), (0.0, 30.0), (0.0, 0.001), (10.0, 10.0)])
def test_a_contact_lasts_as_long_as_the_tread_rolls_its_length(begins, ends):
    """A tyre that comes to rest has a last contact of half a second, not of hours."""
    rolling = tyre(drive__speed={"from": f"{begins} m/s", "to": f"{ends} m/s"}, drive__duration="20 s")
    t, length = 20 * (1 - 1e-12), rolling.schedule.cases[0][0].footprint_length
    conductivity, capacity = rolling.tread
    lasts = rolling.propagation_depth(t) ** 2 * capacity / (4 * conductivity)
    mean_speed = ends + (begins - ends) * lasts / 40
    assert mean_speed * lasts == pytest.approx(min(length, 10 * (begins + ends)), rel=1e-9)
    assert lasts <= 20


def test_a_stop_does_not_warn_of_a_deep_contact():
    stop = tyre(drive__speed={"from": "30 m/s", "to": "0 m/s"}, drive__duration="20 s")
    assert deep_contacts(stop.study.section, phase_states(stop)) == ()


@pytest.mark.parametrize(
    ("footprint", "words"),
    [
        ({"law": "hedekl"}, "did you mean 'hedekel'"),
        ({"law": "hedekel", "correction": 0}, "more than 0"),
        ({"law": "given"}, "length"),
        ({"law": "given", "length": "0.14"}, "no unit"),
        ({"law": "given", "length": "1 m"}, "less than the tyre's diameter"),
        ({"law": "tr-r-64", "length": "0.1 m"}, "unknown key 'length'"),
    ],
)
def test_bad_footprints_are_refused(footprint, words):
    with pytest.raises(InputError, match=words) as refused:
        _ = tyre(mechanics__footprint=footprint).schedule
    assert "mechanics.footprint" in str(refused.value)
