"""One passage through a sliding contact: tread and road cross it at their own speeds and share its heat."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from tyrefem.errors import InputError
from tyrefem.sliding.rise import MEAN_OF_EXIT
from tyrefem.sliding.solid import not_negative, positive


@dataclass(frozen=True)
class Passage:
    """Tread and road in a footprint of length L, the one passing at w r, the other at v cos(a). SI units.

    Each is warmed as a half-space for the time it takes, L/(its speed). Heat divides so that both surfaces agree: as
    b_t sqrt(w r) to b_r sqrt(v). That is the effusivities (5) at small slip, and all of it into the road for a wheel
    that has been locked for longer than L/v (1, 3). ``tread``, ``road`` are effusivities b, J/m2/K/s^0.5.

    Sources: Carslaw & Jaeger, *Conduction of heat in solids* (1959); Roberts, eqs 1, 3, 5; the division by speeds is
    Jaeger's of moving sources (1942). Raises InputError for what is not positive (``rolling_speed`` may be 0).

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
        """Share of the friction heat that the tread takes, b_t sqrt(w r)/(b_t sqrt(w r) + b_r sqrt(v))."""
        tread, road = self._weights
        return tread / (tread + road)

    def meeting(self, tread: Any, road: float) -> Any:
        """Temperature of the contact without friction, degC, from those of tread (array or number) and road before."""
        share = self.tread_share
        return share * tread + (1.0 - share) * road

    def exit_rise(self, flux: Any) -> Any:
        """Rise at the exit edge over `meeting`, 2 F_0 sqrt(L/pi)/(b_t sqrt(w r) + b_r sqrt(v)), K, from W/m2."""
        return flux * 2.0 * math.sqrt(self.length / math.pi) / sum(self._weights)

    def largest_flux(self, decomposition: float, tread: Any, road: float) -> Any:
        """F_0 with which the exit edge reaches a temperature (13), W/m2; temperatures in degC, negative if passed."""
        return (decomposition - self.meeting(tread, road)) / self.exit_rise(1.0)

    def road_age(self, since: float) -> tuple[float, float]:
        """(oldest, mean over exit) of the road under a wheel locked ``since`` s: s, and mean rise over exit rise.

        Road has been under it for L/v, or since it locked; its mean rise is 2/3 of that at the exit edge, all of it
        where every point has been there for the same time.
        """
        if not since >= 0:
            raise InputError(f"must be at least 0 s, not {since!r}", field="since")
        crossed = min(self.road_speed * since / self.length, 1.0)
        return crossed * self.length / self.road_speed, 1.0 - (1.0 - MEAN_OF_EXIT) * crossed

    def skid_film(self, since: float) -> float:
        """Film between a locked wheel's tread and the road that passes under it, W/m2/K: F_0 over the mean rise (1, 3).

        (b_r sqrt(pi)/2)/sqrt(t) at first, with which heat divides as in (5); (3/4) b_r sqrt(pi v/L) from t = L/v on.
        The first hundredth of L/v counts as one time.

        >>> round(Passage(660.0, 1730.0, 0.2, 0.0, 10.0).skid_film(1.0))
        16262
        """
        age, mean = self.road_age(max(since, 0.01 * self.length / self.road_speed))
        return self.road * math.sqrt(math.pi / age) / (2.0 * mean)
