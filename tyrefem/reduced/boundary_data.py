"""What acts on reduced variants from outside, at one time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class BoundaryData:
    """What acts from outside at a time: films (B, n_exchanges), their sinks, powers into reservoirs (B, n_reservoirs),
    and all given heat (B, n)."""

    time: float
    films: Array
    sinks: Array
    powers: Array
    constant: Array
