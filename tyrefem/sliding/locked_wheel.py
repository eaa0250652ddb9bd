"""A locked wheel on asphalt: rise of the contact, and friction that stops growing where rubber decomposes.

Roberts states that for a car skidding faster than 50 km/h the rise in the contact "can be in excess of 200 degC" and
that decomposition limits friction (after Ettles, 1986). He prints none of the inputs: every number here is an estimate.
"""

from __future__ import annotations

from dataclasses import dataclass

from tyrefem.sliding.rise import MEAN_OF_EXIT, exit_rise_of_stress, largest_friction
from tyrefem.sliding.solid import ASPHALT, Solid, not_negative, positive


@dataclass(frozen=True)
class LockedWheel:
    """One footprint that slides without rolling; all heat goes into the road, as after some lengths of sliding.

    Parameters
    ----------
    friction : coefficient of friction before decomposition (estimate).
    pressure : on the rubber that touches, Pa: 220 kPa inflation over a land share of 0.7 (estimate).
    length : footprint length, m (estimate).
    decomposition_rise : T_d above the road, K: 350 degC on a road of 20 degC (estimate).
    road : `ASPHALT`, itself an estimate.

    Raises InputError for a negative friction or a pressure, length or rise that is not positive.

    >>> car = LockedWheel()
    >>> round(car.mean_rise(50 / 3.6)), round(car.friction_at(100 / 3.6), 2)
    (216, 0.58)
    """

    friction: float = 0.8
    pressure: float = 300e3
    length: float = 0.15
    decomposition_rise: float = 330.0
    road: Solid = ASPHALT

    def __post_init__(self) -> None:
        not_negative(friction=self.friction)
        positive(pressure=self.pressure, length=self.length, decomposition_rise=self.decomposition_rise)

    def uncapped_exit_rise(self, speed: float) -> float:
        """Rise at the exit edge if friction stayed what it is (12), K; speed in m/s."""
        return exit_rise_of_stress(self.friction * self.pressure, speed, self.length, self.road)

    def friction_at(self, speed: float) -> float:
        """Coefficient of friction at a speed in m/s: the given one, or less where equation 13 allows less."""
        if self.uncapped_exit_rise(speed) <= self.decomposition_rise:
            return self.friction
        force = largest_friction(self.decomposition_rise, speed, self.length, 1.0, self.road)
        return force / (self.pressure * self.length)

    def exit_rise(self, speed: float) -> float:
        """Rise at the exit edge, K, at most the decomposition's."""
        return min(self.uncapped_exit_rise(speed), self.decomposition_rise)

    def mean_rise(self, speed: float) -> float:
        """Mean rise over the contact, K: two thirds of that at the exit edge."""
        return MEAN_OF_EXIT * self.exit_rise(speed)

    def speed_of_exit_rise(self, rise: float) -> float:
        """Speed in m/s at which the exit edge would reach a rise with the given friction, from (12)."""
        positive(rise=rise, friction=self.friction)
        return (rise / self.uncapped_exit_rise(1.0)) ** 2

    def decomposition_speed(self) -> float:
        """Speed in m/s above which decomposition limits friction."""
        return self.speed_of_exit_rise(self.decomposition_rise)


#: What the estimates may be at most and at least; nothing in them was fitted to the 200 K.
MILD = LockedWheel(friction=0.6, pressure=200e3, length=0.10)
SEVERE = LockedWheel(friction=1.0, pressure=400e3, length=0.20)
