"""The measurement operator: where a thermocouple sits and how it lags."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def lagged(times: Array, temperatures: Array, lag: float) -> Array:
    """Reading of a first-order sensor, lag dy/dt + y = T, that starts in equilibrium.

    Exact for a temperature linear between the times.

    Parameters
    ----------
    times : (n,) s; temperatures : (n,) degC; lag : time constant, s.

    >>> t = np.linspace(0.0, 10.0, 11)
    >>> bool(abs(lagged(t, 2.0 * t, 1.0)[-1] - (20.0 - 2.0 * (1 - np.exp(-10.0)))) < 1e-12)
    True
    """
    if lag <= 0 or len(times) < 2:
        return np.array(temperatures, dtype=float)
    reading = np.empty(len(times))
    reading[0] = temperatures[0]
    steps = np.diff(times)
    slopes = np.diff(temperatures) / steps
    for i, (step, slope) in enumerate(zip(steps, slopes, strict=True)):
        decay = np.exp(-step / lag)
        # Particular solution T - lag * slope, plus what is left of the old offset.
        offset = reading[i] - (temperatures[i] - lag * slope)
        reading[i + 1] = temperatures[i + 1] - lag * slope + offset * decay
    return reading
