"""How a wheel moves over the road: speed, slip angle, path curvature."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError

Array = NDArray[np.float64]
#: Largest slip angle, rad, and smallest radius of the path, m.
LARGEST_SLIP_ANGLE = math.radians(45.0)
SMALLEST_RADIUS = 1.0


@dataclass(frozen=True)
class RollingMotion:
    """Steady motion of a wheel, ISO 8855: x forward, y to the left, z up.

    Parameters
    ----------
    slip_angle : rad; positive: the wheel moves to its left, so the side force is to the right (negative).
    turn_slip : curvature of the path, 1/m; positive: a turn to the left.
    speed : m/s, of the wheel's centre.

    Raises
    ------
    InputError : a value outside of what can be meant.

    >>> RollingMotion(0.1).road_per_travel(0.0, 0.0).round(4).tolist()
    [-0.995, -0.0998]
    """

    slip_angle: float = 0.0
    turn_slip: float = 0.0
    speed: float = 1.0

    def __post_init__(self) -> None:
        if not abs(self.slip_angle) <= LARGEST_SLIP_ANGLE:
            raise InputError(
                f"a slip angle of {math.degrees(self.slip_angle):.4g} deg is impossible: -45 to 45 deg",
                field="slip_angle",
            )
        if not abs(self.turn_slip) <= 1 / SMALLEST_RADIUS:
            raise InputError(
                f"a path with a radius of {1 / abs(self.turn_slip):.3g} m is too tight: at least {SMALLEST_RADIUS:g} m",
                field="turn_slip",
            )
        if not self.speed > 0:
            raise InputError(f"the speed must be positive, not {self.speed:g} m/s", field="speed")

    def road_per_travel(self, x: Array | float, y: Array | float) -> Array:
        """(..., 2) movement of the road, m forward and to the left, per metre that the wheel travels."""
        forward = -math.cos(self.slip_angle) + self.turn_slip * np.asarray(y, dtype=float)
        left = -math.sin(self.slip_angle) - self.turn_slip * np.asarray(x, dtype=float)
        return np.stack([forward, left], axis=-1)
