"""The meridian (reference line) of a section: what every line has, and two circular arcs as in the NASA report."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.brief import PickledFields
from tyrefem.errors import InputError

Array = NDArray[np.float64]


class Line(Protocol):
    """A meridian (r, z) by arc length s, symmetric about the crown; the crown is s = 0, z = 0. Lengths in m.

    Arrays have any leading shape: ``s`` (...), points (..., 2). Negative ``s`` is the other side.
    """

    @property
    def length(self) -> float:
        """From the crown to the bead."""

    @property
    def breaks(self) -> tuple[float, ...]:
        """Stations on the side s > 0 where the line is less smooth, as where the curvature jumps."""

    @property
    def shoulder_s(self) -> float:
        """From the crown to the shoulder."""

    def position(self, s: ArrayLike) -> Array:
        """(r, z), (..., 2); beyond the bead the line continues."""

    def normal(self, s: ArrayLike) -> Array:
        """Unit normal outwards, (..., 2)."""

    def curvature(self, s: ArrayLike) -> Array:
        """1/m, (...), positive where the centre lies inside the tyre."""

    def nearest(self, points: ArrayLike) -> tuple[Array, Array]:
        """Foot (s, y) of points: arc length, and signed distance along the outward normal, (...) each."""


@dataclass(frozen=True)
class TwoArcs(PickledFields):
    """Crown arc and sidewall arc, tangent to each other at the shoulder (NASA report, appendix A).

    R_c = crown_radius, theta_c = asin(x_c/R_c), S_c = R_c theta_c, y_m - y_c = R_c (1 - cos theta_c);   (A1-A3)
    the sidewall arc has the radius R_1 and the length S_L = length - S_c, hence the angle S_L/R_1.   (A4, A5)

    Parameters
    ----------
    crown_midline_radius : y_m, distance of the crown from the wheel's axis [m].
    crown_radius, sidewall_radius : R_c and R_1 [m].
    shoulder_x : x_c, axial distance of the shoulder from the mid plane [m].
    length : meridian length from crown to bead [m].

    Raises
    ------
    InputError : the shoulder lies outside the crown arc, or an arc closes on itself.

    >>> line = TwoArcs(0.2626, 0.0884, 0.0498, 0.0524, 0.1478)
    >>> line.position([0.0, -line.shoulder_s]).round(4).tolist()
    [[0.2626, 0.0], [0.2454, -0.0524]]
    >>> s, y = line.nearest(line.position([0.1]) + 0.01 * line.normal([0.1]))
    >>> bool(abs(s[0] - 0.1) < 1e-12 and abs(y[0] - 0.01) < 1e-12)
    True
    """

    crown_midline_radius: float
    crown_radius: float
    sidewall_radius: float
    shoulder_x: float
    length: float

    def __post_init__(self) -> None:
        if not 0 < self.shoulder_x < self.crown_radius:
            raise InputError(
                f"the shoulder lies outside the crown arc: its distance from the mid plane, {self.shoulder_x:g} m,"
                f" must be less than the crown radius",
                field="parameters.crown_radius",
            )
        if not self.length > self.shoulder_s * (1 + 1e-9):
            raise InputError(
                f"must exceed the crown arc, which is {self.shoulder_s:g} m long",
                field="parameters.meridian_length",
            )
        if not self.sidewall_angle < 2 * np.pi:
            raise InputError(
                f"the sidewall arc closes on itself: {self.length - self.shoulder_s:g} m of it at this radius is a"
                f" turn of {np.degrees(self.sidewall_angle):.4g} deg, at most 360 deg is possible",
                field="parameters.sidewall_radius",
            )

    @cached_property
    def shoulder_angle(self) -> float:
        """theta_c, the angle of the crown arc [rad]."""
        return float(np.arcsin(self.shoulder_x / self.crown_radius))

    @cached_property
    def shoulder_s(self) -> float:
        """S_c, the meridian length from the crown to the shoulder [m]."""
        return self.crown_radius * self.shoulder_angle

    @cached_property
    def sidewall_angle(self) -> float:
        """theta, the angle of the sidewall arc [rad]."""
        return (self.length - self.shoulder_s) / self.sidewall_radius

    @property
    def breaks(self) -> tuple[float, ...]:
        """Stations where the curvature jumps [m]."""
        return (self.shoulder_s,)

    @cached_property
    def shoulder(self) -> tuple[float, float]:
        """(x_c, y_c) of the shoulder in the report's axes: axial distance, radius [m]."""
        r, z = self.position(self.shoulder_s)
        return float(z), float(r)

    @cached_property
    def bead(self) -> tuple[float, float]:
        """(x_B, y_B) of the bead in the report's axes: axial distance, radius [m]."""
        r, z = self.position(self.length)
        return float(z), float(r)

    @cached_property
    def _centres(self) -> tuple[Array, Array]:
        outwards = np.array([np.cos(self.shoulder_angle), np.sin(self.shoulder_angle)])
        crown = np.array([self.crown_midline_radius - self.crown_radius, 0.0])
        return crown, crown + (self.crown_radius - self.sidewall_radius) * outwards

    def _angle(self, s: Array) -> Array:
        x = np.abs(s)
        beyond = self.shoulder_angle + (x - self.shoulder_s) / self.sidewall_radius
        return np.where(x <= self.shoulder_s, x / self.crown_radius, beyond)

    def position(self, s: ArrayLike) -> Array:
        """(r, z) at ``s``, shape (..., 2) [m]; negative ``s`` is the other side; beyond the bead the arc continues."""
        s = np.asarray(s, dtype=float)
        crown, sidewall = self._centres
        on_crown, angle = np.abs(s) <= self.shoulder_s, self._angle(s)
        radius = np.where(on_crown, self.crown_radius, self.sidewall_radius)
        point = np.empty((*s.shape, 2))
        point[..., 0] = np.where(on_crown, crown[0], sidewall[0]) + radius * np.cos(angle)
        point[..., 1] = np.where(on_crown, crown[1], sidewall[1]) + radius * np.sin(angle)
        point[..., 1] *= np.where(s < 0, -1.0, 1.0)
        return point

    @staticmethod
    def _on_arc(centre: Array, radius: float, angle: Array) -> Array:
        """(r, z) on an arc, shape (..., 2) [m]."""
        return np.stack([centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle)], axis=-1)

    def normal(self, s: ArrayLike) -> Array:
        """Unit normal (n_r, n_z) outwards at ``s``, shape (..., 2)."""
        s = np.asarray(s, dtype=float)
        angle, normal = self._angle(s), np.empty((*s.shape, 2))
        normal[..., 0], normal[..., 1] = np.cos(angle), np.sin(angle) * np.where(s < 0, -1.0, 1.0)
        return normal

    def curvature(self, s: ArrayLike) -> Array:
        """1/radius at ``s`` [1/m], positive where the centre lies inside the tyre."""
        x = np.abs(np.asarray(s, dtype=float))
        return np.where(x <= self.shoulder_s, 1 / self.crown_radius, 1 / self.sidewall_radius)

    def nearest(self, points: ArrayLike) -> tuple[Array, Array]:
        """Foot (s, y) of points (..., 2): arc length, and signed distance along the outward normal [m].

        Exact. Points past the bead are projected on the continued arc (``|s| > length``).
        """
        points = np.asarray(points, dtype=float)
        side = np.where(points[..., 1] < 0, -1.0, 1.0)
        mirrored = np.stack([points[..., 0], np.abs(points[..., 1])], axis=-1)
        crown, sidewall = self._centres
        to_crown, to_sidewall = mirrored - crown, mirrored - sidewall
        angle_c = np.arctan2(to_crown[..., 1], to_crown[..., 0])
        middle = self.shoulder_angle + self.sidewall_angle / 2
        angle_s = np.arctan2(to_sidewall[..., 1], to_sidewall[..., 0])
        angle_s = middle + np.remainder(angle_s - middle + np.pi, 2 * np.pi) - np.pi
        s_c = self.crown_radius * angle_c
        s_s = self.shoulder_s + self.sidewall_radius * (angle_s - self.shoulder_angle)
        foot_c = self._on_arc(crown, self.crown_radius, np.clip(s_c, 0, self.shoulder_s) / self.crown_radius)
        beyond = np.clip(s_s, self.shoulder_s, self.length) - self.shoulder_s
        foot_s = self._on_arc(sidewall, self.sidewall_radius, self.shoulder_angle + beyond / self.sidewall_radius)
        gap_c, gap_s = _length(mirrored - foot_c), _length(mirrored - foot_s)
        on_crown = (gap_c <= gap_s) & (s_c <= self.shoulder_s * (1 + 1e-12))
        y_c, y_s = _length(to_crown) - self.crown_radius, _length(to_sidewall) - self.sidewall_radius
        return side * np.where(on_crown, s_c, s_s), np.where(on_crown, y_c, y_s)


def _length(v: Array) -> Array:
    """Lengths of vectors (..., 2)."""
    return np.asarray(np.sqrt(v[..., 0] ** 2 + v[..., 1] ** 2))
