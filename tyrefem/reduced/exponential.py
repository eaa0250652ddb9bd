"""Response of a decaying mode to heat that is a polynomial of time.

Closed forms of the integrals of exp(-x (theta - sigma)) sigma^j over sigma from 0 to theta.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


#: Above this decay the upward recurrence is stable, below it the downward one, begun so many terms higher.
UPWARDS, EXTRA_TERMS = 2.0, 10


#: Terms of a power series for a decay up to `UPWARDS`: 2^22 / 22! is less than rounding.
SERIES = 22


def responses(x: Array, theta: Array, count: int) -> tuple[Array, Array]:
    """E = exp(-x theta) and the integrals I_j of exp(-x (theta - sigma)) sigma^j, sigma from 0 to theta, j < count.

    dI_j/dtheta = theta^j - x I_j, so z' = -x z + sum_j s_j theta^j has z = E z_0 + sum_j s_j I_j, and the integral of
    I_j is I_{j+1} / (j + 1). I_j = (theta^j - j I_{j-1}) / x is stable upwards for a large x, downwards for small ones.

    Parameters
    ----------
    x : (...,) decay, at least 0. theta : (k,) in [0, 1].

    Returns
    -------
    E (..., k), and I (count, ..., k).

    >>> E, I = responses(np.array([0.0, 2.0]), np.array([1.0]), 2)
    >>> I[:, :, 0].round(6)
    array([[1.      , 0.432332],
           [0.5     , 0.283834]])
    """
    theta = np.broadcast_to(theta, (*x.shape, len(theta)))
    x = np.broadcast_to(x[..., None], theta.shape)
    decay = x * theta
    stiff = decay > UPWARDS
    E, integrals = np.empty(decay.shape), np.empty((count, *decay.shape))
    if stiff.any():
        E[stiff], integrals[:, stiff] = _upwards(x[stiff], decay[stiff], theta[stiff], count)
    calm = ~stiff
    if calm.any():
        E[calm], integrals[:, calm] = _downwards(x[calm], theta[calm], count)
    return E, integrals


def _upwards(x: Array, decay: Array, theta: Array, count: int) -> tuple[Array, Array]:
    E, integrals, power = np.exp(-decay), np.empty((count, len(x))), np.ones_like(theta)
    integrals[0] = (1 - E) / x
    for j in range(1, count):
        power = power * theta
        integrals[j] = (power - j * integrals[j - 1]) / x
    return E, integrals


def _downwards(x: Array, theta: Array, count: int) -> tuple[Array, Array]:
    """Downward recurrence from an approximate last term; every step damps its error."""
    top, integrals = count + EXTRA_TERMS, np.empty((count, len(x)))
    powers = [np.ones_like(theta), theta]
    for j in range(2, top + 2):
        powers.append(powers[j // 2] * powers[j - j // 2])
    below = powers[top + 1] / (top + 1 + x * theta)
    for j in range(top, 0, -1):
        below = (powers[j] - x * below) / j
        if j <= count:
            integrals[j - 1] = below
    return 1 - x * integrals[0], integrals


def relaxed(x: Array, start: Array, heat: Array, theta: Array, *, integral: bool = True) -> tuple[Array, Array]:
    """Solution z of z' = -x z + sum_j s_j theta^j at parts of a window, and its integral from the window's start.

    For x above 2 a polynomial P solves the equation and z = P + (z_0 - P(0)) exp(-x theta); below, a power series does.

    Parameters
    ----------
    x : (r,) decay, at least 0. start : (r,) z_0. heat : (r, j) s. theta : (k,) in [0, 1].

    Returns
    -------
    z (r, k) and its integral (r, k); with ``integral=False`` the second array has no columns.

    >>> z, whole = relaxed(np.array([0.0, 3.0]), np.array([1.0, 1.0]), np.array([[2.0], [3.0]]), np.array([1.0]))
    >>> z[:, 0].round(12), whole[:, 0].round(12)
    (array([3., 1.]), array([2., 1.]))
    """
    z, whole = np.empty((len(x), len(theta))), np.empty((len(x), len(theta) if integral else 0))
    stiff = x > UPWARDS
    for rows, find in ((stiff, _with_decay), (~stiff, _as_series)):
        if rows.any():
            z[rows], whole[rows] = find(x[rows], start[rows], heat[rows], theta, integral)
    return z, whole


def _with_decay(x: Array, start: Array, heat: Array, theta: Array, integral: bool) -> tuple[Array, Array]:
    P = np.empty_like(heat)
    P[:, -1] = heat[:, -1] / x
    for j in range(heat.shape[1] - 2, -1, -1):
        P[:, j] = (heat[:, j] - (j + 1) * P[:, j + 1]) / x
    rest, E = (start - P[:, 0])[:, None], np.exp(-x[:, None] * theta)
    z, whole = _powers(P, theta, integral)
    z += rest * E
    return z, whole + rest * (1 - E) / x[:, None] if integral else whole


def _as_series(x: Array, start: Array, heat: Array, theta: Array, integral: bool) -> tuple[Array, Array]:
    c = np.zeros((len(x), SERIES))
    c[:, 0] = start
    for j in range(SERIES - 1):
        given = heat[:, j] if j < heat.shape[1] else 0.0
        c[:, j + 1] = (given - x * c[:, j]) / (j + 1)
    return _powers(c, theta, integral)


def _powers(c: Array, theta: Array, integral: bool) -> tuple[Array, Array]:
    """Values of a polynomial with coefficients c (r, j), and with ``integral`` its integral from 0."""
    orders = np.arange(c.shape[1])
    table = theta ** orders[:, None]
    return c @ table, (c / (orders + 1)) @ (table * theta) if integral else np.empty((len(c), 0))
