"""Unknowns that are no temperatures and follow a rate: dz/dt = rate(t, z, T). Wear, water on a tread, a brake disc.

They are unknowns of the system like the reservoirs, g = z / scale with C = 1, so that one step of one method takes
temperatures and states together: errors of both are controlled, and the order is that of the method. A step of its
own for the states (operator splitting) would be of second order at most and need an error control of its own. The
rate may be as nonlinear as it likes: the Rosenbrock-W method keeps its order with any approximation of the Jacobian.
Its diagonal, by differences, goes into D, so that a fast decay does not shorten the steps.
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

#: Part of its scale by which a state is moved for the slope of its rate.
_BUMP = 1e-3
#: Slopes below this, 1/s, need no place in the linear part: no step is shorter for them.
_SLOW = 1e-3


@dataclass(frozen=True)
class AddedStates:
    """States of a conduction problem beside its temperatures.

    Parameters
    ----------
    initial : (k,) at the start. scale : (k,) changes that matter as much as 1 K.
    rate : f(t, z, T) -> (k,) per second, z (k,), T `BodyTemperatures`.
    show : called with z (k,) before films, fluxes, sources and exchanges are evaluated, which may depend on it.
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
        """Mean over the area of a boundary."""
        s = self.operators.surface(boundary)
        return float(s.row @ self.values[s.dofs]) / s.area

    def region(self, name: str) -> float:
        """Mean over the volume of a region."""
        row = self.operators.mass_row(name)
        return float(row @ self.values) / float(row.sum())

    def at(self, points: ArrayLike) -> Array:
        """At points (n_points, 2)."""
        return np.asarray(located(self.operators, points).value() @ self.values)

    def reservoir(self, name: str) -> float:
        """Of a reservoir; InputError for a name that is none."""
        if name not in self.lumped:
            raise InputError(f"unknown reservoir '{name}'{nearest(name, self.lumped)}", field="reservoirs")
        return self.lumped[name]


class StateRates(Load):
    """dz/dt = rate(t, z, T) at the places ``first``... of the reservoirs' unknowns."""

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
