"""``[friction]`` of a tread's card: coefficient of friction on the road over sliding speed, pressure, temperature."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from tyrefem.cards import Temperature
from tyrefem.errors import InputError
from tyrefem.materials.properties import Sourced
from tyrefem.quantity import Unit

Array = NDArray[np.float64]
Coefficient = Annotated[float, Unit("1", gt=0, le=5)]
#: Sliding speeds below this share of the speed of the peak have the coefficient of standstill.
SLOWEST = 1e-6


class RoadFriction(Sourced):
    """Coulomb friction of a compound on a road. ``constant``, or a peak over the sliding speed (Savkoor 1965):

    mu = (mu_0 + (mu_m - mu_0) exp(-(h log10(v a/v_m))^2)) (p_0/p)^k,   a = 10^(-(temperature - at)/decade).

    A warmer tread is one that slides more slowly (Grosch 1963). On a rough road mu falls with the pressure.

    Parameters
    ----------
    coefficient : mu_m, or the constant.
    standstill : mu_0, at no sliding, and at very fast sliding. peak_speed : v_m, m/s. width : h.
    at : degC, of the peak speed. decade : K that move the peak by a factor of ten in speed.
    pressure_exponent : k. pressure : p_0, Pa.

    Raises
    ------
    InputError : a number out of range; numbers of the peak with a constant law; a peak below the standstill.

    >>> tread = RoadFriction.check({"law": "savkoor", "coefficient": 1.2, "standstill": 0.8, "peak_speed": "1 m/s",
    ...     "width": 0.5, "at": "30 degC", "decade": "20 K", "source": "estimate: example"})
    >>> tread(np.array([0.0, 1.0, 10.0]), 3e5, 30.0).round(3).tolist()
    [0.8, 1.2, 1.112]
    """

    law: Literal["constant", "savkoor"] = "constant"
    coefficient: Coefficient
    standstill: Coefficient | None = None
    peak_speed: Annotated[float, Unit("m/s", gt=0, le=100)] | None = None
    width: Annotated[float, Unit("1", gt=0, le=10)] | None = None
    at: Temperature | None = None
    decade: Annotated[float, Unit("delta_degC", gt=0, le=1000)] | None = None
    pressure_exponent: Annotated[float, Unit("1", ge=0, le=1)] = 0.0
    pressure: Annotated[float, Unit("Pa", gt=0, le=1e8)] = 3e5

    @model_validator(mode="after")
    def _whole(self) -> Self:
        names = ("standstill", "peak_speed", "width", "at", "decade")
        for name in names:
            given = getattr(self, name) is not None
            if self.law == "constant" and given:
                raise InputError("is only for the law 'savkoor'", field=name)
            if self.law == "savkoor" and not given and name not in ("at", "decade"):
                raise InputError("is missing: the law 'savkoor' needs it", field=name)
        if (self.at is None) != (self.decade is None):
            raise InputError("'at' and 'decade' belong together", field="at" if self.at is None else "decade")
        if self.standstill is not None and self.standstill > self.coefficient:
            raise InputError(
                f"must be at most the coefficient of the peak ({self.coefficient:g}), not {self.standstill:g}",
                field="standstill",
            )
        return self

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """None: temperatures do not depend on the table."""
        return ()

    @property
    def follows_temperature(self) -> bool:
        """True if mu depends on the tread's temperature."""
        return self.decade is not None

    def __call__(self, speed: Array | float, pressure: Array | float, temperature: Array | float) -> Array:
        """mu at sliding speeds, m/s, contact pressures, Pa, and temperatures of the tread, degC."""
        pressure = np.maximum(np.asarray(pressure, dtype=float), 0.1 * self.pressure)
        falling = (self.pressure / pressure) ** self.pressure_exponent
        speed = np.asarray(speed, dtype=float)
        if self.law == "constant":
            return np.asarray(self.coefficient * falling * np.ones_like(speed))
        return np.asarray(self._peak(speed, temperature) * falling)

    def _peak(self, speed: Array, temperature: Any) -> Array:
        assert self.peak_speed is not None
        assert self.standstill is not None
        assert self.width is not None
        shift: Any = 0.0
        if self.at is not None and self.decade is not None:
            shift = (np.asarray(temperature, dtype=float) - self.at) / self.decade
        decades = np.log10(np.maximum(speed / self.peak_speed, SLOWEST)) - shift
        peak = np.exp(-((self.width * decades) ** 2))
        peak = np.where(speed > SLOWEST * self.peak_speed, peak, 0.0)
        return np.asarray(self.standstill + (self.coefficient - self.standstill) * peak)
