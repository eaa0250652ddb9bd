"""Heat exchange of reservoirs with each other and with their surroundings."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.conditions import Reservoir
from tyrefem.conduction.datum import Datum
from tyrefem.conduction.terms import STALE, LinearPart, Load, State
from tyrefem.errors import InputError, nearest

Array = NDArray[Any]


class ExchangeLoad(Load):
    """Conductance (W/K) between a reservoir and another one or a given temperature. Its slot: W into the reservoir."""

    def __init__(self, owner: int, conductance: Any, other: Any, field: str, partner: int | None) -> None:
        nowhere = np.zeros((2, 1))
        self.owner, self.partner = owner, partner
        self.conductance = Datum(conductance, nowhere, field, low=0.0)
        self.other = Datum(0.0 if partner is not None else other, nowhere, field)
        self.timed = not (self.conductance.constant and self.other.constant)
        self.static = not self.timed

    def freeze(self, t: float, y: State, linear: LinearPart) -> None:
        self.h0 = self.conductance(t)
        linear.add_conductance(self.h0, self.owner, self.partner)

    def clear_cache(self) -> None:
        self.conductance.clear_cache()
        self.other.clear_cache()

    def stale(self, t: float, y: State) -> bool:
        h = self.conductance(t)
        return abs(h - self.h0) > STALE * max(h, self.h0)

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        h, j = self.conductance(t), self.partner
        if j is not None:
            power = (h - self.h0) * (y.g[j] - y.g[self.owner])
            Gg[j] -= power
        else:
            power = h * self.other(t) - (h - self.h0) * y.g[self.owner]
        Gg[self.owner] += power
        return float(power)

    def linear_power(self, y: State) -> float:
        partner_temperature = 0.0 if self.partner is None else y.g[self.partner]
        return float(self.h0 * (partner_temperature - y.g[self.owner]))


class PowerLoad(Load):
    """Power supplied to a reservoir, W."""

    def __init__(self, owner: int, power: Any, field: str) -> None:
        self.owner, self.power = owner, Datum(power, np.zeros((2, 1)), field)
        self.static = self.power.constant
        self.timed = not self.static

    def clear_cache(self) -> None:
        self.power.clear_cache()

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        power = self.power(t)
        Gg[self.owner] += power
        return float(power)


def time_only(function: Callable[..., Any]) -> Callable[..., Any]:
    """f(t) as f(x, t), for reservoirs, which have no place."""
    return lambda x, t: function(t)


def reservoir_loads(index: int, name: str, reservoir: Reservoir, numbers: dict[str, int]) -> list[tuple[int, Load]]:
    """The exchanges of one reservoir with their index, and its power with index -1."""
    loads: list[tuple[int, Load]] = []
    for i, (conductance, other) in enumerate(reservoir.exchanges):
        field = f"reservoirs.{name}.exchanges[{i}]"
        partner = None
        if isinstance(other, str):
            if other not in numbers or other == name:
                raise InputError(f"unknown reservoir {other!r}{nearest(other, numbers)}", field=field)
            partner = numbers[other]
        g, T = (time_only(v) if callable(v) else v for v in (conductance, other))
        loads.append((i, ExchangeLoad(index, g, T, field, partner)))
    power = time_only(reservoir.power) if callable(reservoir.power) else reservoir.power
    if callable(power) or float(power) != 0.0:
        loads.append((-1, PowerLoad(index, power, f"reservoirs.{name}.power")))
    return loads
