"""Load to deflection to footprint (NASA TR R-64, type VII tyres)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tyrefem.errors import InputError
from tyrefem.geometry import load as section
from tyrefem.inputs.loading import LoadCase, TrR64, VerticalStiffness, load_case
from tyrefem.inputs.study import study
from tyrefem.mechanics.solved_cases import check_cases

pytestmark = pytest.mark.fast

INCH, PSI, LBF = 0.0254, 6894.757293168361, 4.4482216152605


@dataclass(frozen=True)
class Nominal:
    width: float = 5.5 * INCH
    diameter: float = 22 * INCH
    pressure: float = 156 * PSI


LAW, TYRE = TrR64(), Nominal()


def shape(u, c=0.02):
    """The published relation, as printed."""
    return 0.96 * u + 0.216 * u**2 / c if u <= 10 * c / 3 else 2.4 * (u - c)


@pytest.mark.parametrize("u", [0.01, 0.05, 0.1, 0.2, 0.3])
def test_load_is_the_published_relation(u):
    p = 83 * PSI
    scale = (p + 0.08 * 156 * PSI) * 5.5 * INCH * math.sqrt(5.5 * 22) * INCH
    assert LAW.load(u * TYRE.width, p, TYRE) == pytest.approx(shape(u) * scale, rel=1e-12)


@pytest.mark.parametrize("c", [0.01, 0.02, 0.03])
def test_the_two_branches_meet_with_the_same_slope(c):
    law, border = TrR64(shape_factor=f"{c}"), 10 * c / 3 * TYRE.width
    step = 1e-7 * TYRE.width
    below, at, above = (law.load(border + k * step, 1e6, TYRE) for k in (-1, 0, 1))
    assert below == pytest.approx(at, rel=1e-5)
    assert (at - below) == pytest.approx(above - at, rel=1e-5)


@settings(deadline=None, max_examples=100)
@given(st.floats(1e-4, 0.9), st.floats(0, 3e6))
def test_deflection_inverts_load(u, pressure):
    D = u * TYRE.width
    assert LAW.deflection(LAW.load(D, pressure, TYRE), pressure, TYRE) == pytest.approx(D, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "load", "pressure"), [("nasa-22x5.5-8pr", 4350, 156), ("nasa-22x5.5-12pr", 7100, 261)]
)
def test_rated_deflection(name, load, pressure):
    """Aircraft tyres run at 27 to 30 % "deflection" at the rated load.

    The percentage is of the free height over the rim; its rim radius is not printed for these tyres. Over the section
    height of 4.1 in that table H2 prints, the law gives 26.5 % (8PR) and 26.0 % (12PR); over crown to bead,
    y_m - y_B, 28.6 % and 25.8 %.
    """
    tyre = section(name)
    case = load_case(LAW, tyre.rating, outer_radius=tyre.outer_diameter / 2, pressure=pressure * PSI, load=load * LBF)
    assert 0.255 < case.deflection / (4.1 * INCH) < 0.30
    assert 0.255 < case.deflection / (tyre.line.crown_midline_radius - tyre.line.bead[1]) < 0.30


def test_footprint_and_fraction_of_the_revolution():
    case = LoadCase(1e4, 0.03, 6e5, outer_radius=0.28)
    x = 0.03 / 0.56
    length = 1.7 * 0.56 * math.sqrt(x - x * x)
    assert case.footprint_length == pytest.approx(length, rel=1e-12)
    assert case.rolling_radius == pytest.approx(0.27, rel=1e-12)
    assert case.road_fraction == pytest.approx(length / (2 * math.pi * 0.27), rel=1e-12)
    assert case.contact_time(10.0) == pytest.approx(length / 10, rel=1e-12)
    assert case.contact_time(0.0) == math.inf


def test_a_drum_shortens_the_footprint_as_two_cylinders_touch():
    """Equal deflection: half length ~ sqrt(effective radius), 1/R_eff = 1/R + 1/R_drum; on an equal drum 1/sqrt 2."""
    road = LoadCase(1e4, 0.03, 6e5, 0.28)
    assert LoadCase(1e4, 0.03, 6e5, 0.28, 0.56).footprint_length == pytest.approx(road.footprint_length / math.sqrt(2))
    assert LoadCase(1e4, 0.03, 6e5, 0.28, 1e9).footprint_length == pytest.approx(road.footprint_length)


def test_load_and_deflection_are_two_ways_to_say_the_same():
    common = {"outer_radius": 0.28, "pressure": 6e5}
    by_load = load_case(LAW, TYRE, load=12e3, **common)
    assert load_case(LAW, TYRE, deflection=by_load.deflection, **common).load == pytest.approx(12e3)
    assert load_case(LAW, TYRE, load=0.0, **common).deflection == 0.0


def test_measured_stiffness():
    law = VerticalStiffness(law="vertical-stiffness", stiffness="400 N/mm", source="test")
    assert law.deflection(12e3, 6e5, TYRE) == pytest.approx(0.03)
    assert law.load(0.03, 6e5, TYRE) == pytest.approx(12e3)


@pytest.mark.parametrize("given", [{"load": 5e5}, {"deflection": 0.15}])
def test_an_impossible_deflection_is_refused(given):
    with pytest.raises(InputError, match=r"deflects the tyre by .* allowed: 0 to 140 mm"):
        load_case(LAW, TYRE, outer_radius=0.28, pressure=6e5, **given)


def test_an_obstacle_is_no_drum() -> None:
    """1.7 mm, written for 1.7 m, left no footprint, so no heat to the road: a tread of 467 degC after 20 s."""
    with pytest.raises(InputError, match=r"drive\.drum_diameter: a drum of 1\.7 mm is too small: at least a tenth"):
        check_cases(study("nasa-22x5.5-8pr", {"drive.drum_diameter": "1.7 mm"}))
    check_cases(study("nasa-22x5.5-8pr", {"drive.drum_diameter": "0.1 m"}))
