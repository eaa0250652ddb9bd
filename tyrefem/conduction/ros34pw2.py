"""Coefficients of the Rosenbrock-W method ROS34PW2 and of its continuous extension."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

# Rang & Angermann, BIT 45 (2005) 761-787, ROS34PW2: order 3 for any Jacobian approximation, L-stable.
GAMMA = 0.435866521508459
ALPHA = np.array(
    [
        [0.0, 0.0, 0.0, 0.0],
        [0.87173304301691801, 0.0, 0.0, 0.0],
        [0.84457060015369423, -0.11299064236484185, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ]
)
LOWER = np.array(
    [
        [GAMMA, 0.0, 0.0, 0.0],
        [-0.87173304301691801, GAMMA, 0.0, 0.0],
        [-0.90338057013044082, 0.054180672388095326, GAMMA, 0.0],
        [0.24212380706095346, -1.2232505839045147, 0.54526025533510214, GAMMA],
    ]
)
WEIGHT = np.array([0.24212380706095346, -1.2232505839045147, 1.5452602553351020, GAMMA])
EMBEDDED = np.array([0.37810903145819369, -0.096042292212423178, 0.5, 0.2179332607542295])
NODE, SHIFT = ALPHA.sum(axis=1), LOWER.sum(axis=1)


def _dense_weights() -> Array:
    """b(theta) = W @ (theta, theta^2, theta^3): the third-order conditions of the partial step, solved.

    sum b = theta, sum b alpha = theta^2/2, sum b gamma = 0, sum b beta beta = theta^3/6; b(1) is WEIGHT.
    """
    beta = ALPHA + LOWER
    conditions = np.array([np.ones(4), NODE, SHIFT, beta @ beta.sum(axis=1)])
    right = np.array([[1, 0, 0], [0, 1 / 2, 0], [0, 0, 0], [0, 0, 1 / 6]])
    return np.linalg.solve(conditions, right)


DENSE = _dense_weights()


def dense_weights(theta: float) -> Array:
    """Stage weights (4,) of the solution at the fraction theta of a step.

    >>> bool(np.allclose(dense_weights(1.0), WEIGHT))
    True
    """
    return WEIGHT if theta >= 1.0 else DENSE @ np.array([theta, theta**2, theta**3])
