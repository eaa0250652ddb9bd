"""Node spacing along a line: stations whose gaps follow a wanted size."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from tyrefem.section.section import Section

Array = NDArray[np.float64]
#: A kink of the geometry nearer than this share of the size to another grid line gets none of its own.
KINK_SHARE = 0.25


def knots(section: Section, size: float) -> Array:
    """Stations that need a line of the mesh of ``size`` [m]: all marks, and the kinks not too near to another one."""
    kept = [0.0, *section.marks, section.line.length]
    for s in section.breaks:
        if min(abs(s - other) for other in kept) > KINK_SHARE * size:
            kept.append(s)
    return np.unique(kept)


def graded(start: float, end: float, size: Callable[[Array], Array], least: int = 1) -> Array:
    """Stations from start to end, both included, with local gaps near ``size(s)`` or smaller.

    The number of gaps is the integral of ds/size(s), rounded up; each gap holds an equal share of it.

    >>> graded(0.0, 1.0, lambda s: np.full_like(s, 0.3)).round(9).tolist()
    [0.0, 0.25, 0.5, 0.75, 1.0]
    """
    s = np.linspace(start, end, 400)
    density = 1 / size(s)
    count = np.concatenate([[0.0], np.cumsum((density[1:] + density[:-1]) / 2 * np.diff(s))])
    gaps = max(least, int(np.ceil(count[-1] - 1e-6)))
    stations = np.interp(np.linspace(0.0, count[-1], gaps + 1), count, s)
    stations[0], stations[-1] = start, end
    return stations


def rows_needed(thickness: float, first: float, largest: float) -> int:
    """Fewest rows through ``thickness`` that begin at ``first`` and grow geometrically to ``largest`` at most."""
    for rows in range(1, 1000):
        if np.diff(row_fractions(thickness, first, rows)).max() * thickness <= largest * (1 + 1e-9):
            return rows
    return 1000


def row_fractions(thickness: float, first: float, rows: int) -> Array:
    """Row borders, 0 to 1 from the coarse to the fine side, the last row ``first`` thick, the others growing.

    Where ``thickness`` has room for less than ``rows`` rows of ``first``, all rows are equal.

    >>> row_fractions(3.0, 1.0, 3).round(9).tolist()
    [0.0, 0.333333333, 0.666666667, 1.0]
    """
    sizes = _ratio(thickness, first, rows) ** np.arange(rows)[::-1]
    return np.concatenate([[0.0], np.cumsum(sizes) / sizes.sum()])


def _ratio(thickness: float, first: float, rows: int) -> float:
    """Growth q with first (q^rows - 1)/(q - 1) = thickness, at least 1; by bisection."""
    if rows == 1 or thickness <= first * rows:
        return 1.0
    low, high, powers = 1.0, 1.0 + thickness / first, np.arange(rows)
    with np.errstate(over="ignore"):
        for _ in range(80):
            middle = (low + high) / 2
            low, high = (middle, high) if first * (middle**powers).sum() < thickness else (low, middle)
    return (low + high) / 2
