"""Boundary data of a batch of reduced variants at a time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class BoundaryData:
    """Films (B, n_exchanges), their sinks, powers into reservoirs (B, n_reservoirs) and given heat (B, n) at a time."""

    time: float
    films: Array
    sinks: Array
    powers: Array
    constant: Array
