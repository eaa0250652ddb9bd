"""Solve a banded Cholesky factor for many right-hand sides: block by block, by products of full matrices."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.lib.stride_tricks import as_strided
from numpy.typing import NDArray
from scipy.linalg import get_lapack_funcs

Array = NDArray[Any]

_SMALLEST = 24


class Blocks:
    """The factor L of A = L L^T as blocks no narrower than its band: D on the diagonal, E below, all else zero.

    LAPACK's banded solve takes one right-hand side at a time, a few numbers per step; here a block of the solution
    follows from the one before by one product, X_i = D_i^-1 (R_i - E_i X_(i-1)), for all right-hand sides.

    Parameters
    ----------
    band : (width + 1, n), the lower band of L in LAPACK's storage, column by column in memory.

    >>> import numpy as np
    >>> from scipy.linalg import cholesky_banded
    >>> A = np.diag(np.full(90, 4.0)) + np.diag(np.ones(89), 1) + np.diag(np.ones(89), -1)
    >>> band = np.asfortranarray(cholesky_banded(np.array([A.diagonal(), np.append(A.diagonal(1), 0.0)]), lower=True))
    >>> right = np.arange(180.0).reshape(90, 2)
    >>> bool(np.allclose(A @ Blocks(band).solve(right), right))
    True
    """

    def __init__(self, band: Array) -> None:
        width, self.size = band.shape[0] - 1, band.shape[1]
        self.side = b = max(width, _SMALLEST)
        self.count = -(-self.size // b)
        flat = np.zeros((self.count + 1) * b * (width + 1))
        flat[: band.size] = band.reshape(-1, order="F")
        flat[band.size :: width + 1] = 1.0
        # L[i, j] lies at i + j width, so that every block is a view; what is outside the band is masked.
        step = flat.itemsize
        layout = ((self.count, b, b), (b * (width + 1) * step, step, width * step))
        row, column = np.indices((b, b))
        diagonal = np.where((row >= column) & (row - column <= width), as_strided(flat, *layout), 0.0)
        below = np.where(row + b - column <= width, as_strided(flat[b:], *layout), 0.0)[:-1]
        (invert,) = get_lapack_funcs(("trtri",), (flat,))
        inverse = np.array([invert(block.T, lower=0)[0].T for block in diagonal])
        back = inverse.transpose(0, 2, 1)
        self._first, self._last = inverse[0], back[-1]
        self._down = np.concatenate([-inverse[1:] @ below, inverse[1:]], axis=2)
        self._up = np.concatenate([back[:-1], -back[:-1] @ below.transpose(0, 2, 1)], axis=2)

    def solve(self, right: Array) -> Array:
        """x (n, m) with L L^T x = right."""
        b = self.side
        x = np.zeros((self.count * b, right.shape[1]))
        x[: self.size] = right
        x[:b] = self._first @ x[:b]
        for i, step in enumerate(self._down):
            x[(i + 1) * b : (i + 2) * b] = step @ x[i * b : (i + 2) * b]
        x[-b:] = self._last @ x[-b:]
        for i in range(self.count - 2, -1, -1):
            x[i * b : (i + 1) * b] = self._up[i] @ x[i * b : (i + 2) * b]
        return x[: self.size]
