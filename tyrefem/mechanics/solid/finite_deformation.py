"""Deformations of any size at the points of elements: inverse, strains, tangent of a stress that follows them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.solid.six_components import PAIRS

Array = NDArray[np.float64]


def deformation(gradient: Array) -> Array:
    """(3, 3, e, q, m) F = 1 + H."""
    e, _, q, m = gradient.shape
    f = np.ascontiguousarray(gradient.transpose(1, 0, 2, 3))
    f[[0, 4, 8]] += 1
    return f.reshape(3, 3, e, q, m)


def inverted(f: Array) -> Array:
    """(3, 3, ...) inverse by cofactors."""
    inverse = np.empty_like(f)
    for i in range(3):
        for j in range(3):
            a, b, c, d = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
            inverse[j, i] = f[a, c] * f[b, d] - f[a, d] * f[b, c]
    inverse /= (f[0] * inverse[:, 0]).sum(axis=0)
    return inverse


def at_points(tensors: Array, axes: int) -> Array:
    """Tensors with their one or two component axes moved from the front to the end, contiguous."""
    return np.ascontiguousarray(np.moveaxis(tensors, range(axes), range(-axes, 0)))


def by_components(tensors: Array) -> Array:
    """(e, 9, q, m) of components (e, q, m, 9)."""
    return np.ascontiguousarray(np.moveaxis(tensors, -1, 1))


def strain_gradients(f: Array) -> Array:
    """(e, q, m, 6, 9) B of dE = B dF at deformations F (3, 3, e, q, m)."""
    strains = np.zeros((*f.shape[2:], 6, 9))
    for row, (i, j) in enumerate(PAIRS):
        for k in range(3):
            strains[..., row, 3 * k + j] += f[k, i]
            if i != j:
                strains[..., row, 3 * k + i] += f[k, j]
    return strains


def material_tangent(strains: Array, stiffness: Array, initial: Array) -> Array:
    """(e, q, m, 9, 9) B' c B + 1 S of B (e, q, m, 6, 9), c (e, q, m or 1, 6, 6), S (e, q, m, 3, 3)."""
    tangent = strains.swapaxes(-1, -2) @ (stiffness @ strains)
    for k in range(3):
        tangent[..., 3 * k : 3 * k + 3, 3 * k : 3 * k + 3] += initial
    return np.asarray(tangent)
