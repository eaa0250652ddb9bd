"""The two circular arcs before and after deflection (Clark & Dodge 1980, appendices A and B).

Plane stiffness of bias plies with inextensible cords (Clark & Dodge 1980, appendix C).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class DeflectedArcs:
    """Sidewall arc of the inflated (i) and of the deflected (f) section. Lengths in m.

    ``centre`` is the arc's centre (axial x, radius b), ``radius`` its radius R, ``start`` the polar angle of the
    shoulder seen from the centre (from the outward axial direction towards the tread), ``turn`` the angle from
    shoulder to bead.
    """

    radius: float
    centre_axial: float
    centre_radius: float
    start: float
    turn: float

    def place(self, fraction: Array, offset: Array) -> tuple[Array, Array]:
        """(r, x) of points at a fraction of the arc from the shoulder, ``offset`` outwards of it."""
        polar = self.start - np.asarray(fraction) * self.turn
        reach = self.radius + np.asarray(offset)
        return self.centre_radius + reach * np.sin(polar), self.centre_axial + reach * np.cos(polar)


def through(shoulder: tuple[float, float], bead: tuple[float, float], radius: float) -> DeflectedArcs:
    """The arc of a given radius from shoulder to bead that bulges outwards; points are (axial x, radius y)."""
    (xs, ys), (xb, yb) = shoulder, bead
    half = math.hypot(xs - xb, ys - yb) / 2
    height = math.sqrt(max(radius * radius - half * half, 0.0))
    along = ((xs - xb) / (2 * half), (ys - yb) / (2 * half))
    centre = ((xs + xb) / 2 - height * along[1], (ys + yb) / 2 + height * along[0])
    start = math.atan2(ys - centre[1], xs - centre[0])
    return DeflectedArcs(radius, centre[0], centre[1], start, 2 * math.asin(min(half / radius, 1.0)))


def deflected_sidewall(line: Any, deflection: float, membrane_compliance: float, pressure: float) -> DeflectedArcs:
    """The sidewall arc under a deflection D that flattens the whole crown.

    The shoulder moves to (S_c, y_m - D); the arc shortens with its tension,
    S_f = S_L (1 + p0 (R_f - R_1) C),  R_f sin(S_f / (2 R_f)) = H_f / 2,  R_f < R_1                   (A6-A9)

    Parameters
    ----------
    line : the two-arc reference line.
    deflection, pressure : D in m, p0 gauge in Pa.
    membrane_compliance : C = mean of 1/(h_c E_phi) over the sidewall, m/N.

    Raises
    ------
    InputError : no such arc exists: the deflection is impossible for this section.
    """
    (_, yc), bead = line.shoulder, line.bead
    length = line.length - line.shoulder_s
    shoulder = (line.shoulder_s, line.crown_midline_radius - deflection)
    chord = math.hypot(shoulder[0] - bead[0], shoulder[1] - bead[1])

    def stretched(radius: float) -> float:
        return length * (1 + pressure * (radius - line.sidewall_radius) * membrane_compliance)

    def gap(radius: float) -> float:
        return 2 * radius * math.sin(stretched(radius) / (2 * radius)) - chord

    # From R_1 downwards the arc gets shorter; the first sign change is the root.
    radii = np.linspace(line.sidewall_radius, 0.25 * line.sidewall_radius, 400)
    lengths = length * (1 + pressure * (radii - line.sidewall_radius) * membrane_compliance)
    possible = (lengths > 0) & (lengths < 2 * math.pi * radii)
    radii, lengths = radii[possible], lengths[possible]
    values = 2 * radii * np.sin(lengths / (2 * radii)) - chord
    closes = np.flatnonzero((values[:-1] >= 0) & (values[1:] <= 0))
    if len(closes) and shoulder[1] > bead[1]:
        radius = _root(gap, float(radii[closes[0] + 1]), float(radii[closes[0]]))
        return sidewall_arc(shoulder, bead, radius, stretched(radius))
    raise InputError(
        f"a deflection of {deflection * 1e3:.1f} mm is impossible for this section: with the crown flattened the "
        f"shoulder is {(shoulder[1] - bead[1]) * 1e3:.1f} mm above the bead, and no sidewall arc of "
        f"{length * 1e3:.1f} mm tighter than {line.sidewall_radius * 1e3:.1f} mm joins them "
        f"(it must flatten the crown, more than {(line.crown_midline_radius - yc) * 1e3:.1f} mm, and not bottom)",
        field="deflection",
    )


def sidewall_arc(
    shoulder: tuple[float, float], bead: tuple[float, float], radius: float, length: float
) -> DeflectedArcs:
    """The arc of given radius and length (m) from shoulder to bead; the length selects one of two arcs."""
    return (through if length / radius < math.pi else _major)(shoulder, bead, radius)


def _major(shoulder: tuple[float, float], bead: tuple[float, float], radius: float) -> DeflectedArcs:
    """The arc that turns by more than half a circle: its centre lies beyond the chord."""
    minor = through(shoulder, bead, radius)
    cx, cy = (shoulder[0] + bead[0]) - minor.centre_axial, (shoulder[1] + bead[1]) - minor.centre_radius
    start = math.atan2(shoulder[1] - cy, shoulder[0] - cx)
    return DeflectedArcs(radius, cx, cy, start, 2 * math.pi - minor.turn)


def _root(gap: Callable[[float], float], lower: float, upper: float) -> float:
    """Root of a function that is negative at ``lower`` and positive at ``upper``, to rounding (the Illinois method).

    Written here because the import of scipy.optimize takes a tenth of a short run.

    >>> _root(lambda x: x**2 - 2.0, 0.0, 2.0) == 2.0**0.5
    True
    """
    below, above, before, side = gap(lower), gap(upper), math.inf, 0
    while True:
        x = (lower * above - upper * below) / (above - below)
        if not lower < x < upper:
            x = (lower + upper) / 2
            if x in (lower, upper):
                return x
        if abs(x - before) <= math.ulp(x):
            return x
        value, before = gap(x), x
        if value == 0:
            return x
        # The value at an end that does not change for two steps is halved, so that this end changes too.
        if value < 0:
            lower, below = x, value
            above, side = (above / 2 if side < 0 else above), -1
        else:
            upper, above = x, value
            below, side = (below / 2 if side > 0 else below), 1


@dataclass(frozen=True)
class BiasPlies:
    """Cords at ``crown_angle`` (rad, to the circumference) at radius ``crown_radius`` (m), in rubber of shear
    modulus ``shear_modulus`` (Pa).

    cos(alpha) = (r / r_0) cos(alpha_0)   (the lift law)
    E_phi = 4 G (1 - tan^2 a + tan^4 a),  E_theta = 4 G (1 - cot^2 a + cot^4 a)          (C3, C4)

    ``poisson_term`` is c_a = 1 - nu_pt nu_tp (eq 7a): 0 for inextensible cords, 0.75 to 1 isotropic.
    """

    shear_modulus: float
    crown_angle: float
    crown_radius: float
    poisson_term: float

    def angle(self, radius: Array) -> Array:
        """Cord angle to the circumference, rad, at radii from the axis, m."""
        cosine = np.asarray(radius) / self.crown_radius * np.cos(self.crown_angle)
        if np.any(cosine >= 1.0):
            largest = float(np.max(radius))
            raise InputError(
                f"the cords cannot reach r = {largest * 1e3:.1f} mm: with {np.degrees(self.crown_angle):.1f} deg at "
                f"the crown (r = {self.crown_radius * 1e3:.1f} mm) the lift law has no angle there",
                field="section.cord_angle",
            )
        return np.asarray(np.arccos(cosine))

    def meridional(self, radius: Array) -> Array:
        """E_phi, Pa."""
        t2 = np.tan(self.angle(radius)) ** 2
        return np.asarray(4 * self.shear_modulus * (1 - t2 + t2 * t2))

    def circumferential(self, radius: Array) -> Array:
        """E_theta, Pa."""
        c2 = np.tan(self.angle(radius)) ** -2
        return np.asarray(4 * self.shear_modulus * (1 - c2 + c2 * c2))

    def poisson(self, radius: Array) -> Array:
        """nu_theta_phi = sqrt((1 - c_a) E_theta / E_phi), which reciprocity (c_b = 0) requires."""
        ratio = self.circumferential(radius) / self.meridional(radius)
        return np.asarray(np.sqrt((1 - self.poisson_term) * ratio))

    def cot2(self, radius: Array) -> Array:
        """cot^2 of the cord angle."""
        return np.asarray(np.tan(self.angle(radius)) ** -2)
