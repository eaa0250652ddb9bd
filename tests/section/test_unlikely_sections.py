"""Sections that can be built but are perhaps not meant: warned of, with the field; shipped ones are not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tyrefem as tf
from tyrefem import library
from tyrefem.errors import InputError
from tyrefem.geometry import load

STUDY, BIAS = "passenger-205-55r16", "nasa-22x5.5-8pr"
RADIAL = str(Path(__file__).with_name("hand-drawn-radial.toml"))
POINTS = np.array(library.load("section", RADIAL)[0]["line"]["points"]["values"], dtype=float)


def drawn(points: Any) -> dict[str, Any]:
    """The radial along other points, mm."""
    return {"base": RADIAL, "line": {"points": {"unit": "mm", "values": np.asarray(points).tolist()}}}


def moved(*changes: tuple[int, int, float]) -> dict[str, Any]:
    points = POINTS.copy()
    for row, column, value in changes:
        points[row, column] = value
    return drawn(points)


def warnings_of(reference: object) -> list[str]:
    return [str(warning) for warning in load(reference).warnings]


@pytest.mark.parametrize("name", library.names("section"))
def test_no_shipped_section_is_unlikely(name: str) -> None:
    assert warnings_of(name) == []
    assert load(name).as_full().warnings == ()


class TestNominalWidth:
    """Names a size; only two arcs with a shoulder fraction follow it."""

    def test_laid_over_a_section_that_does_not_follow_it(self) -> None:
        wide = {"base": RADIAL, "parameters": {"nominal_width": "255 mm"}}
        with pytest.raises(InputError, match=r"nominal_width: names the tyre's size only: .* follows from line.points"):
            load(wide)
        with pytest.raises(InputError, match=r"parameters.nominal_width: names the tyre's size only"):
            tf.study(STUDY, {"section.nominal_width": "255 mm"})

    def test_the_same_in_another_unit_changes_nothing(self) -> None:
        assert warnings_of({"base": RADIAL, "parameters": {"nominal_width": "0.205 m"}}) == []

    def test_with_points_of_its_own(self) -> None:
        wider = POINTS * [1.0, 255 / 205]
        changes = {"parameters": {"nominal_width": "255 mm"}, "rating": {"width": "255 mm"}}
        layers = {str(i): {"s": {"unit": "mm", "values": [0, 240]}, "thickness": {"unit": "mm", "values": [1.5, 1.5]}}
                  for i in range(7)}  # fmt: skip
        section = load({**drawn(wider), **changes, "layers": layers})
        assert section.overall_width / load(RADIAL).overall_width == pytest.approx(255 / 205, rel=0.05)
        assert "nominal_width" not in "".join(map(str, section.warnings))

    def test_two_arcs_follow_it(self) -> None:
        wide = load({"base": BIAS, "parameters": {"nominal_width": "6 in"}})
        assert wide.overall_width > load(BIAS).overall_width

    def test_a_section_of_another_width(self) -> None:
        """As in a card that was copied and only its designation changed."""
        wider = drawn(POINTS * [1.0, 1.5])
        layers = {str(i): {"s": {"unit": "mm", "values": [0, 290]}, "thickness": {"unit": "mm", "values": [1.5, 1.5]}}
                  for i in range(7)}  # fmt: skip
        (warning,) = [text for text in warnings_of({**wider, "layers": layers}) if "nominal" in text]
        assert warning.startswith("parameters.nominal_width: the section is 3")


def test_ratings_of_another_tyre() -> None:
    """What `new section --from` leaves behind: the load law would take width and diameter of the old tyre."""
    assert warnings_of({"base": RADIAL, "parameters": {"outer_diameter": "760 mm"}}) == [
        "rating.diameter: the rated diameter is 632 mm and the outer diameter 760 mm: "
        "check that the ratings are of this tyre"
    ]
    assert warnings_of({"base": RADIAL, "rating": {"width": "255 mm"}})[0].startswith(
        "rating.width: the rated width is 255"
    )


def liner(stations: list[float]) -> dict[str, Any]:
    ones = {"unit": "mm", "values": [1.0] * len(stations)}
    return {"base": RADIAL, "layers": {"0": {"s": {"unit": "mm", "values": stations}, "thickness": ones}}}


def test_tables_beyond_the_meridian() -> None:
    end = load(RADIAL).line.length * 1e3
    assert 196 < end < 198
    assert warnings_of(liner([0, 200])) == []
    (rows,) = warnings_of(liner([0, 198, 210, 220]))
    assert rows.startswith("layers.0.s: the table of 'liner' goes on to 220 mm")
    assert rows.endswith("its last 2 rows have no effect")
    (warning,) = warnings_of(liner([0, 300]))
    assert warning.endswith("but the meridian ends at 196.9 mm: it is cut there")


def test_a_table_that_is_stretched_ends_where_the_meridian_does() -> None:
    assert warnings_of({"base": BIAS, "parameters": {"meridian_length": "5 in"}}) == []


class TestMeridian:
    """Convex from the crown, hollow towards the bead once; no kinks. Rounding of points is no bend."""

    def test_rounded_points_are_no_bends(self) -> None:
        rng = np.random.default_rng(0)
        for _ in range(5):
            noise = rng.uniform(-0.05, 0.05, POINTS.shape)
            noise[0, 1] = 0.0
            assert warnings_of(drawn(POINTS + noise)) == []

    def test_a_hollow_in_the_sidewall(self) -> None:
        (hollow, *_) = warnings_of(moved((9, 1, 94.2), (10, 1, 96.2), (11, 1, 98.6)))
        assert hollow.startswith("line.points: the meridian is hollow at s = 87 to 91 mm (3 deg), s = 102 to 111 mm")
        assert "inflated, the wall turns there" in hollow

    def test_a_hollow_crown(self) -> None:
        (hollow,) = warnings_of(moved((1, 0, 304.0)))
        assert hollow.startswith("line.points: the meridian is hollow at s = 0 to 10 mm (8 deg)")

    def test_a_kink(self) -> None:
        *_, kink = warnings_of(moved((10, 1, 98.5)))
        assert kink.startswith("line.points: the meridian has a kink at s = 104 mm (27 deg, radius 5.")

    def test_the_wall_turns_where_it_is_hollow(self) -> None:
        """By finite elements: inflated to 210 kPa, a hollow sidewall turns three times as far as the smooth one."""
        turns = [_turn(tf.study(STUDY).replace({"section": section})) for section in (RADIAL, moved((10, 1, 98.5)))]
        assert turns[1] > 3 * turns[0]


def _turn(study: tf.Study) -> float:
    """Largest rotation, rad, of the wall from s = 100 to 120 mm in inflation."""
    from tyrefem.geometry.meshing import build
    from tyrefem.mechanics.solid.inflation import inflate

    tyre = inflate(study, None, build(study.section, size=10e-3, through=1))
    F = tyre.deformation
    angle = np.arctan2(F[1, 0] - F[0, 1], F[0, 0] + F[1, 1])
    s, _ = study.section.locate(tyre.body.rings.points.reshape(2, -1).T)
    inside = (s > 0.100) & (s < 0.120)
    return float(np.abs(angle.ravel()[inside]).max())
