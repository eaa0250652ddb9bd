"""Many variants on the same modes: their matrices, heat sources, and what acts on them from outside."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.quantity import Ramp
from tyrefem.reduced.balance import ReducedBalance, matrices_of
from tyrefem.reduced.boundary_data import BoundaryData
from tyrefem.reduced.budget import Ledger
from tyrefem.reduced.model import ReducedModel
from tyrefem.reduced.sampled_source import SampledHeat

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Batch:
    """Variants whose drives have the same phases and load-case knots in time, on the same modes.

    M y' = -A y + r(t, y), A of frozen films. In the modes of (A, M) every unknown decays by itself, exactly; r, the
    heat sources, given sinks and what films deviate by, is a polynomial through Lobatto points of a window, found by
    sweeps until it does not change. Windows are as long as the most demanding variant allows.

    Parameters
    ----------
    model : the modes. balances : one per variant, at least one. tolerance : K, of a window, estimated with much room.
    """

    model: ReducedModel
    balances: Sequence[ReducedBalance]
    tolerance: float = 0.1

    @functools.cached_property
    def ledger(self) -> Ledger:
        """Of any variant: they exchange heat in the same places."""
        return Ledger(self.balances[0])

    @functools.cached_property
    def heat(self) -> SampledHeat:
        """Sources of all variants."""
        return SampledHeat(self.balances)

    @functools.cached_property
    def matrices(self) -> tuple[Array, Array]:
        """M, K; (B, n, n) each."""
        return matrices_of(self.balances)

    def outside(self, t: float) -> BoundaryData:
        """What acts from outside at a time."""
        pairs = [balance.coefficients(t) for balance in self.balances]
        films, sinks = (np.array(each) for each in zip(*pairs, strict=True))
        powers = np.array([balance.powers(t) for balance in self.balances]).reshape(len(films), -1)
        constant = (films * sinks) @ self.balances[0].loads
        constant[:, self.model.size :] += powers
        return BoundaryData(t, films, sinks, powers, constant)


def steady(balance: ReducedBalance, number: int) -> bool:
    """Is everything that acts from outside constant within a phase?"""
    tyre = balance.tyre
    phase = tyre.drive.phases[number]
    if not tyre.acting.follows_drive or phase.slides or len(tyre.schedule.knots[number]) > 1:
        return False
    return all(value.constant for _, value in phase if isinstance(value, Ramp))
