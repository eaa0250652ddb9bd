"""``[friction]`` of a tread's card: coefficient of friction on the road over sliding speed, pressure, temperature."""

from __future__ import annotations

import functools
from abc import abstractmethod
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, Self, get_args

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from tyrefem.cards import Temperature
from tyrefem.errors import InputError
from tyrefem.materials.law_of_card import law_name
from tyrefem.materials.properties import Sourced
from tyrefem.plugins import Kind, Range, Trial, trial
from tyrefem.quantity import Unit

Array = NDArray[np.float64]
Coefficient = Annotated[float, Unit("1", gt=0, le=5)]
#: Sliding speeds below this share of the speed of the peak have the coefficient of standstill.
SLOWEST = 1e-6


class FrictionOnRoad(Sourced):
    """Base of a user's law of friction, the table ``[friction]`` of a tread's card.

    A subclass sets ``law: Literal["name"]``, its numbers as fields with units, and `mu`.
    """

    plugin_kind: ClassVar[Kind]
    #: The law's table as in a file, with which `tyrefem check` tries it; only what has no default.
    example: ClassVar[Mapping[str, Any]] = {}
    if TYPE_CHECKING:
        law: str

    @abstractmethod
    def mu(self, speed: Array, pressure: Array, temperature: Array) -> Array:
        """Coefficient of friction at sliding speeds, m/s, contact pressures, Pa, and temperatures of the tread, degC.

        The arguments may have several shapes; the coefficient has the shape that numpy gives them together.
        """

    @property
    def depends_on_speed(self) -> bool:
        """True if the coefficient may depend on sliding speed or temperature."""
        return True

    @property
    def follows_temperature(self) -> bool:
        """True if the coefficient may depend on the tread's temperature."""
        return True

    @property
    def single(self) -> float | None:
        """The coefficient, if it is the same everywhere; else None."""
        return None

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """None: temperatures do not depend on the table."""
        return ()

    def __call__(self, speed: Array | float, pressure: Array | float, temperature: Array | float) -> Array:
        """`mu` of numbers or arrays, in their common shape."""
        given = np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in (speed, pressure, temperature)))
        return np.broadcast_to(np.asarray(self.mu(*given), dtype=float), given[0].shape)

    def trials(self) -> Iterator[Trial]:
        """The coefficient from rest to fast sliding, of light to heavy contact, cold and hot."""
        allowed = Range("1", 0.0, 5.0)
        speeds, pressures = np.array([0.0, 1e-4, 1e-2, 1.0, 10.0, 60.0]), np.array([1e3, 1e5, 5e5, 5e6])
        for temperature in (-20.0, 25.0, 100.0, 250.0):
            grid = speeds[:, None], pressures[None, :], np.array(temperature)
            words = f"mu(0 to 60 m/s, 1 to 5000 kPa, {temperature:g} degC)"
            yield trial(words, functools.partial(self, *grid), allowed, (6, 4))
        yield trial("mu(1 m/s, 300 kPa, 25 degC)", lambda: self(1.0, 3e5, 25.0), allowed)


class RoadFriction(FrictionOnRoad):
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
    def depends_on_speed(self) -> bool:
        """False for a constant."""
        return self.law != "constant"

    @property
    def single(self) -> float | None:
        """The constant, if it does not fall with the pressure."""
        return self.coefficient if self.law == "constant" and not self.pressure_exponent else None

    def mu(self, speed: Array, pressure: Array, temperature: Array) -> Array:
        """As the call."""
        return self(speed, pressure, temperature)

    @property
    def follows_temperature(self) -> bool:
        """True if mu depends on the tread's temperature."""
        return self.decade is not None

    def __call__(self, speed: Array | float, pressure: Array | float, temperature: Array | float) -> Array:
        """mu at sliding speeds, m/s, contact pressures, Pa, and temperatures of the tread, degC.

        Below a tenth of p_0 mu is that of a tenth of p_0.
        """
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


FRICTION = FrictionOnRoad.plugin_kind = Kind(
    "friction law",
    "friction laws",
    'law: Literal["..."]',
    law_name,
    lambda: dict.fromkeys(get_args(RoadFriction.model_fields["law"].annotation), RoadFriction),
)
