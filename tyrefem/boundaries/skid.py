"""One passage through a sliding contact: tread and road pass it at different speeds and share its heat.

Also a locked wheel on asphalt: rise of the contact, and the limit of friction where rubber decomposes.

Roberts states that for a car skidding faster than 50 km/h the rise in the contact "can be in excess of 200 degC" and
that decomposition limits friction (after Ettles, 1986). He prints none of the inputs: every number here is an estimate.

The surface of a half-space that rubs on a passing road is a closed form to compare with a section's finite elements.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.boundaries.friction import ASPHALT, Solid, not_negative, positive
from tyrefem.boundaries.friction_rise import MEAN_OF_EXIT, exit_rise_of_stress, largest_friction
from tyrefem.errors import InputError


@dataclass(frozen=True)
class Passage:
    """Tread and road in a footprint of length L: the tread passes at w r, the road at v cos(a). SI units.

    Each is heated as a half-space during its passage, L/(its speed). The heat divides as b_t sqrt(w r) to b_r sqrt(v),
    which gives equal surface temperatures. At small slip this is the ratio of effusivities (5). For a wheel locked for
    longer than L/v all heat enters the road (1, 3). ``tread``, ``road`` are effusivities b, J/m2/K/s^0.5.

    Sources: Carslaw & Jaeger, *Conduction of heat in solids* (1959); Roberts, eqs 1, 3, 5; the division by speeds is
    from Jaeger's moving sources (1942). Raises InputError for numbers that are not positive (``rolling_speed`` may be
    0).

    >>> rolling = Passage(660.0, 1730.0, 0.2, 10.0, 10.0)
    >>> round(rolling.tread_share, 3), round(rolling.exit_rise(1e6), 1)
    (0.276, 66.8)
    >>> Passage(660.0, 1730.0, 0.2, 0.0, 10.0).tread_share
    0.0
    """

    tread: float
    road: float
    length: float
    rolling_speed: float
    road_speed: float

    def __post_init__(self) -> None:
        positive(tread=self.tread, road=self.road, length=self.length, road_speed=self.road_speed)
        not_negative(rolling_speed=self.rolling_speed)

    @property
    def _weights(self) -> tuple[float, float]:
        return self.tread * math.sqrt(self.rolling_speed), self.road * math.sqrt(self.road_speed)

    @property
    def tread_share(self) -> float:
        """Share of the friction heat that enters the tread, b_t sqrt(w r)/(b_t sqrt(w r) + b_r sqrt(v))."""
        tread, road = self._weights
        return tread / (tread + road)

    def frictionless_temperature(self, tread: Any, road: float) -> Any:
        """Contact temperature without friction, degC, from those of tread (array or number) and road before contact."""
        share = self.tread_share
        return share * tread + (1.0 - share) * road

    def exit_rise(self, flux: Any) -> Any:
        """Rise at the exit edge over `frictionless_temperature`, K, for a flux F_0 in W/m2.

        2 F_0 sqrt(L/pi)/(b_t sqrt(w r) + b_r sqrt(v))
        """
        return flux * 2.0 * math.sqrt(self.length / math.pi) / sum(self._weights)

    def largest_flux(self, decomposition: float, tread: Any, road: float) -> Any:
        """F_0 with which the exit edge reaches a temperature (13), W/m2; temperatures in degC; negative if exceeded."""
        return (decomposition - self.frictionless_temperature(tread, road)) / self.exit_rise(1.0)

    def road_age(self, since: float) -> tuple[float, float]:
        """(oldest, mean over exit) of the road under a wheel locked ``since`` s: s, and mean rise over exit rise.

        The road has been in contact for L/v, or since the wheel locked. Its mean rise is 2/3 of that at the exit edge;
        it is equal to it if all points have been in contact for the same time.
        """
        if not since >= 0:
            raise InputError(f"must be at least 0 s, not {since!r}", field="since")
        crossed = min(self.road_speed * since / self.length, 1.0)
        return crossed * self.length / self.road_speed, 1.0 - (1.0 - MEAN_OF_EXIT) * crossed

    def skid_film(self, since: float) -> float:
        """Film between a locked wheel's tread and the road passing under it, W/m2/K: F_0 over the mean rise (1, 3).

        At first (b_r sqrt(pi)/2)/sqrt(t), with which heat divides as in (5); from t = L/v on (3/4) b_r sqrt(pi v/L).
        In the first hundredth of L/v the film is constant.

        >>> round(Passage(660.0, 1730.0, 0.2, 0.0, 10.0).skid_film(1.0))
        16262
        """
        age, mean = self.road_age(max(since, 0.01 * self.length / self.road_speed))
        return self.road * math.sqrt(math.pi / age) / (2.0 * mean)


@dataclass(frozen=True)
class LockedWheel:
    """A footprint that slides without rolling; all heat enters the road, as after some lengths of sliding.

    Parameters
    ----------
    friction : coefficient of friction before decomposition (estimate).
    pressure : on the rubber in contact, Pa: 220 kPa inflation over a land share of 0.7 (estimate).
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
        """Rise at the exit edge with constant friction (12), K; speed in m/s."""
        return exit_rise_of_stress(self.friction * self.pressure, speed, self.length, self.road)

    def friction_at(self, speed: float) -> float:
        """Coefficient of friction at a speed in m/s: the given one, or less if equation 13 limits it."""
        if self.uncapped_exit_rise(speed) <= self.decomposition_rise:
            return self.friction
        force = largest_friction(self.decomposition_rise, speed, self.length, 1.0, self.road)
        return force / (self.pressure * self.length)

    def exit_rise(self, speed: float) -> float:
        """Rise at the exit edge, K, limited to that of decomposition."""
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


#: Bounds of the estimates; none was fitted to the 200 K.
MILD = LockedWheel(friction=0.6, pressure=200e3, length=0.10)
SEVERE = LockedWheel(friction=1.0, pressure=400e3, length=0.20)


Array = NDArray[np.float64]


#: Steps of the integration: the error of a rise is 1e-4 (see tests/sliding).
STEPS = 240


def half_space_surface(
    times: Array,
    flux: Callable[[float], float],
    film: Callable[[float], float],
    sink: Callable[[float], float],
    initial: float,
    effusivity: float,
) -> Array:
    """Surface temperature of a half-space at ``times`` (n,) s after a uniform temperature ``initial`` degC.

    T(t) = T_0 + 1/(b sqrt(pi)) times the integral of q(s)/sqrt(t - s) ds, q = F_0 - H (T - T_sink)   (Duhamel)

    solved with q linear between geometrically growing times.

    Parameters
    ----------
    flux, film, sink : F_0 W/m2, H W/m2/K and degC at a time since the start, s. effusivity : b, J/m2/K/s^0.5.

    Returns degC (n,). Raises InputError for an effusivity or a last time that is not positive.

    >>> rise = half_space_surface(np.array([4.0]), lambda t: 1e5, lambda t: 0.0, lambda t: 20.0, 20.0, 660.0)
    >>> round(float(rise[0]), 1), round(20 + 2e5 / 660.0 * math.sqrt(4.0 / math.pi), 1)
    (361.9, 361.9)
    """
    times = np.asarray(times, dtype=float)
    positive(effusivity=effusivity, last_time=float(times.max()))
    last = float(times.max())
    grid = np.unique(np.concatenate([[0.0], np.geomspace(last * 1e-7, last, STEPS), times[times > 0]]))
    surface, heat = np.full(len(grid), float(initial)), np.zeros(len(grid))
    factor = 1.0 / (effusivity * math.sqrt(math.pi))
    for n in range(1, len(grid)):
        weight = factor * _weights(grid[: n + 1])
        t = float(grid[n])
        h, known = film(t), initial + float(weight[:-1] @ heat[:n])
        surface[n] = (known + weight[-1] * (flux(t) + h * sink(t))) / (1.0 + weight[-1] * h)
        heat[n] = flux(t) - h * (surface[n] - sink(t))
    return np.interp(times, grid, surface)


def _weights(grid: Array) -> Array:
    """Integral of q(s)/sqrt(t - s) up to the last time, as weights of q; in the first interval q is constant."""
    left = grid[-1] - grid
    root = np.sqrt(left)
    whole = 2.0 * (root[:-1] - root[1:])
    first_moment = left[:-1] * whole - (2.0 / 3.0) * (left[:-1] * root[:-1] - left[1:] * root[1:])
    end = first_moment / np.diff(grid)
    end[0] = whole[0]
    weights = np.zeros(len(grid))
    weights[1:] = end
    weights[:-1] += whole - end
    return weights
