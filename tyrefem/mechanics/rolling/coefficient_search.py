"""Coefficients of friction that agree with the sliding speeds and pressures which they bring about."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.mechanics.rolling.rolled import RolledTyre
from tyrefem.mechanics.rolling.rolling_grid import RollingGrid

Array = NDArray[np.float64]
#: mu of sliding speed (m/s) and contact pressure (Pa), arrays alike.
FrictionLaw = Callable[[Array, Array], Array]
#: Share of the way to the law's coefficient: factor after a change of direction; the most, over the number of rounds.
BACK, MOST = 0.6, 8.0


@dataclass(eq=False)
class CoefficientSearch:
    """Coefficients of a law from round to round.

    Where mu rises with the sliding speed, a point may stick and slip in turn. So each point goes a share of the way to
    its law's coefficient. The share falls where the direction changes, and with the number of rounds.

    Parameters
    ----------
    friction : a coefficient, or its law.
    """

    friction: float | FrictionLaw
    _share: Array = field(default_factory=lambda: np.zeros(0), init=False)
    _round: int = field(default=0, init=False)
    _last: Array = field(default_factory=lambda: np.zeros(0), init=False)

    def of(self, grid: RollingGrid, last: RolledTyre | None) -> Array:
        """(k,) coefficients after a ``last`` round on the same grid; None: the first round.

        Raises
        ------
        InputError : a law that gives a negative coefficient, no number, or a wrong number of them.
        """
        if not callable(self.friction):
            return np.full(grid.n_points, float(self.friction))
        if last is None:
            zero = np.zeros(grid.n_points)
            self._share, self._round = np.zeros(0), 0
            return self._law(zero, zero)
        law = self._law(last.sliding_speed.ravel(), last.pressure.ravel())
        change = law - last.friction
        if len(self._share) != grid.n_points:
            self._share, self._round = np.ones(grid.n_points), 0
        else:
            turned = change * self._last < 0
            self._round += 1
            self._share = np.minimum(self._share * np.where(turned, BACK, 1.0), MOST / self._round)
        self._last = change
        return np.asarray(last.friction + self._share * change)

    def _law(self, speed: Array, pressure: Array) -> Array:
        """(k,) coefficients of the law, which may give a single number for all."""
        assert callable(self.friction)
        values = np.asarray(self.friction(speed, pressure), dtype=float)
        if values.shape not in ((), speed.shape) or not (values >= 0).all():
            raise InputError(
                "the law must give a coefficient of at least 0 for every sliding speed and pressure", field="friction"
            )
        return np.full(speed.shape, values)
