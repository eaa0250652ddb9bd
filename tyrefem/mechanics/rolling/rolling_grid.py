"""Points of the rolling tread that may touch the road: angles times points of the whole tread."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.mechanics.footprint.elements import COMPONENTS
from tyrefem.mechanics.footprint.road import Road
from tyrefem.mechanics.rolling.contact_body import NOWHERE
from tyrefem.mechanics.rolling.loaded_compliance import LoadedCompliance
from tyrefem.mechanics.rolling.points_on_wheel import PointsOnWheel
from tyrefem.mechanics.rolling.pressed_shape import PressedShape
from tyrefem.mechanics.rolling.tread_influence import TreadInfluence

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
#: Largest angle, rad, by which a pressed shape turns.
LARGEST_TURN = 0.2
#: Angles beyond the contact that may touch, on each side, of a new grid; and at most, of a grid that is kept.
ANGLES_BEYOND, MOST_BEYOND = 3, 6


@dataclass(frozen=True, eq=False)
class RollingGrid(Brief):
    """Angles j D, j = first .. last, D = pi/harmonics, times the m points of the tread; point k = (angle, point).

    Axes (x forward, y down, z left) are the wheel's. Material runs in at the front (positive angles), so a point's
    material was at the next larger angle a step before. The largest angle cannot touch.

    ``shape``: the pressed tyre from which forces move the points; None: the inflated tyre. ``turn``: angle by which it
    has turned back round the wheel, rad.
    """

    influence: TreadInfluence
    road: Road
    harmonics: int
    first: int
    last: int
    shape: PressedShape | None = None
    turn: float = 0.0
    #: What does not depend on ``turn``, handed on by `turned`.
    _kept: dict[str, Any] = field(default_factory=dict, init=False, repr=False)

    @property
    def step(self) -> float:
        """D, rad."""
        return math.pi / self.harmonics

    @functools.cached_property
    def angles(self) -> Array:
        """(n_angles,), rad."""
        return np.asarray(self.step * np.arange(self.first, self.last + 1), dtype=float)

    @functools.cached_property
    def kernel(self) -> Array:
        """`TreadInfluence.kernel` of these angles."""
        return self.influence.kernel(self.harmonics, len(self.angles))

    @property
    def n_points(self) -> int:
        """Number of points k."""
        return len(self.angles) * len(self.influence.places[0])

    @functools.cached_property
    def upstream(self) -> Indices:
        """(k,) point at which the material was a step before."""
        across = len(self.influence.places[0])
        before = np.arange(self.n_points) + across
        before[-across:] = NOWHERE
        return before

    def around(self, closed: NDArray[np.bool_], beyond: int) -> RollingGrid:
        """The grid itself, if it has ``beyond`` to `MOST_BEYOND` angles on both sides of the points ``closed`` (k,).
        Otherwise a grid with `ANGLES_BEYOND` of them."""
        touching = np.flatnonzero(closed.reshape(len(self.angles), -1).any(axis=1)) + self.first
        low, high = (int(touching.min()), int(touching.max())) if len(touching) else (0, 0)
        margins = low - self.first, self.last - high
        if min(margins) >= beyond and max(margins) <= MOST_BEYOND:
            return self
        furthest = self.harmonics - 1
        first, last = max(low - ANGLES_BEYOND, -furthest), min(high + ANGLES_BEYOND, furthest)
        return RollingGrid(self.influence, self.road, self.harmonics, first, last, self.shape, self.turn)

    def under(self, influence: TreadInfluence) -> RollingGrid:
        """The same points with another compliance."""
        return replace(self, influence=influence)

    def turned(self, more: float) -> RollingGrid:
        """The grid whose pressed shape has turned by ``more`` rad, at most to `LARGEST_TURN` in all."""
        grid = replace(self, turn=min(max(self.turn + more, -LARGEST_TURN), LARGEST_TURN))
        grid._kept.update(self._kept)
        return grid

    def loaded(self, compliance: LoadedCompliance) -> RollingGrid:
        """The same points with another compliance of the pressed shape."""
        assert self.shape is not None
        grid = replace(self, shape=replace(self.shape, loaded=compliance))
        grid._kept.update((name, kept) for name, kept in self._kept.items() if name != "shape")
        return grid

    @functools.cached_property
    def areas(self) -> Array:
        """(k,) tributary area of a point, m2."""
        return np.tile(self.influence.lengths * self.influence.places[0] * self.step, len(self.angles))

    @functools.cached_property
    def wheel_axes(self) -> Array:
        """(n_angles, 3, 3) unit vectors (x, y, z) of the components (r, z, t) at each angle, as rows."""
        sin, cos = np.sin(self.angles), np.cos(self.angles)
        axes = np.zeros((len(sin), COMPONENTS, 3))
        axes[:, 0, 0], axes[:, 0, 1] = sin, cos
        axes[:, 1, 2] = 1.0
        axes[:, 2, 0], axes[:, 2, 1] = cos, -sin
        return axes

    def shape_at(self, shift: float) -> Array:
        """(n_angles, 3, m) what the pressed shape adds along (r, z, t) at angles + ``turn`` + ``shift``, m: d less what
        its own forces move it by D."""
        assert self.shape is not None
        if "shape" not in self._kept:
            from scipy.interpolate import CubicSpline

            beyond = math.ceil(LARGEST_TURN / self.step) + 1
            angles = self.step * np.arange(self.first - beyond, self.last + beyond + 1, dtype=float)
            kernel = self.influence.kernel(self.harmonics, len(angles))
            added = self.shape.offsets(self.influence, self.harmonics, angles, kernel)
            if self.shape.loaded is not None:
                forces = self.shape.forces(self.influence, self.harmonics, angles)
                motions = self.shape.loaded.motions(PointsOnWheel(self.influence, self.harmonics, angles))
                shares = self.shape.loaded.weights @ np.tensordot(forces, motions, axes=3)
                added = added - motions @ shares
            self._kept["shape"] = CubicSpline(angles, added)
        return np.asarray(self._kept["shape"](self.angles + self.turn + shift))

    def points_on_wheel(self, shift: float = 0.0) -> PointsOnWheel:
        """The points at angles + ``turn`` + ``shift``: those of the pressed shape."""
        return PointsOnWheel(self.influence, self.harmonics, self.angles + self.turn + shift)

    def motions_at(self, shift: float) -> Array:
        """(k, 3, n) motions of `LoadedCompliance`, (x, y, z), turned as the shape and by ``shift``, m."""
        assert self.shape is not None
        assert self.shape.loaded is not None
        motions = self.shape.loaded.motions(self.points_on_wheel(shift))
        return np.asarray(np.einsum("jcx,jcpn->jpxn", self.wheel_axes, motions).reshape(self.n_points, COMPONENTS, -1))

    @functools.cached_property
    def motions(self) -> tuple[Array, Array] | None:
        """`motions_at` the turn of the shape, with their weights (n, n); None: none."""
        if self.shape is None or self.shape.loaded is None:
            return None
        return self.motions_at(0.0), self.shape.loaded.weights

    @functools.cached_property
    def shape_forces(self) -> Array | None:
        """(n_angles, 3, m) forces of the pressed shape along (r, z, t), turned as it has, N; None without a shape."""
        if self.shape is None:
            return None
        return self.shape.forces(self.influence, self.harmonics, self.angles + self.turn)

    @functools.cached_property
    def offsets(self) -> Array | float:
        """(k, 3) what the pressed shape adds to the inflated one, (x, y, z), m."""
        return 0.0 if self.shape is None else self.from_wheel(self.shape_at(0.0))

    def shape_rate(self, vectors: Array) -> Array:
        """(k, 3) change in the wheel's axes per radian of ``turn``, m, of what the shape adds to the motion C f under
        forces f (k, 3), (x, y, z): over a step on both sides."""
        rate = self.from_wheel((self.shape_at(self.step) - self.shape_at(-self.step)) / (2 * self.step))
        if self.motions is None:
            return rate
        motions, weights = self.motions
        change = (self.motions_at(self.step) - self.motions_at(-self.step)) / (2 * self.step)
        return np.asarray(rate + change @ (weights @ np.tensordot(vectors, motions, axes=2)))

    def from_wheel(self, components: Array) -> Array:
        """(k, 3) vectors (x, y, z) of components (n_angles, 3, m) along (r, z, t)."""
        return np.asarray(np.einsum("jcx,jcp->jpx", self.wheel_axes, components).reshape(-1, 3))

    def rate(self, vectors: Array) -> Array:
        """(k, 3) change per radian, over a step on both sides, of vectors (k, 3) that vanish beyond the grid, in the
        wheel's axes at each angle."""
        by_angle = vectors.reshape(len(self.angles), -1, 3)
        components = np.einsum("jcx,jpx->jcp", self.wheel_axes, by_angle)
        padded = np.pad(components, ((1, 1), (0, 0), (0, 0)))
        return self.from_wheel((padded[2:] - padded[:-2]) / (2 * self.step))

    @functools.cached_property
    def free_places(self) -> Array:
        """(k, 3) places (x, y, z) of the tread without forces, averaged with the hats by two points, m."""
        r, z = self.influence.places
        flat = np.cos(self.step / math.sqrt(6))
        axes = self.wheel_axes[:, 0]
        places = flat * axes[:, None, :] * r[:, None]
        places[..., 2] = z
        return np.asarray(places.reshape(-1, 3) + self.offsets)

    def gaps(self, moved: Array, distance: float) -> tuple[Array, Array]:
        """Gaps (k,), m, averaged with the hats, and unit vectors (k, 3) into the road, for displacements (k, 3)."""
        r, z = self.influence.places
        free = []
        offset = self.step / math.sqrt(6)
        for shift in (offset, 0.0, -offset):
            angle = np.repeat(self.angles + shift, len(r))
            radius = np.tile(r, len(self.angles))
            free.append(np.stack([radius * np.sin(angle), radius * np.cos(angle), np.tile(z, len(self.angles))]))
        before_centre, centre, after_centre = (self.road.gaps(places, distance)[0] for places in free)
        gaps, normals = self.road.gaps(free[1] + (moved + self.offsets).T, distance)
        return gaps + (before_centre + after_centre) / 2 - centre, normals.T

    def road_axes(self, normals: Array) -> Array:
        """(k, 3, 3) unit vectors (away from the road, along it, left) as rows in (x, y, z), for normals (k, 3)."""
        left = np.array([0.0, -math.sin(self.road.camber), math.cos(self.road.camber)])
        along = np.cross(normals, left)
        return np.stack([-normals, along, np.broadcast_to(left, along.shape)], axis=1)

    def along(self, axes: Array, vectors: Array) -> Array:
        """(k, 3) components of vectors (k, 3) along axes (k, 3, 3)."""
        return np.asarray(np.einsum("kax,kx->ka", axes, vectors))

    def turns(self, axes: Array) -> Array | None:
        """(k, 3, 3) turn from the axes upstream of a point to the axes of the point; None on a flat road."""
        if math.isinf(self.road.drum_diameter):
            return None
        return np.asarray(axes @ axes[self.upstream].transpose(0, 2, 1))

    def middles(self, moved: Array) -> tuple[Array, Array]:
        """Places (k,) forward and to the left of the wheel's centre, m, between a point and the point upstream."""
        x, _, left = self.road.in_road_axes((self.free_places + moved).T)
        return (x + x[self.upstream]) / 2, (left + left[self.upstream]) / 2

    def normal_compliance(self, normals: Array) -> Array:
        """(k, k) displacement of a point along its normal (k, 3) per force along that of another, m/N."""
        across, count = len(self.influence.places[0]), len(self.angles)
        parts = np.einsum("jpx,jcx->jcp", normals.reshape(count, across, 3), self.wheel_axes)
        compliance = np.zeros((count, across, count, across))
        for of in range(count):
            blocks = self.kernel[count - 1 - of : 2 * count - 1 - of]
            for a, b in np.ndindex(COMPONENTS, COMPONENTS):
                compliance[:, :, of] += parts[:, a, :, None] * blocks[:, a, :, b] * parts[of, b]
        normal = compliance.reshape(self.n_points, self.n_points)
        if self.motions is not None:
            into = np.einsum("kx,kxn->kn", normals, self.motions[0])
            normal += into @ self.motions[1] @ into.T
        return normal

    @functools.cached_property
    def level_axes(self) -> Array:
        """(3, 3) `road_axes` of a flat road, the same at all points."""
        return self.road_axes(self.road.normal[None])[0]

    @property
    def level_compliance(self) -> Array:
        """(k, 3, k, 3) displacement of a point along `level_axes` per force along them on another, m/N."""
        if "level" not in self._kept:
            self._kept["level"] = self._level_compliance()
        return np.asarray(self._kept["level"])

    def _level_compliance(self) -> Array:
        across, count = len(self.influence.places[0]), len(self.angles)
        turns = self.level_axes @ self.wheel_axes.transpose(0, 2, 1)
        compliance = np.empty((count, across, COMPONENTS, count, across, COMPONENTS))
        for of in range(count):
            blocks = self.kernel[count - 1 - of : 2 * count - 1 - of]
            turned = turns @ blocks.reshape(count, COMPONENTS, -1)
            turned = turned.reshape(count, COMPONENTS, across, COMPONENTS, across).transpose(0, 2, 1, 4, 3)
            turned = np.ascontiguousarray(turned).reshape(-1, COMPONENTS) @ turns[of].T
            compliance[:, :, :, of] = turned.reshape(count, across, COMPONENTS, across, COMPONENTS)
        return compliance.reshape(self.n_points, COMPONENTS, self.n_points, COMPONENTS)

    def compliance(self, axes: Array) -> Array:
        """(k, 3, k, 3) displacement of a point along its ``axes`` (k, 3, 3) per force along those of another, m/N."""
        across, count = len(self.influence.places[0]), len(self.angles)
        turn = axes.reshape(count, across, 3, 3) @ self.wheel_axes.transpose(0, 2, 1)[:, None]
        compliance = np.empty((count, across, COMPONENTS, count, across, COMPONENTS))
        for to in range(count):
            for of in range(count):
                # (i, j, 3, 3) of a pair of points.
                block = self.kernel[count - 1 + to - of].transpose(1, 3, 0, 2)
                turned = turn[to][:, None] @ block @ turn[of].transpose(0, 2, 1)[None]
                compliance[to, :, :, of] = turned.transpose(0, 2, 1, 3)
        return compliance.reshape(self.n_points, COMPONENTS, self.n_points, COMPONENTS)
