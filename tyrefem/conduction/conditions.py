"""Materials of a body and conditions on its surface: the input of a conduction problem."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeGuard

from tyrefem.errors import InputError

Number = float | int
OfSpaceTime = Number | Callable[..., Any]
OfTemperature = Number | Callable[..., Any]


def is_number(value: object) -> TypeGuard[float]:
    """True for anything that converts to a plain float (numpy scalars and 0-d arrays included)."""
    if isinstance(value, str) or callable(value):
        return False
    try:
        float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return False
    return True


def _check(value: object, field: str, low: float = -math.inf, high: float = math.inf) -> None:
    """Accept a function, or a finite number from `low` to `high`."""
    if callable(value):
        return
    if not is_number(value):
        raise InputError(f"must be a number or a function, not {value!r}", field=field)
    number = float(value)
    if not math.isfinite(number) or not low <= number <= high:
        raise InputError(f"must be finite and from {low:g} to {high:g}, not {number!r}", field=field)


@dataclass(frozen=True)
class Material:
    """Heat conduction in one material, C dT/dt = div(k grad T) + q.

    Parameters
    ----------
    conductivity : k in W/m/K: a number, a pair (k_1, k_2), or a function of T (array, degC) giving either.
    heat_capacity : C = rho c in J/m3/K: a number or a function of T.
    direction : unit vector of k_1 as a function of the points x (2, n) -> (2, n); k_2 acts across it.
        Without it, k_1 acts along the first coordinate (r or x) and k_2 along the second.

    Raises InputError for a number that is not positive.

    >>> Material(conductivity=0.21, heat_capacity=2.09e6).conductivity
    0.21
    """

    conductivity: Any
    heat_capacity: OfTemperature
    direction: Callable[..., Any] | None = None

    def __post_init__(self) -> None:
        k = self.conductivity
        pair = k if isinstance(k, (tuple, list)) else (k,)
        if len(pair) > 2:
            raise InputError("must be one number or a pair", field="conductivity")
        for value in (*pair, self.heat_capacity):
            field = "heat_capacity" if value is self.heat_capacity else "conductivity"
            _check(value, field, low=5e-324)
        if isinstance(k, (tuple, list)) and any(callable(value) for value in pair):
            raise InputError("a pair must hold numbers; give one function returning a pair", field="conductivity")
        if self.direction is not None and not callable(self.direction):
            raise InputError("must be a function of the points (2, n)", field="direction")


@dataclass(frozen=True)
class Film:
    """Newton cooling, q = h (sink - T) into the body.

    Parameters
    ----------
    h : film coefficient, W/m2/K: number or f(x, t), x (2, n) -> (n,) or a scalar.
    sink : temperature, degC: number, f(x, t), or the name of a `Reservoir`.

    >>> Film(h=20.0, sink=25.0).h
    20.0
    """

    h: OfSpaceTime
    sink: OfSpaceTime | str

    def __post_init__(self) -> None:
        _check(self.h, "h", low=0.0)
        if not isinstance(self.sink, str):
            _check(self.sink, "sink")


@dataclass(frozen=True)
class Flux:
    """Heat flux q in W/m2 into the body: number or f(x, t); with ``of_temperature`` f(x, t, T), T (n,) degC at x.

    Its slope in T is not in the linear part: it should be as small as that of a film that the mesh resolves.

    >>> Flux(1700.0).q
    1700.0
    """

    q: OfSpaceTime
    of_temperature: bool = False

    def __post_init__(self) -> None:
        _check(self.q, "q")
        if self.of_temperature and not callable(self.q):
            raise InputError("must be a function f(x, t, T)", field="q")


@dataclass(frozen=True)
class Radiation:
    """Grey radiation, q = eps sigma (Ts^4 - T^4) into the body, absolute temperatures inside.

    Parameters
    ----------
    emissivity : eps, 0 to 1.
    surroundings : degC: number or f(x, t).

    >>> Radiation(emissivity=0.95, surroundings=20.0).emissivity
    0.95
    """

    emissivity: float
    surroundings: OfSpaceTime

    def __post_init__(self) -> None:
        if callable(self.emissivity):
            raise InputError("must be a number", field="emissivity")
        _check(self.emissivity, "emissivity", 0.0, 1.0)
        _check(self.surroundings, "surroundings", low=-273.15)


@dataclass(frozen=True)
class Convection:
    """Newton cooling whose film follows the surface temperature, q = h(T) (sink - T) into the body.

    Parameters
    ----------
    h : film coefficient, W/m2/K: function of the surface temperature T (array, degC), h > 0, h (T - sink) growing.
    sink : temperature, degC.

    >>> round(float(Convection(h=lambda T: 1.3 * abs(T - 20.0) ** 0.25 + 1e-9, sink=20.0).h(36.0)), 3)
    2.6
    """

    h: Callable[..., Any]
    sink: float

    def __post_init__(self) -> None:
        if not callable(self.h):
            raise InputError("must be a function of the surface temperature; a Film takes a number", field="h")
        if callable(self.sink):
            raise InputError("must be a number", field="sink")
        _check(self.sink, "sink", low=-273.15)


@dataclass(frozen=True)
class Fixed:
    """Prescribed temperature in degC: number or f(x, t).

    >>> Fixed(100.0).temperature
    100.0
    """

    temperature: OfSpaceTime

    def __post_init__(self) -> None:
        _check(self.temperature, "temperature")


@dataclass(frozen=True)
class Reservoir:
    """A lumped body with one temperature Tg (contained air, rim).

    C dTg/dt = sum over films naming it of the integral of h (T - Tg) dA + sum_j G_j (T_j - Tg) + power

    Parameters
    ----------
    heat_capacity : C in J/K: number or f(Tg); 0 makes it massless (always in equilibrium).
    initial : degC; default: the body's mean initial temperature.
    exchanges : pairs (conductance W/K, other): number or f(t); other is a reservoir's name, a temperature
        in degC or f(t).
    power : W, number or f(t).

    >>> Reservoir(heat_capacity=50.0, exchanges=((2.0, 25.0),)).exchanges
    ((2.0, 25.0),)
    """

    heat_capacity: OfTemperature
    initial: float | None = None
    exchanges: Sequence[tuple[Any, Any]] = ()
    power: OfSpaceTime = 0.0

    def __post_init__(self) -> None:
        _check(self.heat_capacity, "heat_capacity", low=0.0)
        _check(self.power, "power")
        if self.initial is not None:
            _check(self.initial, "initial")
        for pair in self.exchanges:
            if not isinstance(pair, (tuple, list)) or len(pair) != 2:
                raise InputError(f"must be pairs (conductance, other), not {pair!r:.60}", field="exchanges")
            conductance, other = pair
            _check(conductance, "exchanges", low=0.0)
            if not isinstance(other, str):
                _check(other, "exchanges")


Condition = Film | Flux | Radiation | Convection | Fixed
