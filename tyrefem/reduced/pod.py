"""POD modes of snapshots, and sample nodes for the hyper-reduction of fields (Q-DEIM)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: Sample nodes are chosen among about so many candidates.
CANDIDATE_NODES = 3000


def modes(snapshots: Array, weight: Array, tolerance: float, most: int) -> Array:
    """POD modes V (n, m) with V^T diag(weight) V = 1; the first mode is the uniform field.

    Parameters
    ----------
    snapshots : (k, n). weight : (n,) positive, of the inner product.
    tolerance : rms error of the snapshots that is allowed, in their unit. most : modes at most.

    >>> fields = np.array([[1.0, 1.0, 1.0], [0.0, 1.0, 2.0]])
    >>> modes(fields, np.ones(3), 1e-9, 5).shape
    (3, 2)
    """
    root = np.sqrt(weight / weight.sum())
    even = np.ones(len(weight))
    scaled = snapshots * root
    rest = scaled - np.outer(scaled @ root, root)
    # The Gram matrix is small, and the wanted modes are far above its rounding errors.
    values, left = np.linalg.eigh(rest @ rest.T)
    order = np.argsort(values)[::-1]
    values, left = np.maximum(values[order], 0.0), left[:, order]
    # Fix the free sign of a mode: the snapshot with its largest coefficient has a positive one.
    left = left * np.sign(left[np.argmax(np.abs(left), axis=0), np.arange(left.shape[1])])
    left_out = np.sqrt(np.append(np.cumsum(values[::-1])[::-1], 0.0) / len(snapshots))
    count = min(int(np.argmax(left_out <= tolerance)), most - 1)
    count = min(count, int((values > 1e-13 * max(values[0], 1e-300)).sum()))
    coefficients = (left[:, :count].T @ rest) / root / np.sqrt(values[:count])[:, None]
    # Keep the uniform field exactly the first mode.
    rest = coefficients * root
    return np.column_stack(
        [even / np.linalg.norm(root), orthonormal((rest - np.outer(rest @ root, root)).T) / root[:, None]]
    )


def further_modes(V: Array, snapshots: Array, weight: Array, tolerance: float, most: int) -> Array:
    """Modes (n, k) beyond V (n, m): POD of what V leaves of the snapshots, until ``tolerance`` (rms) is left.

    >>> fields = np.random.default_rng(0).random((4, 9))
    >>> V = modes(fields, np.ones(9), 0.2, 2)
    >>> W = np.column_stack([V, further_modes(V, fields, np.ones(9), 1e-9, 9)])
    >>> bool(np.abs(fields - fields @ (W @ W.T) / 9).max() < 1e-6)
    True
    """
    root = np.sqrt(weight / weight.sum())
    scaled, rows = snapshots * root, V * root[:, None]
    rest = scaled - (scaled @ rows) @ rows.T
    values, left = np.linalg.eigh(rest @ rest.T)
    values, left = np.maximum(values[::-1], 0.0), left[:, ::-1]
    left_out = np.sqrt(np.append(np.cumsum(values[::-1])[::-1], 0.0) / len(snapshots))
    count = min(int(np.argmax(left_out <= tolerance)), most, int((values > 1e-13 * max(values[0], 1e-300)).sum()))
    beyond = rest.T @ left[:, :count] / np.sqrt(values[:count])
    return np.asarray(orthonormal(beyond - rows @ (rows.T @ beyond)) / root[:, None])


def orthonormal(X: Array) -> Array:
    """Orthonormalise nearly orthogonal columns by two passes of Cholesky QR."""
    for _ in range(2):
        # The second pass removes the rounding errors of the first.
        X = X @ np.linalg.inv(np.linalg.cholesky(X.T @ X)).T
    return X


def sample_nodes(fields: Array, tolerance: float, most: int, spare: float = 1.5) -> tuple[Array, Array]:
    """Sample nodes and the matrix P that interpolates fields from them: f ~ P f[nodes].

    Pivoted QR of the fields' POD modes chooses the nodes, ``spare`` times as many as modes (Q-DEIM with oversampling).
    P is the least-squares fit of the modes.

    Parameters
    ----------
    fields : (k, n). tolerance : relative rms error of the fields that is allowed. most : modes at most.

    Returns
    -------
    numbers (p,) of the sample nodes, and P (n, p).
    """
    U, numbers, fit = interpolation(fields, tolerance, most, spare)
    return numbers, U @ fit


def interpolation(fields: Array, tolerance: float, most: int, spare: float = 1.5) -> tuple[Array, Array, Array]:
    """POD modes U (n, K) of fields, numbers (p,) of sample nodes, and the fit (K, p): f ~ U fit f[numbers].

    Parameters as in `sample_nodes`.
    """
    from scipy.linalg import qr

    values, left = np.linalg.eigh(fields @ fields.T)
    order = np.argsort(values)[::-1]
    values, left = np.maximum(values[order], 0.0), left[:, order]
    # Fix the free sign of a mode: the snapshot with its largest coefficient has a positive one.
    left = left * np.sign(left[np.argmax(np.abs(left), axis=0), np.arange(left.shape[1])])
    left_out = np.sqrt(np.append(np.cumsum(values[::-1])[::-1], 0.0) / max(values.sum(), 1e-300))
    count = max(min(int(np.argmax(left_out <= tolerance)), most), 1)
    count = min(count, int((values > 1e-13 * values[0]).sum()))
    U = orthonormal((fields.T @ left[:, :count]) / np.sqrt(values[:count]))
    wanted = min(int(np.ceil(spare * count)), U.shape[0])
    # In a fine mesh a part of the nodes is enough to choose from.
    some = np.arange(0, len(U), max(len(U) // CANDIDATE_NODES, 1))
    _, _, pivots = qr(U[some].T, pivoting=True, mode="economic")
    chosen = list(some[pivots[:count]])
    # Oversampling: the remaining nodes with the largest leverage of the modes.
    leverage = np.full(len(U), -1.0)
    leverage[some] = (U[some] ** 2).sum(axis=1)
    leverage[chosen] = -1.0
    chosen += list(np.argsort(leverage)[::-1][: wanted - count])
    numbers = np.sort(np.array(chosen))
    return U, numbers, np.linalg.pinv(U[numbers])
