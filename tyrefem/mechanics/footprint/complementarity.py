"""The linear complementarity problem of a frictionless contact."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
#: Forces and gaps smaller than this share of the largest count as zero.
ROUND_OFF = 1e-10
#: Number of block exchanges without progress after which single contacts are exchanged.
PATIENCE = 6


def contact_forces(
    compliance: Array, gaps: Array, start: Flags | None = None, *, symmetric: bool = True
) -> tuple[Array, Flags]:
    """Forces f >= 0 that leave no penetration w = gaps + C f >= 0, with f w = 0.

    Block pivoting (Portugal, Judice and Vicente 1994): all tensile contacts are opened and all penetrating points are
    closed together. If that cycles, single contacts are exchanged, which terminates for any positive definite C.

    Parameters
    ----------
    compliance : (n, n) C, positive definite, m/N. ``symmetric``: that of a body without loss.
    gaps : (n,) at zero force, negative where the bodies overlap, m.
    start : initial set of contacts.

    Returns
    -------
    (n,) forces, N, and (n,) flags of the points in contact.

    Raises
    ------
    ValueError : C is not positive definite on a set of contacts.

    >>> forces, closed = contact_forces(np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([-1.0, 0.5]))
    >>> forces.round(6).tolist(), closed.tolist()
    ([0.5, 0.0], [True, False])
    """
    gaps = np.asarray(gaps, dtype=float)
    closed = gaps < 0 if start is None else start.copy()
    scale = np.abs(gaps).max(initial=0.0)
    fewest, patience = len(gaps) + 1, PATIENCE
    for _ in range(200 + 20 * len(gaps)):
        forces = np.zeros_like(gaps)
        index = np.flatnonzero(closed)
        matrix = compliance[np.ix_(index, index)]
        forces[index] = _positive_solve(matrix, -gaps[index]) if symmetric else np.linalg.solve(matrix, -gaps[index])
        left = gaps + compliance[:, index] @ forces[index]
        pulls = closed & (forces < -ROUND_OFF * np.abs(forces).max(initial=0.0))
        wrong = pulls | (~closed & (left < -ROUND_OFF * scale))
        count = int(wrong.sum())
        if count == 0:
            return np.maximum(forces, 0.0), closed
        if count < fewest:
            fewest, patience = count, PATIENCE
        elif patience > 0:
            patience -= 1
        else:
            last = np.flatnonzero(wrong)[-1]
            wrong = np.zeros_like(wrong)
            wrong[last] = True
        closed = closed ^ wrong
    raise ValueError("the contact forces do not settle")


def _positive_solve(matrix: Array, right: Array) -> Array:
    from scipy.linalg import LinAlgError, cho_factor, cho_solve

    if not len(right):
        return right
    try:
        return np.asarray(cho_solve(cho_factor(matrix), right))
    except LinAlgError:
        raise ValueError("the compliance is not positive definite") from None
