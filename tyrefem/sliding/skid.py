"""Surface of a half-space that rubs on a passing road: the closed form beside a section's finite elements."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from tyrefem.sliding.solid import positive

Array = NDArray[np.float64]
#: Steps of the integration: a rise is right to 1e-4 (see tests/sliding).
STEPS = 240


def half_space_surface(
    times: Array,
    flux: Callable[[float], float],
    film: Callable[[float], float],
    sink: Callable[[float], float],
    initial: float,
    effusivity: float,
) -> Array:
    """Surface of a half-space at ``times`` (n,) s after it was at ``initial`` degC everywhere.

    T(t) = T_0 + 1/(b sqrt(pi)) times the integral of q(s)/sqrt(t - s) ds, q = F_0 - H (T - T_sink)   (Duhamel)

    solved with q linear between times that grow geometrically.

    Parameters
    ----------
    flux, film, sink : F_0 W/m2, H W/m2/K and degC at a time since the start, s. effusivity : b, J/m2/K/s^0.5.

    Returns degC (n,). Raises InputError for an effusivity or a last time that is not positive.

    >>> rise = half_space_surface(np.array([4.0]), lambda t: 1e5, lambda t: 0.0, lambda t: 20.0, 20.0, 660.0)
    >>> round(float(rise[0]), 1), round(20 + 2e5 / 660.0 * math.sqrt(4.0 / math.pi), 1)
    (361.9, 361.9)
    """
    times = np.asarray(times, dtype=float)
    positive(effusivity=effusivity, last_time=float(times.max()))
    last = float(times.max())
    grid = np.unique(np.concatenate([[0.0], np.geomspace(last * 1e-7, last, STEPS), times[times > 0]]))
    surface, heat = np.full(len(grid), float(initial)), np.zeros(len(grid))
    factor = 1.0 / (effusivity * math.sqrt(math.pi))
    for n in range(1, len(grid)):
        weight = factor * _weights(grid[: n + 1])
        t = float(grid[n])
        h, known = film(t), initial + float(weight[:-1] @ heat[:n])
        surface[n] = (known + weight[-1] * (flux(t) + h * sink(t))) / (1.0 + weight[-1] * h)
        heat[n] = flux(t) - h * (surface[n] - sink(t))
    return np.interp(times, grid, surface)


def _weights(grid: Array) -> Array:
    """Integral of q(s)/sqrt(t - s) up to the last time as weights on q; over the first interval q is constant."""
    left = grid[-1] - grid
    root = np.sqrt(left)
    whole = 2.0 * (root[:-1] - root[1:])
    first_moment = left[:-1] * whole - (2.0 / 3.0) * (left[:-1] * root[:-1] - left[1:] * root[1:])
    end = first_moment / np.diff(grid)
    end[0] = whole[0]
    weights = np.zeros(len(grid))
    weights[1:] = end
    weights[:-1] += whole - end
    return weights
