"""The road: flat or a drum, with its plane tilted by camber."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Road:
    """A flat road, or the outside of a drum whose axis is parallel to the road and perpendicular to the travel.

    Coordinates are (x forward, y down, z along the wheel's axis) from the wheel's centre; the road's top is at
    ``distance`` along its normal (0, cos camber, sin camber).

    Parameters
    ----------
    drum_diameter : m; infinite for a flat road.
    camber : rad; positive: the side z > 0 moves down.

    >>> gap, _ = Road().gaps(np.array([[0.0], [0.28], [0.0]]), distance=0.30)
    >>> round(float(gap[0]), 6)
    0.02
    """

    drum_diameter: float = math.inf
    camber: float = 0.0

    def __post_init__(self) -> None:
        if not self.drum_diameter > 0:
            raise InputError(
                "the diameter of the drum must be positive; infinite is a flat road", field="drum_diameter"
            )
        if not abs(self.camber) < 0.6:
            most = math.degrees(0.6)
            raise InputError(
                f"must be between -{most:.1f} and {most:.1f} deg, not {math.degrees(self.camber):.4g} deg",
                field="camber",
            )

    def in_road_axes(self, points: Array) -> Array:
        """(3, ...) points with y along the road's normal."""
        cos, sin = math.cos(self.camber), math.sin(self.camber)
        x, y, z = points
        return np.stack([x, cos * y + sin * z, cos * z - sin * y])

    def lowest(self, nodes: Array) -> float:
        """Reach of the free tyre (nodes (2, n) in (r, z)) towards the road, m."""
        r, z = nodes
        return float(self.in_road_axes(np.stack([np.zeros_like(r), r, z]))[1].max())

    def half_angle(self, radius: float, deflection: float) -> float:
        """Angle, rad, from the middle of the contact to where a rigid circle of this radius would leave the road.

        acos(1 - D / (R (1 + R / R_drum))), for small deflections D over R; at most 120 deg.
        """
        around = 1.0 / (1.0 + 2 * radius / self.drum_diameter)
        return math.acos(max(1 - deflection * around / radius, -0.5))

    def gaps(self, points: Array, distance: float) -> tuple[Array, Array]:
        """Gaps of points (3, ...), m, and unit vectors (3, ...) from them into the road."""
        x, y, _ = self.in_road_axes(points)
        if math.isinf(self.drum_diameter):
            gap, along, down = distance - y, np.zeros_like(y), np.ones_like(y)
        else:
            radius = self.drum_diameter / 2
            below = distance - y
            depth = radius + below
            length = np.hypot(x, depth)
            # sqrt(x^2 + depth^2) - radius without cancellation for a large drum.
            gap = (x * x + below * (depth + radius)) / (length + radius)
            along, down = -x / length, depth / length
        cos, sin = math.cos(self.camber), math.sin(self.camber)
        return gap, np.stack([along, cos * down, sin * down])

    @property
    def normal(self) -> Array:
        """(3,) direction of the load, into the road."""
        return np.array([0.0, math.cos(self.camber), math.sin(self.camber)])
