"""Additional states with a rate, dz/dt = rate(t, z, T): wear, water on a tread, temperature of a brake disc.

Like the reservoirs they are unknowns of the system, g = z / scale with C = 1. One step of one method advances
temperatures and states together, so errors of both are controlled and the order is that of the method. Separate steps
for the states (operator splitting) would be of second order at most and need a further error control. The rate may be
nonlinear: the Rosenbrock-W method keeps its order with any approximation of the Jacobian. The Jacobian's diagonal,
by differences, is part of D, so that a fast decay does not shorten the steps.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.conduction.operators import Operators
from tyrefem.conduction.points import located
from tyrefem.conduction.terms import STALE, LinearPart, Load, State
from tyrefem.errors import InputError, nearest

Array = NDArray[Any]

#: Change of a state over its scale for the difference that gives the slope of its rate.
_BUMP = 1e-3
#: Smaller slopes, 1/s, are not in the linear part, as they do not shorten the steps.
_SLOW = 1e-3


@dataclass(frozen=True)
class AddedStates:
    """States of a conduction problem beside its temperatures.

    Parameters
    ----------
    initial : (k,) at the start. scale : (k,) changes of the same importance as 1 K.
    rate : f(t, z, T) -> (k,) per second, z (k,), T `BodyTemperatures`.
    show : called with z (k,) before the evaluation of films, fluxes, sources and exchanges, which may depend on z.
    """

    initial: Array
    scale: Array
    rate: Callable[[float, Array, BodyTemperatures], Array]
    show: Callable[[Array], None]


@dataclass(frozen=True)
class BodyTemperatures:
    """Temperatures of a body and its reservoirs at one time, degC."""

    operators: Operators
    values: Array
    lumped: dict[str, float]

    def surface(self, boundary: str) -> float:
        """Mean over the area of a boundary, degC."""
        s = self.operators.surface(boundary)
        return float(s.row @ self.values[s.dofs]) / s.area

    def region(self, name: str) -> float:
        """Mean over the volume of a region, degC."""
        row = self.operators.mass_row(name)
        return float(row @ self.values) / float(row.sum())

    def at(self, points: ArrayLike) -> Array:
        """Temperatures at points (n_points, 2), degC."""
        return np.asarray(located(self.operators, points).value() @ self.values)

    def reservoir(self, name: str) -> float:
        """Temperature of a reservoir, degC; InputError for an unknown name."""
        if name not in self.lumped:
            raise InputError(f"unknown reservoir '{name}'{nearest(name, self.lumped)}", field="reservoirs")
        return self.lumped[name]


class StateRates(Load):
    """dz/dt = rate(t, z, T) for the unknowns after those of the reservoirs, from ``first`` on."""

    timed = True

    def __init__(self, ops: Operators, states: AddedStates, reservoirs: Sequence[str]) -> None:
        self.ops, self.states, self.names = ops, states, list(reservoirs)
        self.first = len(self.names)
        self.slope0 = np.zeros(states.initial.size)

    def _rate(self, t: float, y: State, shift: float = 0.0) -> Array:
        """Rates of g = z / scale, 1/s."""
        s = self.states
        lumped = {name: float(T) for name, T in zip(self.names, y.g, strict=False)}
        rate = s.rate(t, (y.g[self.first :] + shift) * s.scale, BodyTemperatures(self.ops, y.u, lumped))
        return np.asarray(rate) / s.scale

    def _slopes(self, t: float, y: State) -> Array:
        slopes = (self._rate(t, y, _BUMP) - self._rate(t, y, -_BUMP)) / (2 * _BUMP)
        return np.asarray(np.maximum(-slopes, 0.0))

    def freeze(self, t: float, y: State, linear: LinearPart) -> None:
        self.slope0 = self._slopes(t, y)
        for i, slope in enumerate(self.slope0, self.first):
            linear.add_conductance(float(slope), i)

    def stale(self, t: float, y: State) -> bool:
        now = self._slopes(t, y)
        return bool(np.any(np.abs(now - self.slope0) > STALE * np.maximum(now, self.slope0) + _SLOW))

    def remainder(self, t: float, y: State, G: Array, Gg: Array) -> float:
        Gg[self.first :] += self._rate(t, y) + self.slope0 * y.g[self.first :]
        return 0.0
