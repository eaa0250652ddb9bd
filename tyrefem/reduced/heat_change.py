"""Effects on the heat of a reduced variant: (base + addends) x factors at the sample nodes."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from tyrefem.effects.effect import Effect
from tyrefem.reduced.balance import ReducedBalance

Array = NDArray[np.float64]
#: Sets of times of which the changes are kept.
KEPT = 4


class HeatChange:
    """Effects on the heat of one variant: q -> (q + addends) x factors, at the sample nodes.

    Effects whose heat does not depend on temperature are evaluated once for the times of a window.
    """

    def __init__(self, balance: ReducedBalance) -> None:
        self.model, self.tyre = balance.model, balance.tyre
        acting = balance.tyre.acting
        addends, factors = acting.at("heat_addend"), acting.at("heat_factor")
        self.addends = [effect for effect in addends if not effect.heat_of_temperature]
        self.warm_addends = [effect for effect in addends if effect.heat_of_temperature]
        self.lasting = [effect for effect in factors if effect.of_place]
        self.timed = [effect for effect in factors if not effect.of_place and not effect.heat_of_temperature]
        self.warm_factors = [effect for effect in factors if not effect.of_place and effect.heat_of_temperature]
        self.acts = bool(addends or factors)
        self._known: dict[tuple[float, ...], tuple[Array | None, Array | None]] = {}

    def apply(self, heat: Array, times: Sequence[float], a: Array) -> None:
        """Change heat (n_samples, k) in place; ``a`` (m, k): the modes at the ``times``."""
        addend, factor = self._of_times(tuple(times))
        T = self.model.at_samples @ a if self.warm_addends or self.warm_factors else heat
        if addend is not None:
            heat += addend
        for effect in self.warm_addends:
            heat += self._columns(effect, "heat_addend", times, T)
        for effect in self.warm_factors:
            heat *= self._columns(effect, "heat_factor", times, T)
        if factor is not None:
            heat *= factor

    def _of_times(self, times: tuple[float, ...]) -> tuple[Array | None, Array | None]:
        """Sum of the addends and product of the factors that do not depend on temperature, (n_samples, k or 1)."""
        if times not in self._known:
            if len(self._known) >= KEPT:
                self._known.clear()
            unused = np.zeros((len(self.model.at_samples), len(times)))
            addends = [self._columns(effect, "heat_addend", times, unused) for effect in self.addends]
            factors = [self._columns(effect, "heat_factor", times, unused) for effect in self.timed]
            factors += [self._of_place] if self.lasting else []
            addend = np.sum(addends, axis=0) if addends else None
            self._known[times] = (addend, np.asarray(math.prod(factors)) if factors else None)
        return self._known[times]

    @functools.cached_property
    def _of_place(self) -> Array:
        """Product of the factors that depend on place only, (n_samples, 1)."""
        start, unused = (self.tyre.drive.starts[0],), np.zeros((len(self.model.at_samples), 1))
        return np.asarray(math.prod(self._columns(effect, "heat_factor", start, unused) for effect in self.lasting))

    def _columns(self, effect: Effect, port: str, times: Sequence[float], T: Array) -> Array:
        """(n_samples, k) values of an effect at one of its ports."""
        values, act = np.empty((len(T), len(times))), getattr(effect, port)
        for zone, part in self.model.sample_slices.items():
            for column, t in enumerate(times):
                values[part, column] = act(self.tyre, zone, self.model.sample_points[zone], t, T[part, column])
        return values
