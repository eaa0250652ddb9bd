"""A batch of variants on the same modes: matrices, heat sources and boundary data."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.reduced.balance import ReducedBalance, matrices_of
from tyrefem.reduced.boundary_data import BoundaryData
from tyrefem.reduced.budget import HeatFlows
from tyrefem.reduced.model import ReducedModel
from tyrefem.reduced.sampled_source import SampledHeat

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Batch:
    """Variants on the same modes whose drives have the same phases and the same load-case times.

    M y' = -A y + r(t, y), with the films in A frozen. In the eigenvectors of (A, M) the unknowns decouple and decay
    exactly. r holds the heat sources, the given sinks and the change of the films. Within a time window r is a
    polynomial through Lobatto points, iterated (swept) until it no longer changes. The most demanding variant limits
    the window's length.

    Parameters
    ----------
    model : the modes. balances : one per variant, at least one. tolerance : K, of a window; a conservative estimate.
    """

    model: ReducedModel
    balances: Sequence[ReducedBalance]
    tolerance: float = 0.1

    @functools.cached_property
    def heat_flows(self) -> HeatFlows:
        """Heat flows of the batch; all variants have the same zones, films and reservoirs."""
        return HeatFlows(self.balances[0])

    @functools.cached_property
    def heat(self) -> SampledHeat:
        """Heat sources of all variants at the sample nodes."""
        return SampledHeat(self.balances)

    @functools.cached_property
    def matrices(self) -> tuple[Array, Array]:
        """M and K, (B, n, n) each."""
        return matrices_of(self.balances)

    def boundary_data(self, t: float) -> BoundaryData:
        """Films, sinks and powers at a time."""
        pairs = [balance.coefficients(t) for balance in self.balances]
        films, sinks = (np.array(each) for each in zip(*pairs, strict=True))
        powers = np.array([balance.powers(t) for balance in self.balances]).reshape(len(films), -1)
        constant = (films * sinks) @ self.balances[0].loads
        constant[:, self.model.size :] += powers
        return BoundaryData(t, films, sinks, powers, constant)


def steady(balance: ReducedBalance, number: int) -> bool:
    """Are the boundary data constant within a phase?"""
    return balance.tyre.is_steady(number)
