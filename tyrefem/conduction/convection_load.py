"""How a film that follows the surface temperature acts on the unknowns."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.conditions import Convection
from tyrefem.conduction.datum import checked
from tyrefem.conduction.loads import STALE, Linear, Load, State
from tyrefem.conduction.operators import Surface
from tyrefem.errors import InputError

Array = NDArray[Any]

#: Half the difference of temperature over which the slope of the heat flux is taken, K.
_BUMP = 0.05


class ConvectionLoad(Load):
    """h(T) (sink - T); its frozen part is the slope of h (T - sink) at the temperature of the last freeze."""

    def __init__(self, surface: Surface, convection: Convection, field: str) -> None:
        self.s, self.h, self.sink, self._field = surface, convection.h, float(convection.sink), f"{field}.h"

    def _loss(self, T: Array, t: float) -> Array:
        h = checked(self.h(T), T.size, self._field, t)
        if np.min(h) < 0:
            raise InputError(f"is negative between {T.min():.6g} and {T.max():.6g} degC", field=self._field)
        return np.asarray(h * (T - self.sink))

    def _slopes(self, t: float, y: State) -> Array:
        """Quadrature values of -dq/dT; never negative, which would feed the body."""
        T = self.s.trace @ y.u[self.s.dofs]
        slopes = (self._loss(T + _BUMP, t) - self._loss(T - _BUMP, t)) / (2 * _BUMP)
        return np.asarray(np.maximum(slopes, 0.0))

    def freeze(self, t: float, y: State, linear: Linear) -> None:
        self.h0 = self._slopes(t, y)
        weighted = self.s.weight * self.h0
        where, value = self.s.exchange(weighted)
        np.add.at(linear.S, where, value)
        self.row = self.s.trace_t @ weighted

    def stale(self, t: float, y: State) -> bool:
        # The largest film decides: near the sink's temperature the slope of natural convection is steep but small.
        now = self._slopes(t, y)
        return bool(np.max(np.abs(now - self.h0)) > STALE * max(np.max(now), np.max(self.h0)))

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        T = self.s.trace @ y.u[self.s.dofs]
        load = self.s.trace_t @ (self.s.weight * (self.h0 * T - self._loss(T, t)))
        G[self.s.dofs] += load
        return float(load.sum())

    def linear_power(self, y: State) -> float:
        return float(-self.row @ y.u[self.s.dofs])
