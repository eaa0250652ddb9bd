"""A meridian through points against the circle that the points are on."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import ring_section

from tyrefem.errors import InputError
from tyrefem.geometry import SectionCard, SplineLine, build, load


@pytest.fixture
def ring_card() -> dict[str, Any]:
    return ring_section.ring_card()


def circle(n: int, angle: float = 2.0) -> tuple[tuple[float, float], ...]:
    a = np.linspace(0.0, angle, n)
    return tuple(zip((0.2 + 0.1 * np.cos(a)).tolist(), (0.1 * np.sin(a)).tolist(), strict=True))


def test_spline_converges_to_the_circle_with_order_four() -> None:
    s = np.linspace(0, 0.2, 50)
    exact = np.stack([0.2 + 0.1 * np.cos(10 * s), 0.1 * np.sin(10 * s)], axis=1)
    errors = [np.abs(SplineLine(circle(n), 0.06).position(s) - exact).max() for n in (9, 17, 33)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders.min() > 3.5


def test_nearest_inverts_position_and_normal() -> None:
    line = SplineLine(circle(15), 0.06)
    rng = np.random.default_rng(3)
    s = rng.uniform(-line.length, line.length, 300)
    y = rng.uniform(-0.03, 0.03, 300)
    s_found, y_found = line.nearest(line.position(s) + y[:, None] * line.normal(s))
    assert np.abs(s_found - s).max() < 1e-10
    assert np.abs(y_found - y).max() < 1e-10


def test_arc_length_is_arc_length() -> None:
    line = SplineLine(circle(15), 0.06)
    s = np.linspace(-line.length, line.length, 4001)
    steps = np.linalg.norm(np.diff(line.position(s), axis=0), axis=1)
    assert np.allclose(steps, np.diff(s), atol=1e-11)


def test_section_on_points_measures_as_on_arcs(ring_card: dict[str, Any]) -> None:
    on_arcs = build(SectionCard.check(ring_card))
    points = [[r * 1e3 + 5.0, z * 1e3] for r, z in circle(81)]
    ring_card["line"] |= {"kind": "points", "points": {"unit": "mm", "values": points}}
    ring_card["parameters"] = {
        "nominal_width": "160 mm",
        "shoulder_s": f"{on_arcs.line.shoulder_s} m",
        "outer_diameter": f"{on_arcs.outer_diameter} m",  # moves the points back by the 5 mm
        "bead_length": "30 mm",
        "rim_length": "20 mm",
        "source": "made up for a test",
    }
    for layer in ring_card["layers"]:
        layer["stretch"] = True
    on_points = build(SectionCard.check(ring_card))
    assert on_points.outer_diameter == pytest.approx(on_arcs.outer_diameter, rel=1e-12)
    for region in on_arcs.regions:
        assert on_points.volume(region) == pytest.approx(on_arcs.volume(region), rel=1e-6)
    assert on_points.gas_volume() == pytest.approx(on_arcs.gas_volume(), rel=1e-6)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        (circle(2), "three points"),
        (((0.3, 0.001), (0.29, 0.03), (0.27, 0.06)), "z must be 0"),
        (((0.3, 0.0), (0.29, 0.03), (0.29, 0.03)), "follows itself"),
        (((0.3, 0.0), (0.29, -0.03), (0.27, -0.06)), "positive z"),
        (((0.3, 0.0), (float("nan"), 0.03), (0.27, 0.06)), "not finite"),
    ],
)
def test_points_that_make_no_line_are_refused(points: Any, words: str) -> None:
    with pytest.raises(InputError, match=words) as error:
        SplineLine(points, 0.02)
    assert error.value.field == "line.points"


def test_shoulder_must_lie_on_the_line() -> None:
    with pytest.raises(InputError, match=r"0.2 m long"):
        SplineLine(circle(41), 0.21)


def test_the_rim_goes_with_the_points_to_another_diameter() -> None:
    """The flange stays as far from the bead's outside as it was drawn."""
    base, smaller = (
        load({"base": "passenger-205-55r16", "parameters": {"outer_diameter": f"{diameter} mm"}})
        for diameter in (631.9, 621.9)
    )
    assert base.flange_centre is not None
    assert smaller.flange_centre is not None
    assert base.flange_centre[0] - smaller.flange_centre[0] == pytest.approx(5e-3)
    s = np.linspace(0.15, base.line.length, 200)
    gaps = [
        np.linalg.norm(section.place(s, section.total_thickness(s)) - section.flange_centre, axis=1).min()
        for section in (base, smaller)
    ]
    assert gaps[1] == pytest.approx(gaps[0], abs=1e-9)
