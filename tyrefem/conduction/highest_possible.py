"""The highest temperature that a body can have: the maximum principle, over a phase without jumps of its data."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.balance import HeatBalance
from tyrefem.conduction.sources import SourceLoad
from tyrefem.conduction.surface_loads import ConvectionLoad, FilmLoad, FluxLoad, RadiationLoad
from tyrefem.conduction.terms import State

Array = NDArray[Any]


class HighestPossible:
    """Bound of all temperatures since the start of a phase, degC.

        T(x, t) <= max(T(x, start), sinks, given temperatures) + integral of max(q / C) dt

    Where a surface is suddenly cooled, the elements behind it overshoot by up to a fifth (P2) or two fifths (P1) of the
    jump, at every mesh, until heat has crossed them. Such temperatures are above this bound, which is closest then. It
    is infinite where a flux enters.

    Parameters
    ----------
    balance : the heat balance. tolerance : K, error of temperatures in time.
    """

    def __init__(self, balance: HeatBalance, tolerance: float) -> None:
        self.balance, self.tolerance = balance, tolerance
        self.value, self._time, self._rate = math.inf, 0.0, 0.0
        self._sources = [load for load in balance.loads if isinstance(load, SourceLoad)]
        self._fluxes = [load for load in balance.loads if isinstance(load, FluxLoad)]

    def begin(self, t: float, y: State) -> None:
        """Start a phase from a state."""
        self.balance.show(y.g)
        self.value = max(float(y.u.max()), self._sink(t, y)) + self.tolerance
        self._time, self._rate = t, self._heating(t, y.u)
        if math.isinf(self._rate):
            self.value = math.inf

    def advance(self, t: float, y: State) -> None:
        """Take the bound to the end of a step."""
        if math.isinf(self.value):
            return
        self.balance.show(y.g)
        rate = self._heating(t, y.u)
        self.value = max(self.value, self._sink(t, y) + self.tolerance)
        # Within a step the rate may lie above that of both ends.
        self.value = math.inf if math.isinf(rate) else self.value + 1.5 * max(rate, self._rate) * (t - self._time)
        self._time, self._rate = t, rate

    def _sink(self, t: float, y: State) -> float:
        """Highest temperature outside the body, degC."""
        b = self.balance
        highest = float(y.g[: len(b.reservoirs)].max(initial=-math.inf))
        for load in b.loads:
            if isinstance(load, FilmLoad) and load.reservoir is None:
                highest = max(highest, float(np.max(load.sink(t))))
            elif isinstance(load, RadiationLoad):
                highest = max(highest, float(np.max(load.surroundings(t))))
            elif isinstance(load, ConvectionLoad):
                highest = max(highest, load.sink)
        return max(highest, float(b.fixed(t).max(initial=-math.inf)))

    def _heating(self, t: float, u: Array) -> float:
        """Fastest rise by sources without conduction, K/s; infinite if a flux enters."""
        if any(np.max(load.value(t, u), initial=0.0) > 0 for load in self._fluxes):
            return math.inf
        heat = np.zeros(u.size)
        for load in self._sources:
            heat[load.dofs] += load.at_nodes(t, u)
        return max((self._of_region(heat, u, c) for c in self.balance.capacities.values()), default=0.0)

    @staticmethod
    def _of_region(heat: Array, u: Array, capacity: Any) -> float:
        most = float(heat[capacity.dofs].max(initial=0.0))
        if most <= 0.0:
            return 0.0
        c = float(capacity.c) if capacity.constant else float(np.min(capacity.values(u[capacity.dofs])))
        return most / c
