"""Matrices of films and reservoir exchanges on the modes, for a coefficient of 1."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Exchanges(Brief):
    """Matrices of all heat exchanges: first the films of the sides, then the exchanges between reservoirs.

    Parameters
    ----------
    matrices : (n_exchanges, n, n) for 1 W/m2/K, or 1 W/K. loads : (n_exchanges, n) of a given sink.
    rows : (n_exchanges, n) W into the body (or the owner) per kelvin. areas : (n_exchanges,) m2, or 1.
    given : whether the sink is a given temperature.
    """

    matrices: Array
    loads: Array
    rows: Array
    areas: Array
    given: NDArray[np.bool_]


#: (side, reservoir or None) of every film; (owner, other reservoir or None) of every exchange; names of reservoirs.
Layout = tuple[tuple[tuple[str, str | None], ...], tuple[tuple[str, str | None], ...], tuple[str, ...]]


def exchanges(layout: Layout, size: int, surfaces: Mapping[str, tuple[Array, Array, float]]) -> Exchanges:
    """The exchange matrices of a layout on ``size`` modes; ``surfaces``: as `ReducedModel.surfaces`."""
    films, conductances, names = layout
    m, n, count = size, size + len(names), len(films) + len(conductances)
    result = Exchanges(
        np.zeros((count, n, n)), np.zeros((count, n)), np.zeros((count, n)), np.ones(count), np.zeros(count, bool)
    )
    for j, (side, sink) in enumerate(films):
        R, r, area = surfaces[side]
        result.matrices[j, :m, :m], result.rows[j, :m], result.areas[j] = R, -r, area
        if sink is None:
            result.loads[j, :m], result.given[j] = r, True
        else:
            g = m + names.index(sink)
            result.matrices[j, :m, g] = result.matrices[j, g, :m] = -r
            result.matrices[j, g, g] = result.rows[j, g] = area
    for j, (owner, other) in enumerate(conductances, len(films)):
        i = m + names.index(owner)
        result.matrices[j, i, i], result.rows[j, i] = 1.0, -1.0
        if other is None:
            result.loads[j, i], result.given[j] = 1.0, True
        else:
            k = m + names.index(other)
            result.matrices[j, i, k] = result.matrices[j, k, i] = -1.0
            result.matrices[j, k, k] = result.rows[j, k] = 1.0
    return result
