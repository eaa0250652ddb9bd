"""Slip of a wheel on the road: how fast its tread slides while it rolls, is braked, steered or locked."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from tyrefem.errors import InputError

if TYPE_CHECKING:
    from tyrefem.drive import Phase

#: Largest slip angle: beyond it a wheel skids sideways rather than rolls (a judgement).
STEEPEST = math.radians(45.0)
#: Fractions of a phase where its slip is checked.
LOOKS = tuple(i / 50 for i in range(51))
#: A wheel that turns slower than this share of its free speed is locked: what rounding leaves.
ROUNDING = 1e-12


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


def slip_of(phase: Phase, fraction: float) -> Slip:
    """The slip at a fraction of a phase."""
    speed = phase.speed.at(fraction)
    angle = 0.0 if phase.slip_angle is None else phase.slip_angle.at(fraction)
    if phase.slip_speed is not None:
        return Slip(speed, phase.slip_speed.at(fraction), angle)
    ratio = 0.0 if phase.slip_ratio is None else phase.slip_ratio.at(fraction)
    return Slip(speed, ratio * Slip(speed, angle=angle).forward, angle)


def slides(phase: Phase) -> bool:
    """Does the phase have any slip?"""
    ramps = (phase.slip_ratio, phase.slip_speed, phase.slip_angle)
    return any(ramp is not None and (ramp.start != 0 or ramp.end != 0) for ramp in ramps)


def is_locked(phase: Phase) -> bool:
    """Does the wheel stand still in its axle all the time while the vehicle moves?

    A phase that only ends locked, by a ramp, still turns.
    """
    if not slides(phase) or phase.speed.start == phase.speed.end == 0:
        return False
    looks = (slip_of(phase, fraction) for fraction in (0.0, 0.5, 1.0))
    return all(slip.rolling_speed <= ROUNDING * slip.speed for slip in looks)


def check_slip(phase: Phase) -> None:
    """Refuse slip that cannot be; InputError names the key."""
    if phase.slip_ratio is not None and phase.slip_speed is not None:
        raise InputError("give 'slip_ratio' or 'slip_speed', not both", field="slip_speed")
    if phase.slip_angle is not None:
        for angle in (phase.slip_angle.start, phase.slip_angle.end):
            if abs(angle) > STEEPEST * (1 + 1e-9):
                raise InputError(f"{math.degrees(angle):.4g} deg is out of range: -45 to 45 deg", field="slip_angle")
    if not slides(phase):
        return
    if phase.speed.start == phase.speed.end == 0:
        keys = ("slip_ratio", "slip_speed", "slip_angle")
        key = next(key for key in keys if (ramp := getattr(phase, key)) is not None and (ramp.start or ramp.end))
        raise InputError("needs a speed, and the wheel stands still: leave it out or make it 0 here", field=key)
    for slip in (slip_of(phase, fraction) for fraction in LOOKS if phase.slip_speed is not None):
        if abs(slip.longitudinal) > slip.forward * (1 + 1e-9):
            raise InputError(
                f"{slip.longitudinal:.4g} m/s is more than the wheel's forward speed, {slip.forward:.4g} m/s, with "
                "which it would be locked",
                field="slip_speed",
            )
