"""The two arcs before and after deflection (Clark & Dodge 1980, appendices A, B and F)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from arcs_of import NAMES, at, shipped

from tyrefem.errors import InputError
from tyrefem.geometry.meridian import TwoArcs
from tyrefem.mechanics.arc_geometry import deflected_sidewall, sidewall_arc

pytestmark = pytest.mark.fast


@pytest.fixture(params=NAMES)
def cycle(request):
    return shipped(request.param)


def ends(arc):
    r, x = arc.place(np.array([0.0, 1.0]), np.zeros(2))
    return np.column_stack([x, r])


def test_the_inflated_arc_is_the_section_s_sidewall(cycle):
    line = cycle.section.line
    fraction = np.linspace(0, 1, 7)
    r, x = cycle.inflated.place(fraction, np.zeros(7))
    s = line.shoulder_s + fraction * (line.length - line.shoulder_s)
    assert np.column_stack([r, x]) == pytest.approx(line.position(s), abs=1e-9)


def test_a_sidewall_of_more_than_half_a_turn():
    line = TwoArcs(0.26, 0.09, 0.02, 0.05, 0.05 + 0.02 * 3.6)
    arc = sidewall_arc(line.shoulder, line.bead, 0.02, line.length - line.shoulder_s)
    assert arc.turn == pytest.approx(line.sidewall_angle)
    r, x = arc.place(np.array([0.5]), np.zeros(1))
    middle = line.position([(line.shoulder_s + line.length) / 2])
    assert np.column_stack([r, x]) == pytest.approx(middle, abs=1e-9)


def test_the_deflected_arc_closes_on_shoulder_and_bead(cycle):
    """A: the shoulder moves to (S_c, y_m - D), the bead stays."""
    line = cycle.section.line
    shoulder = (line.shoulder_s, line.crown_midline_radius - cycle.case.deflection)
    assert ends(cycle.deflected) == pytest.approx(np.array([shoulder, line.bead]), abs=1e-9)


def test_the_sidewall_shortens_as_its_tension_falls(cycle):
    """A6 to A9 with C = mean of 1/(h_c E_phi): S_f = S_L (1 + p0 (R_f - R_1) C) and R_f sin(S_f/2R_f) = H_f/2."""
    line, arc = cycle.section.line, cycle.deflected
    s = np.linspace(line.shoulder_s, line.length, 5001)
    stiffness = cycle.section.thickness("carcass", s) * cycle.stiffness.carcass.meridional(line.position(s)[:, 0])
    compliance = np.mean(1 / stiffness)
    length = line.length - line.shoulder_s
    stretched = length * (1 + cycle.case.pressure * (arc.radius - line.sidewall_radius) * compliance)
    assert arc.radius < line.sidewall_radius
    assert arc.radius * arc.turn == pytest.approx(stretched, rel=2e-4)
    chord = np.linalg.norm(np.diff(ends(arc), axis=0))
    assert arc.radius * math.sin(stretched / (2 * arc.radius)) == pytest.approx(chord / 2, rel=1e-3)


def test_more_deflection_is_a_tighter_sidewall(cycle):
    start = cycle.full_flattening
    radii = [at(cycle, start * k).deflected.radius for k in (1.0, 1.2, 1.4, 1.6)]
    assert np.all(np.diff(radii) < 0)
    assert radii[0] < cycle.section.line.sidewall_radius


def test_an_impossible_deflection_is_refused(cycle):
    line = cycle.section.line
    with pytest.raises(InputError, match="impossible for this section"):
        deflected_sidewall(line, line.crown_midline_radius - line.bead[1] + 1e-3, 1e-9, 1e5)


@pytest.mark.parametrize("polar", [-0.6, 0.4, 1.0])
def test_meridional_force_of_an_inflated_torus(cycle, polar):
    """F1, F2: N_phi = p r (1 + b/R)/2 from the axial balance of the strip between the widest point and the cut.

    The pressure pushes the strip along the axis; the membrane is radial at the widest point, so the cut holds it all.
    """
    r, b, p = cycle.inflated.radius, cycle.inflated.centre_radius, cycle.case.pressure
    R = b + r * math.sin(polar)
    angles = np.linspace(0.0, polar, 20001)
    ring = 2 * math.pi * (b + r * np.sin(angles)) * r
    balance = np.trapezoid(p * np.cos(angles) * ring, angles)
    force = balance / (2 * math.pi * R * math.sin(polar))
    assert p / 2 * r * (1 + b / R) == pytest.approx(force, rel=1e-6)
    after = p / 2 * cycle.deflected.radius * (1 + cycle.deflected.centre_radius / R)
    assert cycle._membrane_change(np.array([R]), np.array([R])) == pytest.approx(after - force, rel=1e-4)
