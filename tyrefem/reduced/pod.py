"""Proper orthogonal modes of snapshots, and the few places that stand for a whole field."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: Places are chosen among about so many.
CHOICE = 3000


def modes(snapshots: Array, weight: Array, tolerance: float, most: int) -> Array:
    """Modes V (n, m), V^T diag(weight) V = 1: the even field first, then what spans the rest of the snapshots best.

    Parameters
    ----------
    snapshots : (k, n). weight : (n,) positive, of the inner product.
    tolerance : rms over the snapshots that may be left out, in their unit; most : modes at most.

    >>> fields = np.array([[1.0, 1.0, 1.0], [0.0, 1.0, 2.0]])
    >>> modes(fields, np.ones(3), 1e-9, 5).shape
    (3, 2)
    """
    root = np.sqrt(weight / weight.sum())
    even = np.ones(len(weight))
    scaled = snapshots * root
    rest = scaled - np.outer(scaled @ root, root)
    # The Gram matrix is small, and the modes wanted are far above its round-off.
    values, left = np.linalg.eigh(rest @ rest.T)
    order = np.argsort(values)[::-1]
    values, left = np.maximum(values[order], 0.0), left[:, order]
    # A mode's sign is free: the snapshot that it takes the largest part of has it positively, whatever the rounding.
    left = left * np.sign(left[np.argmax(np.abs(left), axis=0), np.arange(left.shape[1])])
    left_out = np.sqrt(np.append(np.cumsum(values[::-1])[::-1], 0.0) / len(snapshots))
    count = min(int(np.argmax(left_out <= tolerance)), most - 1)
    count = min(count, int((values > 1e-13 * max(values[0], 1e-300)).sum()))
    coefficients = (left[:, :count].T @ rest) / root / np.sqrt(values[:count])[:, None]
    # What is even stays exactly the first mode.
    rest = coefficients * root
    return np.column_stack(
        [even / np.linalg.norm(root), orthonormal((rest - np.outer(rest @ root, root)).T) / root[:, None]]
    )


def orthonormal(X: Array) -> Array:
    """Columns that are nearly orthogonal made so, by Cholesky's factor of their products, twice."""
    for _ in range(2):
        # Twice makes up for the inverse's rounding.
        X = X @ np.linalg.inv(np.linalg.cholesky(X.T @ X)).T
    return X


def places(fields: Array, tolerance: float, most: int, spare: float = 1.5) -> tuple[Array, Array]:
    """Places from which fields of a kind are known: f ~ P f[places].

    Modes of the fields, and places by QR with pivots of the modes, ``spare`` times as many as modes (Q-DEIM with
    oversampling: least squares where places are more than modes).

    Parameters
    ----------
    fields : (k, n). tolerance : share of the fields' energy (root) that may be left out. most : modes at most.

    Returns
    -------
    numbers (p,) of the places, and P (n, p).
    """
    from scipy.linalg import qr

    values, left = np.linalg.eigh(fields @ fields.T)
    order = np.argsort(values)[::-1]
    values, left = np.maximum(values[order], 0.0), left[:, order]
    # A mode's sign is free: the snapshot that it takes the largest part of has it positively, whatever the rounding.
    left = left * np.sign(left[np.argmax(np.abs(left), axis=0), np.arange(left.shape[1])])
    left_out = np.sqrt(np.append(np.cumsum(values[::-1])[::-1], 0.0) / max(values.sum(), 1e-300))
    count = max(min(int(np.argmax(left_out <= tolerance)), most), 1)
    count = min(count, int((values > 1e-13 * values[0]).sum()))
    U = orthonormal((fields.T @ left[:, :count]) / np.sqrt(values[:count]))
    wanted = min(int(np.ceil(spare * count)), U.shape[0])
    # Of a fine mesh's nodes a part is enough to choose from.
    some = np.arange(0, len(U), max(len(U) // CHOICE, 1))
    _, _, pivots = qr(U[some].T, pivoting=True, mode="economic")
    chosen = list(some[pivots[:count]])
    # More places: where the leverage of the modes is largest among those left.
    leverage = np.full(len(U), -1.0)
    leverage[some] = (U[some] ** 2).sum(axis=1)
    leverage[chosen] = -1.0
    chosen += list(np.argsort(leverage)[::-1][: wanted - count])
    numbers = np.sort(np.array(chosen))
    return numbers, U @ np.linalg.pinv(U[numbers])
