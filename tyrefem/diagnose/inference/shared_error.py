"""An error of the model that readings share: columns whose coefficients are integrated out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SharedError(Brief):
    """Whitened readings y = J x + C c + e with c, e ~ N(0, 1): e and C c together have the covariance 1 + C C^T.

    Parameters
    ----------
    fitted : (n, k) columns C of the fitted runs. held_out : (m, k) columns of the held-out runs.
    """

    fitted: Array
    held_out: Array

    def _title(self) -> str:
        return f"{self.fitted.shape[1]} columns"

    def beside(self, other: SharedError) -> SharedError:
        """Both errors; the columns of this one first."""
        return SharedError(np.hstack([self.fitted, other.fitted]), np.hstack([self.held_out, other.held_out]))

    @cached_property
    def _modes(self) -> tuple[Array, Array]:
        """Orthogonal columns C V (n, k), and (1 + t)^1/2 (k,) with C^T C = V t V^T."""
        C = self.fitted
        t, V = np.linalg.eigh(C.T @ C)
        return C @ V, np.sqrt(1.0 + np.maximum(t, 0.0))

    @cached_property
    def log_det(self) -> float:
        """ln det(1 + C C^T) / 2."""
        return float(np.log(self._modes[1]).sum())

    def whitened(self, rows: Array) -> Array:
        """(1 + C C^T)^-1/2 times rows (n, ...) of the fitted runs.

        It is 1 - C V f V^T C^T with f = 1 / (w + w^2), w = (1 + t)^1/2: there are fewer columns than readings.
        """
        columns, root = self._modes
        return np.asarray(rows - (columns / (root * (1.0 + root))) @ (columns.T @ rows))

    def colored(self, rows: Array) -> Array:
        """(1 + C C^T)^1/2 times whitened rows: the inverse of `whitened`."""
        columns, root = self._modes
        return np.asarray(rows + (columns / (1.0 + root)) @ (columns.T @ rows))

    @cached_property
    def _columns(self) -> Array:
        return self.whitened(self.fitted)

    def held_out_from(self, rows: Array, held_out: Array) -> Array:
        """Rows (m, ...) of the held-out runs minus what those of the fitted runs, whitened (n, ...), say of them."""
        return np.asarray(held_out - self.held_out @ (self._columns.T @ rows))

    def coefficients(self, rows: Array, slopes: Array, covariance: Array) -> tuple[Array, Array]:
        """Mean and standard deviation (k,) of c.

        ``rows``: whitened residuals (n,) of a fit; ``slopes`` (n, p), ``covariance`` (p, p): of its unknowns.
        """
        A = self._columns
        spread = np.eye(A.shape[1]) - A.T @ A + A.T @ slopes @ covariance @ slopes.T @ A
        return np.asarray(A.T @ rows), np.sqrt(np.maximum(np.diag(spread), 0.0))

    @cached_property
    def held_out_covariance(self) -> Array:
        """(m, m) covariance of the held-out readings about their prediction: 1 + C' (1 + C^T C)^-1 C'^T."""
        A, C = self._columns, self.held_out
        return np.asarray(np.eye(len(C)) + C @ (np.eye(A.shape[1]) - A.T @ A) @ C.T)
