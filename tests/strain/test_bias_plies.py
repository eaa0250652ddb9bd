"""Plane stiffness of bias plies (Clark & Dodge 1980, appendix C)."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tyrefem.errors import InputError
from tyrefem.mechanics.arc_geometry import BiasPlies

G = 2.31e6


def plies(degrees, poisson_term=0.75):
    return BiasPlies(G, np.radians(degrees), 0.26, poisson_term)


def test_at_45_degrees_both_moduli_are_four_shear_moduli():
    """C3, C4 with tan a = cot a = 1: E = 4 G (1 - 1 + 1)."""
    r = np.array([0.26])
    assert plies(45).meridional(r) == pytest.approx(4 * G)
    assert plies(45).circumferential(r) == pytest.approx(4 * G)


@settings(deadline=None, max_examples=50)
@given(st.floats(5, 85))
def test_meridian_and_circumference_change_places_with_the_complement(degrees):
    r = np.array([0.26])
    assert plies(degrees).meridional(r) == pytest.approx(plies(90 - degrees).circumferential(r), rel=1e-9)


@settings(deadline=None, max_examples=50)
@given(st.floats(5, 85))
def test_inextensible_cords_tie_hoop_to_meridian(degrees):
    """c_a = 0: reciprocity then gives nu_theta_phi = cot^2 a, the strain ratio of a net that cannot stretch (C2)."""
    r = np.array([0.26])
    assert plies(degrees, 0.0).poisson(r) == pytest.approx(np.tan(np.radians(degrees)) ** -2, rel=1e-9)
    assert plies(degrees, 1.0).poisson(r) == pytest.approx(0.0)


def test_the_lift_law():
    """cos a = (r / r_0) cos a_0: the cords turn towards the meridian on the way to the bead."""
    r = np.linspace(0.16, 0.26, 5)
    angle = plies(35).angle(r)
    assert np.cos(angle) == pytest.approx(r / 0.26 * np.cos(np.radians(35)))
    assert np.all(np.diff(angle) < 0)
    assert plies(35).cot2(r) == pytest.approx(1 / np.tan(angle) ** 2)


def test_cords_cannot_reach_beyond_their_length():
    with pytest.raises(InputError, match=r"the cords cannot reach r = 330\.0 mm"):
        plies(35).angle(np.array([0.33]))
