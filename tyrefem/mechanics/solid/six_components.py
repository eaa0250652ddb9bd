"""Symmetric tensors as six components rr, zz, tt, rz, rt, zt; any shape of points after the first axes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: Tensor indices of the six components, and of each the first and the second; 0, 1, 2 stand for r, z, theta.
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
FIRST, SECOND = (np.array(index) for index in zip(*PAIRS, strict=True))
#: Index of a tensor's component among the six.
PLACE = np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]])
#: The unit tensor, and the symmetric unit tensor of fourth order for engineering shears.
UNIT = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
SYMMETRIC_UNIT = np.diag([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])


def components(tensor: Array) -> Array:
    """(6, ...) components of symmetric tensors (3, 3, ...)."""
    return np.asarray(tensor[FIRST, SECOND])


def outer(left: Array, right: Array) -> Array:
    """(6, 6, ...) dyad of two tensors (6, ...)."""
    return np.asarray(left[:, None] * right[None])


def box(b: Array) -> Array:
    """(6, 6, ...) of (b_ik b_jl + b_il b_jk) / 2 for symmetric b (3, 3, ...): the unit of fourth order if b = 1.

    >>> bool(np.allclose(box(np.eye(3)), SYMMETRIC_UNIT))
    True
    """
    i, j, k, m = FIRST[:, None], SECOND[:, None], FIRST[None], SECOND[None]
    return np.asarray((b[i, k] * b[j, m] + b[i, m] * b[j, k]) / 2)


def over(values: Array, shape: tuple[int, ...]) -> Array:
    """A constant tensor with further axes of size one, for use at every point."""
    return np.asarray(values).reshape(values.shape + (1,) * len(shape))
