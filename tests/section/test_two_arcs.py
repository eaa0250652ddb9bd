"""The two arcs of the NASA report's appendix A."""

from __future__ import annotations

import numpy as np
import pytest

from tyrefem.errors import InputError
from tyrefem.geometry import TwoArcs, load

pytestmark = pytest.mark.fast

INCH = 0.0254
# Tables H1 and H2: YS of the inner nodes and R of each row, crown to bead [in].
INNER_YS = {
    "nasa-22x5.5-8pr": [0.30, 0.88, 1.50, 2.00, 2.64, 3.18, 3.70, 4.20, 4.70, 5.14, 5.74],
    "nasa-22x5.5-12pr": [0.30, 0.88, 1.50, 2.06, 2.64, 3.18, 3.70, 4.20, 4.70, 5.14, 5.74],
}
R = {
    "nasa-22x5.5-8pr": [10.3, 10.2, 10.08, 9.78, 9.38, 8.90, 8.35, 7.90, 7.48, 7.12, 6.55],
    "nasa-22x5.5-12pr": [10.6, 10.5, 10.3, 9.99, 9.58, 9.12, 8.65, 8.09, 7.56, 7.10, 6.55],
}


@pytest.mark.parametrize("name", R)
def test_line_passes_through_the_printed_radii(name: str) -> None:
    # The fit behind the card leaves 1.1 mm rms; the report prints R to 0.01-0.1 in.
    r = load(name).line.position(np.array(INNER_YS[name]) * INCH)[:, 0]
    assert np.sqrt(np.mean((r - np.array(R[name]) * INCH) ** 2)) < 1.25e-3


@pytest.mark.parametrize(
    ("name", "y_m", "R_c", "R_1"),
    [("nasa-22x5.5-8pr", 10.337, 3.482, 1.961), ("nasa-22x5.5-12pr", 10.653, 2.897, 2.789)],
)
def test_appendix_a_holds_on_the_shipped_sections(name: str, y_m: float, R_c: float, R_1: float) -> None:
    line = load(name).line
    assert isinstance(line, TwoArcs)
    assert line.crown_midline_radius == pytest.approx(y_m * INCH, rel=1e-12)
    assert line.crown_radius == pytest.approx(R_c * INCH, rel=1e-12)
    (x_c, y_c), (x_B, y_B) = line.shoulder, line.bead
    assert x_c == pytest.approx(0.75 * 2.75 * INCH, rel=1e-12)
    drop = line.crown_midline_radius - y_c
    assert (x_c**2 + drop**2) / (2 * drop) == pytest.approx(R_c * INCH, rel=1e-9)  # A1
    assert line.shoulder_s == pytest.approx(R_c * INCH * np.arcsin(x_c / (R_c * INCH)), rel=1e-12)  # A2, A3
    chord = np.hypot(x_c - x_B, y_c - y_B)  # A4
    S_L = 5.82 * INCH - line.shoulder_s
    assert chord / 2 == pytest.approx(R_1 * INCH * np.sin(S_L / (2 * R_1 * INCH)), rel=1e-9)  # A5


def test_arcs_are_tangent_and_of_unit_speed() -> None:
    line = load("nasa-22x5.5-8pr").line
    s = np.linspace(-line.length, line.length, 4001)
    steps = np.linalg.norm(np.diff(line.position(s), axis=0), axis=1)
    # A chord falls short of its arc by (ds)^3 kappa^2 / 24, 7e-13 m here.
    assert np.allclose(steps, np.diff(s), atol=2e-12)
    at = line.shoulder_s
    assert np.allclose(line.normal(at * (1 - 1e-13)), line.normal(at * (1 + 1e-13)), atol=1e-11)
    assert line.curvature(at * 0.99) == pytest.approx(1 / line.crown_radius)
    assert line.curvature(-at * 1.01) == pytest.approx(1 / line.sidewall_radius)


def test_normal_is_perpendicular_and_curvature_is_its_turning() -> None:
    line = load("nasa-22x5.5-12pr").line
    s = np.array([-0.12, -0.03, 0.02, 0.07, 0.14])
    ds = 1e-6
    tangent = (line.position(s + ds) - line.position(s - ds)) / (2 * ds)
    turning = (line.normal(s + ds) - line.normal(s - ds)) / (2 * ds)
    assert np.allclose((tangent * line.normal(s)).sum(axis=1), 0, atol=1e-9)
    assert np.allclose((turning * tangent).sum(axis=1), line.curvature(s), rtol=1e-6)


def test_nearest_is_exact_to_a_nanometre() -> None:
    for name in R:
        line = load(name).line
        rng = np.random.default_rng(7)
        s = rng.uniform(-line.length, line.length, 2000)
        y = rng.uniform(-0.02, 0.03, 2000)
        points = line.position(s) + y[:, None] * line.normal(s)
        s_found, y_found = line.nearest(points)
        assert np.abs(s_found - s).max() < 1e-12
        assert np.abs(y_found - y).max() < 1e-12


@pytest.mark.parametrize(
    ("numbers", "field", "words"),
    [
        ((0.3, 0.05, 0.1, 0.06, 0.2), "parameters.crown_radius", "outside the crown arc"),
        ((0.3, 0.1, 0.02, 0.06, 0.2), "parameters.sidewall_radius", "closes on itself"),
        ((0.3, 0.1, 0.1, 0.06, 0.05), "parameters.meridian_length", "exceed the crown arc"),
    ],
)
def test_impossible_arcs_name_the_parameter(numbers: tuple[float, ...], field: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as error:
        TwoArcs(*numbers)
    assert error.value.field == field
