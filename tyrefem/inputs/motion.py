"""Motion of a wheel over the road: speed, slip and revolutions.

Films, friction, heat sources, effects and reports take their speeds from a `Motion`.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from tyrefem.brief import Brief, PickledFields
from tyrefem.quantity import Ramp

#: Share of its free speed below which a wheel counts as locked: the size of rounding errors.
ROUNDING = 1e-12
#: Number of times whose motion is kept.
REMEMBERED = 512


@dataclass(frozen=True, slots=True)
class Motion:
    """The motion of a wheel at one time. SI units, angle in rad.

    ``speed`` v is that of the wheel's centre over the road, ``slip_angle`` a the angle between it and the wheel's
    plane. ``slip_speed`` is v cos(a) - w r: positive under braking, v cos(a) for a locked wheel, negative under
    driving. ``rolling_radius`` r: NaN if the load case is not known; then revolutions per second are NaN, too.

    >>> turn = Motion(speed=10.0, slip_speed=1.0, slip_angle=math.radians(4.0), rolling_radius=0.28)
    >>> round(turn.rolling_speed, 3), round(turn.sliding_speed, 3), round(turn.revolutions_per_second, 3)
    (8.976, 1.219, 5.102)
    """

    speed: float
    slip_speed: float = 0.0
    slip_angle: float = 0.0
    rolling_radius: float = math.nan

    @property
    def forward_speed(self) -> float:
        """Speed along the wheel's plane, v cos(a), m/s: speed of the road through the footprint."""
        return self.speed * math.cos(self.slip_angle)

    @property
    def rolling_speed(self) -> float:
        """Speed of the tread through the footprint, w r, m/s; v without slip, 0 for a locked wheel."""
        return max(self.forward_speed - self.slip_speed, 0.0)

    @property
    def sliding_speed(self) -> float:
        """Speed of the tread over the road, m/s: slip speed and lateral slip, v sin(a), added as vectors."""
        return math.hypot(self.slip_speed, self.speed * math.sin(self.slip_angle))

    @property
    def slip_ratio(self) -> float:
        """Slip speed over the forward speed: 1 locked, 0 at standstill.

        It is the longitudinal slip of ISO 8855 with the opposite sign: there, braking is negative.
        """
        return self.slip_speed / self.forward_speed if self.forward_speed > 0 else 0.0

    @property
    def revolutions_per_second(self) -> float:
        """w / (2 pi) = rolling speed / (2 pi r), 1/s."""
        return self.rolling_speed / (2 * math.pi * self.rolling_radius)

    @property
    def turns(self) -> bool:
        """True if the wheel turns, except for rounding."""
        return self.rolling_speed > ROUNDING * self.speed


class MovingPhase(Protocol):
    """Data of a phase on the wheel's motion."""

    @property
    def speed(self) -> Ramp:
        """Speed over the road, m/s."""

    @property
    def slip_speed(self) -> Ramp | None:
        """Forward speed minus the tread's speed, m/s."""

    @property
    def slip_ratio(self) -> Ramp | None:
        """Slip speed over forward speed."""

    @property
    def slip_angle(self) -> Ramp | None:
        """Angle between the wheel's motion and its plane, rad."""


class Phases(Protocol):
    """A drive: its phases, and the phase at a time."""

    @property
    def phases(self) -> Sequence[MovingPhase]:
        """The phases in order."""

    def locate(self, time: float) -> tuple[int, float]:
        """Number of the phase at a time, s, and the elapsed fraction of it."""


def motion_in(phase: MovingPhase, fraction: float, rolling_radius: float = math.nan) -> Motion:
    """The motion at a fraction of a phase; ``rolling_radius`` in m."""
    speed = phase.speed.at(fraction)
    angle = 0.0 if phase.slip_angle is None else phase.slip_angle.at(fraction)
    if phase.slip_speed is not None:
        return Motion(speed, phase.slip_speed.at(fraction), angle, rolling_radius)
    forward = Motion(speed, slip_angle=angle).forward_speed
    return Motion(speed, slip_ratio_in(phase, fraction) * forward, angle, rolling_radius)


def slip_ratio_in(phase: MovingPhase, fraction: float) -> float:
    """The slip ratio at a fraction of a phase.

    A stated ratio also holds as the wheel comes to rest, and is the same at every speed to the last bit.
    """
    if phase.slip_speed is not None:
        return motion_in(phase, fraction).slip_ratio
    return 0.0 if phase.slip_ratio is None else phase.slip_ratio.at(fraction)


def motion_at(drive: Phases, time: float, rolling_radius: float = math.nan) -> Motion:
    """The motion at a time (s) of a drive; ``rolling_radius`` in m."""
    number, fraction = drive.locate(time)
    return motion_in(drive.phases[number], fraction, rolling_radius)


@dataclass(frozen=True)
class WheelMotion(Brief, PickledFields):
    """The motion of a loaded wheel as a function of time (s): ``motion(t).revolutions_per_second``.

    ``rolling_radius``: radius of the load case at a time, m.
    """

    drive: Phases
    rolling_radius: Callable[[float], float]

    def _facts(self) -> Mapping[str, Any]:
        return {"phases": len(self.drive.phases), "at the start": self(0.0)}

    def __call__(self, time: float) -> Motion:
        """The motion at a time."""
        return self._known(time)

    @functools.cached_property
    def _known(self) -> Callable[[float], Motion]:
        """The motion, kept for the latest times: all zones, films and effects use the same times."""
        return functools.lru_cache(REMEMBERED)(self._at)

    def _at(self, time: float) -> Motion:
        return motion_at(self.drive, time, self.rolling_radius(time))
