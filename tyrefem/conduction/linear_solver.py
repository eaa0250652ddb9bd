"""Factor the symmetric positive definite matrices of conduction: banded for thin bodies, sparse for wide ones.

A banded Cholesky factor solves many right-hand sides by blocks, with products of full matrices.
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import as_strided
from numpy.typing import NDArray
from scipy.linalg import get_lapack_funcs
from scipy.sparse import csc_matrix, csr_matrix
from scipy.sparse.csgraph import reverse_cuthill_mckee
from scipy.sparse.linalg import splu

from tyrefem.conduction.errors import SolverError

Array = NDArray[Any]


_SMALLEST = 24


class BlockFactor:
    """The factor L of A = L L^T as blocks at least as wide as its band: D on the diagonal, E below, all else zero.

    LAPACK's banded solve takes one right-hand side at a time, a few numbers per step. Here one product gives a block of
    the solution from the previous block, X_i = D_i^-1 (R_i - E_i X_(i-1)), for all right-hand sides.

    Parameters
    ----------
    band : (width + 1, n), the lower band of L in LAPACK's storage, column by column in memory.

    >>> import numpy as np
    >>> from scipy.linalg import cholesky_banded
    >>> A = np.diag(np.full(90, 4.0)) + np.diag(np.ones(89), 1) + np.diag(np.ones(89), -1)
    >>> band = np.asfortranarray(cholesky_banded(np.array([A.diagonal(), np.append(A.diagonal(1), 0.0)]), lower=True))
    >>> right = np.arange(180.0).reshape(90, 2)
    >>> bool(np.allclose(A @ BlockFactor(band).solve(right), right))
    True
    """

    def __init__(self, band: Array) -> None:
        width, self.size = band.shape[0] - 1, band.shape[1]
        self.side = b = max(width, _SMALLEST)
        self.count = -(-self.size // b)
        flat = np.zeros((self.count + 1) * b * (width + 1))
        flat[: band.size] = band.reshape(-1, order="F")
        flat[band.size :: width + 1] = 1.0
        # L[i, j] is stored at i + j width, so that every block is a view; entries outside the band are masked.
        step = flat.itemsize
        layout = ((self.count, b, b), (b * (width + 1) * step, step, width * step))
        row, column = np.indices((b, b))
        diagonal = np.where((row >= column) & (row - column <= width), as_strided(flat, *layout), 0.0)
        below = np.where(row + b - column <= width, as_strided(flat[b:], *layout), 0.0)[:-1]
        (invert,) = get_lapack_funcs(("trtri",), (flat,))
        inverse = np.array([invert(block.T, lower=0)[0].T for block in diagonal])
        transposed = inverse.transpose(0, 2, 1)
        self._first, self._last = inverse[0], transposed[-1]
        self._down = np.concatenate([-inverse[1:] @ below, inverse[1:]], axis=2)
        self._up = np.concatenate([transposed[:-1], -transposed[:-1] @ below.transpose(0, 2, 1)], axis=2)

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


_SOLVES_PER_FACTOR = 30.0


#: Number of right-hand sides from which block solves are faster than banded ones, their set-up included.
_MANY = 16


# Seconds per unit of work on one core: banded flop, banded byte moved, and SuperLU per unknown.
_FLOP, _BYTE, _SPARSE_FACTOR, _SPARSE_SOLVE = 1.2e-10, 1.2e-10, 8e-6, 2.1e-7


class Ordering:
    """An elimination order for one sparsity pattern, chosen by predicted cost.

    A tyre's cross-section is long and thin: with a Cuthill-McKee order its band is small, and LAPACK's banded Cholesky
    is several times faster than a general sparse factorisation. A compact body is factorised by SuperLU.

    Parameters
    ----------
    indptr, indices : the symmetric CSR pattern (sorted) of all n unknowns.
    free : (n_free,) unknowns to solve for, increasing.
    hint : (n,) optional position of every unknown along the body, tried as a second order.
    """

    def __init__(self, indptr: Array, indices: Array, free: Array, hint: Array | None = None) -> None:
        n = indptr.size - 1
        self.free, self.size = free, free.size
        self.all_free = free.size == n
        number = np.full(n, -1, dtype=np.int64)
        number[free] = np.arange(free.size)
        rows = number[np.repeat(np.arange(n), np.diff(indptr))]
        columns = number[indices]
        kept = np.flatnonzero((rows >= 0) & (columns >= 0))
        rows, columns = rows[kept], columns[kept]
        counts = np.bincount(rows, minlength=free.size)
        self._indptr = np.concatenate(([0], np.cumsum(counts))).astype(np.int32)
        self._indices = columns.astype(np.int32)
        graph = csr_matrix((np.ones(kept.size, np.int8), self._indices, self._indptr), (free.size,) * 2)
        orders: list[Array] = [reverse_cuthill_mckee(graph, symmetric_mode=True)]
        if hint is not None:
            orders.append(np.argsort(hint[free], kind="stable"))
        bands: list[tuple[int, int, Array]] = []
        for order in orders:
            place = np.empty(free.size, np.int64)
            place[order] = np.arange(free.size)
            bands.append((int(np.max(place[rows] - place[columns], initial=0)), len(bands), place))
        width, best, place = min(bands, key=lambda band: band[:2])
        self.order, self.width = orders[best], width
        banded = free.size * (_FLOP * width**2 + _SOLVES_PER_FACTOR * 16 * _BYTE * (width + 1))
        self.banded = banded < free.size * (_SPARSE_FACTOR + _SOLVES_PER_FACTOR * _SPARSE_SOLVE)
        if self.banded:
            lower = place[rows] >= place[columns]
            self._kept = kept[lower]
            r, c = place[rows[lower]], place[columns[lower]]
            self._position = c * (width + 1) + (r - c)
        else:
            self._kept = kept

    def factor(self, data: Array) -> Factor:
        """Factor the matrix whose values on the full pattern are `data`."""
        return Factor(self, data)

    def band(self, data: Array) -> Array:
        """The lower band, LAPACK storage, of the permuted matrix."""
        flat = np.zeros(self.size * (self.width + 1))
        flat[self._position] = data[self._kept]
        return flat.reshape((self.width + 1, self.size), order="F")

    def matrix(self, data: Array) -> csc_matrix:
        """The free block as a sparse matrix."""
        return csc_matrix((data[self._kept], self._indices, self._indptr), (self.size,) * 2)


class Factor:
    """One factorisation; `solve` takes and returns vectors over the free unknowns."""

    def __init__(self, ordering: Ordering, data: Array) -> None:
        self.ordering = ordering
        if ordering.banded:
            band = ordering.band(data)
            pbtrf, self._pbtrs = tuple(get_lapack_funcs(("pbtrf", "pbtrs"), (band,)))
            self._band, info = pbtrf(band, lower=1, overwrite_ab=1)
            if info != 0:
                raise SolverError("the conduction matrix is not positive definite")
        else:
            self._lu = splu(
                ordering.matrix(data),
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True},
            )

    @functools.cached_property
    def _blocks(self) -> BlockFactor:
        return BlockFactor(self._band)

    def solve(self, right: Array) -> Array:
        """x with A x = right, for one vector (n,) or several (n, m)."""
        if not self.ordering.banded:
            return self._lu.solve(right)
        order = self.ordering.order
        if right.ndim == 2 and right.shape[1] >= _MANY:
            solution = np.empty_like(right)
            solution[order] = self._blocks.solve(right[order])
            return solution
        permuted, _ = self._pbtrs(self._band, right[order], lower=1, overwrite_b=1)
        solution = np.empty_like(permuted)
        solution[order] = permuted
        return solution
