"""What a drive says of a wheel that rolls with friction: slip or torque, slip angle, camber."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from tyrefem.inputs.motion import motion_in, slip_ratio_in

if TYPE_CHECKING:
    from tyrefem.inputs.drive import Phase


@dataclass(frozen=True)
class WheelState:
    """Steady rolling of a wheel, as `tyrefem.mechanics.rolling.roll` takes it. SI.

    Parameters
    ----------
    slip_angle : rad, positive: the wheel moves to its left. camber : rad, positive: it leans to its left (z > 0).
    slip : longitudinal, positive drives; or torque : N m, positive drives; neither: no torque.
    forward : share of the speed that the tread would have without tyre forces, cos(slip angle) (1 + slip).
    tread_temperature : degC, of the coefficient of friction; None: the drive's initial one.
    """

    slip_angle: float = 0.0
    camber: float = 0.0
    slip: float | None = None
    torque: float | None = None
    forward: float = 1.0
    tread_temperature: float | None = None


def wheel_state(phase: Phase, fraction: float) -> WheelState:
    """The wheel at a fraction of a phase. A drive's slip ratio is positive under braking, so ``slip`` is its negative.

    >>> from tyrefem.inputs.drive import Phase
    >>> braked = Phase.check({"speed": "10 m/s", "load": "3 kN", "pressure": "2 bar", "duration": "1 s",
    ...     "slip_ratio": "5 %"})
    >>> wheel_state(braked, 0.0)
    WheelState(slip_angle=0.0, camber=0.0, slip=-0.05, torque=None, forward=0.95, tread_temperature=None)
    """
    motion = motion_in(phase, fraction)
    given = phase.slip_ratio is not None or phase.slip_speed is not None
    ratio = slip_ratio_in(phase, fraction)
    return WheelState(
        motion.slip_angle,
        0.0 if phase.camber is None else phase.camber.at(fraction),
        -ratio if given else None,
        None if phase.torque is None else phase.torque.at(fraction),
        math.cos(motion.slip_angle) * (1 - ratio),
    )
