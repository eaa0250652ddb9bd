"""Factorised matrices M + gamma h S of a step's implicit stages, with the reservoirs as border."""

from __future__ import annotations

from collections import OrderedDict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.balance import HeatBalance

Array = NDArray[Any]

#: The diagonal coefficient of ROS34PW2 (Rang & Angermann 2005), the same in every stage.
GAMMA = 0.435866521508459


class StageMatrix:
    """M + gamma h S with the reservoirs as border, factorised once and condensed to the reservoirs' unknowns."""

    def __init__(self, balance: HeatBalance, h: float) -> None:
        b, free, fixed = balance, balance.fixed.free, balance.fixed.dofs
        gh = GAMMA * h
        data = b.M_data + gh * b.S_data
        self.ordering = b.ops.ordering(free)
        self.factor = self.ordering.factor(data)
        self.all_free = self.ordering.all_free
        self.free, self.fixed = free, fixed
        self.to_fixed = (b.M_fixed + gh * b.S_fixed).T.tocsr()[free] if fixed.size else None
        self.m = b.B.shape[1]
        self.solves = 0
        if self.m:
            border = gh * b.B
            self.border_fixed = border[fixed]
            # Added states exchange no heat with the body: their columns are zero.
            used = np.flatnonzero(border.any(axis=0))
            self.E = np.zeros((free.size, self.m))
            if used.size:
                self.E[:, used] = self.factor.solve(border[np.ix_(free, used)])
            self.solves += used.size
            self.schur = np.diag(b.C) + gh * b.D - border[free].T @ self.E

    def solve(self, ru: Array, rg: Array, k_fixed: Array, ku: Array, kg: Array) -> None:
        """Solve one stage in place: ku (n,), kg (m,), with given rates of the fixed unknowns."""
        right = ru if self.all_free else ru[self.free]
        if self.to_fixed is not None:
            right = right - self.to_fixed @ k_fixed
        if self.m:
            if self.to_fixed is not None:
                rg = rg + self.border_fixed.T @ k_fixed
            kg[:] = np.linalg.solve(self.schur, rg + self.E.T @ right)
        solution = self.factor.solve(right)
        self.solves += 1
        if self.m:
            solution += self.E @ kg
        if self.all_free:
            ku[:] = solution
        else:
            ku[self.free], ku[self.fixed] = solution, k_fixed


class StageMatrices:
    """The latest factorised stage matrices, by step size."""

    def __init__(self, keep: int = 6) -> None:
        self._kept: OrderedDict[tuple[int, float], StageMatrix] = OrderedDict()
        self._keep, self.factorisations, self._past_solves = keep, 0, 0

    def get(self, balance: HeatBalance, h: float) -> StageMatrix:
        """The matrix of a step size, factorised if it is not cached."""
        key = (balance.version, h)
        if key not in self._kept:
            for old in [k for k in self._kept if k[0] != balance.version]:
                self._drop(old)
            self._kept[key] = StageMatrix(balance, h)
            self.factorisations += 1
        self._kept.move_to_end(key)
        while len(self._kept) > self._keep:
            self._drop(next(iter(self._kept)))
        return self._kept[key]

    def _drop(self, key: tuple[int, float]) -> None:
        self._past_solves += self._kept.pop(key).solves

    @property
    def solves(self) -> int:
        """Number of linear solves."""
        return self._past_solves + sum(matrix.solves for matrix in self._kept.values())
