"""A bias tyre under its rated pressure grows to the size that the data book states."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tyrefem.errors import InputError
from tyrefem.geometry.meshing import build
from tyrefem.inputs.study import StudyData
from tyrefem.mechanics.solid.inflation import inflate
from tyrefem.sizes import draw_size
from tyrefem.sizes.data_book import row_of
from tyrefem.sizes.designation import parse_size
from tyrefem.sizes.growth import before_inflation, stretched
from tyrefem.sizes.meridian import SizedMeridian

SIZE = "22x5.5 8PR"


def inflated_line() -> tuple[SizedMeridian, float, float]:
    """The line of the inflated size, Pa, and the stiffness of its plies, N/m."""
    drawn = draw_size(SIZE, {"radius_growth": "0 mm", "width_growth": "0 mm"})
    n = {number.name: number.value for number in drawn.rules}
    return drawn.meridian, n["rated_pressure"], n["plies"] * n["ply_gauge"] * n["ply_modulus"]


@pytest.mark.parametrize("size", ["22x5.5 8PR", "40x14 24PR"])
def test_the_inflated_tyre_has_the_size_of_the_data_book(size: str) -> None:
    """By finite elements: within the least and largest diameter; the width within 1 % of the largest."""
    row, rules = row_of(parse_size(size)), draw_size(size).rules
    assert row is not None
    drive = {"speed": "60 km/h", "load": rules["rated_load"].text, "pressure": rules["rated_pressure"].text,
             "duration": "60 s", "ambient": "25 degC"}  # fmt: skip
    study = StudyData("sized", {"title": size, "section": size, "materials": {}, "drive": drive}, None, Path())
    mesh = build(study.section, size=0.11 * row.section_width, through=1)
    places = inflate(study, mesh=mesh).places
    assert row.diameter[0] <= 2 * places[0].max() <= row.diameter[1]
    assert row.width[0] <= 2 * places[1].max() <= 1.01 * row.width[1]
    assert study.section.outer_diameter < row.diameter[0] * 1.003


def test_the_cords_before_inflation_are_shorter_by_their_stretch() -> None:
    line, pressure, stiffness = inflated_line()
    length, stretch = stretched(line, pressure, stiffness)
    mould = before_inflation(line, pressure, stiffness)
    assert stretched(mould, 0.0, stiffness)[0] == pytest.approx(length, rel=1e-5)
    assert mould.membrane.lift == pytest.approx(line.membrane.lift * (1 + stretch), rel=1e-9)
    assert 0.02 < stretch < 0.05
    assert mould.crown < line.crown
    assert mould.half_width < line.half_width


def test_stiff_plies_do_not_grow() -> None:
    """Growth is in proportion to pressure over stiffness while it is small, and vanishes with it."""
    line, pressure, stiffness = inflated_line()
    soft, stiff = (line.crown - before_inflation(line, pressure, k * stiffness).crown for k in (20.0, 40.0))
    assert 0 < stiff < 5e-4
    assert soft == pytest.approx(2 * stiff, rel=0.05)


def test_the_stretch_is_that_of_the_axial_balance() -> None:
    """Cords of one circle carry the pressure on the ring inside of it: 2 pi r h E e sin^2 alpha sin phi = pi p (r^2 -
    r_m^2)."""
    line, pressure, stiffness = inflated_line()
    r = line.at(np.linspace(0.0, 0.6 * line.widest_s, 50))[0]
    sine = np.sqrt(1 - (line.membrane.lift * r) ** 2)
    e = pressure * line.membrane.tension(r) / (stiffness * sine**2)
    pull = 2 * r * stiffness * e * sine**2 * line.membrane.sine(r)
    assert pull == pytest.approx(pressure * (r**2 - line.membrane.widest**2), rel=1e-9)
    assert stretched(line, pressure, stiffness)[1] < e[0]


def test_plies_that_stretch_too_much_are_refused() -> None:
    with pytest.raises(InputError, match="leave no line before inflation"):
        draw_size(SIZE, {"plies": 2, "ply_gauge": "0.4 mm"})


def test_given_growth_is_kept() -> None:
    usual, rigid = draw_size(SIZE), draw_size(SIZE, {"radius_growth": "0 mm", "width_growth": "0 mm"})
    growth = usual.rules["radius_growth"].value
    assert rigid.meridian.crown - usual.meridian.crown == pytest.approx(growth, abs=1e-9)
    assert 4e-3 < growth < 8e-3
