"""A batch of variants on the same modes: matrices, heat sources and boundary data."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.reduced.balance import ReducedBalance, matrices_of
from tyrefem.reduced.boundary_data import BoundaryData
from tyrefem.reduced.budget import HeatFlows, by_shape
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
        return HeatFlows(self.balances)

    @functools.cached_property
    def models(self) -> list[ReducedModel]:
        """The model of every variant: the same modes, on its shape of the section."""
        return [balance.model for balance in self.balances]

    @functools.cached_property
    def films(self) -> Array:
        """Exchange matrices for a coefficient of 1, (1 or B, n_exchanges, n, n): 1 if all shapes are the same."""
        return by_shape(self.balances, lambda balance: balance.stack)

    @functools.cached_property
    def loads(self) -> Array:
        """Load vectors of the given sinks, (1 or B, n_exchanges, n)."""
        return by_shape(self.balances, lambda balance: balance.loads)

    @functools.cached_property
    def source_load(self) -> Array:
        """Heat into the modes per heat source at the sample nodes, (1 or B, m, n_samples)."""
        return by_shape(self.balances, lambda balance: balance.model.load)

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
        # Similar variants share most functions of time: each is evaluated once.
        known: dict[int, float] = {}
        pairs = [balance.coefficients(t, known) for balance in self.balances]
        films, sinks = (np.array(each) for each in zip(*pairs, strict=True))
        powers = np.array([balance.powers(t) for balance in self.balances]).reshape(len(films), -1)
        constant = np.einsum(
            "bj,bjn->bn", films * sinks, np.broadcast_to(self.loads, (len(films), *self.loads.shape[1:]))
        )
        constant[:, self.model.size :] += powers
        return BoundaryData(t, films, sinks, powers, constant)


def steady(balance: ReducedBalance, number: int) -> bool:
    """Are the boundary data constant within a phase?"""
    return balance.alike.is_steady(number)
