"""Slip of a wheel on the road: how fast its tread slides while it rolls, is braked, steered or locked."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    pass


@dataclass(frozen=True)
class Slip:
    """The motion of a wheel at one time. SI, angle in rad.

    ``speed`` v is that of the wheel's centre over the road, ``angle`` a the one between it and the wheel's plane.
    ``longitudinal`` is v cos(a) - w r: positive under braking, v cos(a) for a locked wheel, negative under driving.
    As a ratio to v cos(a) it is the longitudinal slip of ISO 8855 with the other sign: there braking is negative.

    >>> turn = Slip(10.0, 1.0, math.radians(4.0))
    >>> round(turn.rolling_speed, 3), round(turn.sliding_speed, 3)
    (8.976, 1.219)
    """

    speed: float
    longitudinal: float = 0.0
    angle: float = 0.0

    @property
    def forward(self) -> float:
        """Speed along the wheel's plane, v cos(a): the road's through the footprint, m/s."""
        return self.speed * math.cos(self.angle)

    @property
    def rolling_speed(self) -> float:
        """Speed of the tread through the footprint, w r, m/s; v without slip, 0 for a locked wheel."""
        return max(self.forward - self.longitudinal, 0.0)

    @property
    def sliding_speed(self) -> float:
        """Speed of the tread over the road: longitudinal and lateral slip, v sin(a), added as vectors; m/s."""
        return math.hypot(self.longitudinal, self.speed * math.sin(self.angle))

    @property
    def ratio(self) -> float:
        """Longitudinal slip over the forward speed: 1 locked, 0 at standstill."""
        return self.longitudinal / self.forward if self.forward > 0 else 0.0
