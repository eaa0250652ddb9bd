"""The meridian of a section through measured points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.brief import PickledFields
from tyrefem.errors import InputError

Array = NDArray[np.float64]
_GAUSS = np.polynomial.legendre.leggauss(8)


@dataclass(frozen=True)
class SplineLine(PickledFields):
    """A smooth meridian through points (r, z) from the crown to the bead.

    A cubic spline over the chord length, symmetric at the crown, reparametrised by its arc length.

    Parameters
    ----------
    points : (r, z) pairs [m], the first on the mid plane (z = 0).
    shoulder_s : end of the tread, along the arc [m].

    Raises
    ------
    InputError : fewer than three points, a repeated point, the first not at z = 0, the shoulder outside the line.

    >>> angles = np.linspace(0.0, 2.0, 41)
    >>> arc = SplineLine(tuple((0.2 + 0.1 * np.cos(a), 0.1 * np.sin(a)) for a in angles), 0.06)
    >>> round(arc.length, 6)
    0.2
    >>> bool(abs(arc.curvature(0.1) - 10.0) < 0.01)
    True
    """

    points: tuple[tuple[float, float], ...]
    shoulder_s: float

    def __post_init__(self) -> None:
        points = np.asarray(self.points, dtype=float)
        if points.ndim != 2 or points.shape[1:] != (2,) or len(points) < 3:
            raise InputError("needs three points (r, z) or more", field="line.points")
        if not np.isfinite(points).all():
            raise InputError("holds a number that is not finite", field="line.points")
        if abs(points[0, 1]) > 1e-9:
            raise InputError("the first point is the crown: its z must be 0", field="line.points")
        if (np.linalg.norm(np.diff(points, axis=0), axis=1) < 1e-9).any():
            raise InputError("a point follows itself", field="line.points")
        if points[1, 1] < 0:
            raise InputError("go towards positive z", field="line.points")
        if not 0 < self.shoulder_s < self.length:
            raise InputError(f"must lie on the line, which is {self.length:g} m long", field="parameters.shoulder_s")

    @cached_property
    def _curve(self) -> Any:
        from scipy.interpolate import CubicSpline

        points = np.asarray(self.points, dtype=float)
        chord = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
        # Symmetry at the crown: r' = 0 and z'' = 0; at the bead the last two pieces are one cubic.
        ends_r: Any = ((1, 0.0), "not-a-knot")
        ends_z: Any = ((2, 0.0), "not-a-knot")
        r = CubicSpline(chord, points[:, 0], bc_type=ends_r)
        z = CubicSpline(chord, points[:, 1], bc_type=ends_z)
        return chord, r, z

    def _speed(self, t: Array) -> Array:
        _, r, z = self._curve
        return np.hypot(r(t, 1), z(t, 1))

    @cached_property
    def _knots(self) -> Array:
        """Arc length at the points."""
        chord = self._curve[0]
        return np.concatenate([[0.0], np.cumsum(self._arc(chord[:-1], chord[1:]))])

    def _arc(self, a: Array, b: Array) -> Array:
        x, w = _GAUSS
        half = (b - a)[:, None] / 2
        return np.asarray((self._speed(a[:, None] + half * (1 + x)) * w * half).sum(axis=1))

    @cached_property
    def length(self) -> float:
        """Meridian length from crown to bead [m]."""
        return float(self._knots[-1])

    @property
    def breaks(self) -> tuple[float, ...]:
        """Stations where the line is less smooth: the points, and the shoulder [m]."""
        return (*self._knots[1:-1].tolist(), self.shoulder_s)

    def _parameter(self, x: Array) -> Array:
        """Chord parameter at arc length x in [0, length], by Newton's method."""
        chord = self._curve[0]
        x = np.clip(x, 0.0, self.length)
        i = np.clip(np.searchsorted(self._knots, x, side="right") - 1, 0, len(chord) - 2)
        start = chord[i]
        share = (x - self._knots[i]) / (self._knots[i + 1] - self._knots[i])
        t = start + share * (chord[i + 1] - start)
        for _ in range(20):
            step = (self._arc(start, t) + self._knots[i] - x) / self._speed(t)
            t = np.clip(t - step, start, chord[i + 1])
            if np.abs(step).max(initial=0.0) < 1e-15:
                break
        return t

    def _frame(self, s: ArrayLike) -> tuple[Array, Array, Array]:
        """Point, unit tangent (towards the bead) and curvature at |s|; beyond the bead a straight line."""
        x = np.abs(np.asarray(s, dtype=float))
        t = self._parameter(x.ravel()).reshape(x.shape)
        _, r, z = self._curve
        d1, d2 = np.stack([r(t, 1), z(t, 1)], axis=-1), np.stack([r(t, 2), z(t, 2)], axis=-1)
        speed = np.linalg.norm(d1, axis=-1)
        tangent = d1 / speed[..., None]
        curvature = (d1[..., 0] * d2[..., 1] - d1[..., 1] * d2[..., 0]) / speed**3
        beyond = np.maximum(x - self.length, 0.0)
        point = np.stack([r(t), z(t)], axis=-1) + beyond[..., None] * tangent
        return point, tangent, np.where(beyond > 0, 0.0, curvature)

    def position(self, s: ArrayLike) -> Array:
        """(r, z) at ``s``, shape (..., 2) [m]; negative ``s`` is the other side."""
        point = self._frame(s)[0]
        point[..., 1] *= np.where(np.asarray(s) < 0, -1.0, 1.0)
        return point

    def normal(self, s: ArrayLike) -> Array:
        """Unit normal (n_r, n_z) outwards at ``s``, shape (..., 2)."""
        tangent = self._frame(s)[1]
        side = np.where(np.asarray(s) < 0, -1.0, 1.0)
        return np.stack([tangent[..., 1], -tangent[..., 0] * side], axis=-1)

    def curvature(self, s: ArrayLike) -> Array:
        """1/radius at ``s`` [1/m], positive where the centre lies inside the tyre."""
        return self._frame(s)[2]

    def nearest(self, points: ArrayLike) -> tuple[Array, Array]:
        """Foot (s, y) of points (..., 2): arc length, and signed distance along the outward normal [m]."""
        points = np.asarray(points, dtype=float)
        side = np.where(points[..., 1] < 0, -1.0, 1.0)
        mirrored = np.stack([points[..., 0], np.abs(points[..., 1])], axis=-1).reshape(-1, 2)
        samples = np.linspace(0.0, self.length, 40 * len(self.points))
        on_line = self._frame(samples)[0]
        gap = ((mirrored[:, None, :] - on_line) ** 2).sum(axis=-1)
        s = samples[np.argmin(gap, axis=1)]
        for _ in range(30):
            point, tangent, curvature = self._frame(s)
            along = ((mirrored - point) * tangent).sum(axis=-1)
            outward = np.stack([tangent[:, 1], -tangent[:, 0]], axis=-1)
            y = ((mirrored - point) * outward).sum(axis=-1)
            step = along / np.maximum(1 + curvature * y, 0.1)
            s = np.maximum(s + step, 0.0)
            if np.abs(step).max(initial=0.0) < 1e-14:
                break
        point, tangent, _ = self._frame(s)
        y = ((mirrored - point) * np.stack([tangent[:, 1], -tangent[:, 0]], axis=-1)).sum(axis=-1)
        return side * s.reshape(side.shape), y.reshape(side.shape)
