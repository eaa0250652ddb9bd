"""Evidence of one and of two amplitudes in a linear model: for all sets of effects at once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tyrefem.diagnose.inference.evidence import bounds_mass

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Amplitudes:
    """Amplitudes of candidates in sets of one and two; a candidate that is not ``fitted`` is a fixed signal.

    Answers are ln evidence, shift and added variance of the bounded base numbers and sensors, by set.

    Parameters
    ----------
    overlap : (n,) columns times data. gram : (n, n) of the columns. sd, low, high : (n,) priors of the amplitudes.
    rows : (n, b) change of the bounded base numbers and sensors by a candidate.
    """

    overlap: Array
    gram: Array
    sd: Array
    low: Array
    high: Array
    fitted: NDArray[np.bool_]
    rows: Array

    @cached_property
    def diagonal(self) -> Array:
        """(n,) of the Gram matrix."""
        return np.diag(self.gram)

    def single(self, i: Array, overlap: Array | None = None) -> tuple[Array, Array, Array]:
        """Sets of a single candidate; ``overlap``: with other data."""
        b = self.overlap[i] if overlap is None else overlap
        a, s = 1 + self.sd[i] ** 2 * self.diagonal[i], self.sd[i]
        z = s * b / a
        free = s * b * z / 2 - np.log(a) / 2 + bounds_mass(z, 1 / np.sqrt(a), self.low[i] / s, self.high[i] / s)
        evidence = np.where(self.fitted[i], free, b - self.diagonal[i] / 2)
        x, variance = np.where(self.fitted[i], s**2 * b / a, 1.0), np.where(self.fitted[i], s**2 / a, 0.0)
        return evidence, self.rows[i] * x[:, None], self.rows[i] ** 2 * variance[:, None]

    def after_signal(self, i: Array, j: Array) -> tuple[Array, Array, Array]:
        """Fixed signals i with candidates j."""
        evidence, shift, spread = self.single(j, self.overlap[j] - self.gram[i, j])
        return self.overlap[i] - self.diagonal[i] / 2 + evidence, shift + self.rows[i], spread

    def pair(self, i: Array, j: Array) -> tuple[Array, Array, Array]:
        """Amplitudes i and j together."""
        sd, diagonal, low, high = self.sd, self.diagonal, self.low, self.high
        a, b, c = 1 + sd[i] ** 2 * diagonal[i], 1 + sd[j] ** 2 * diagonal[j], sd[i] * sd[j] * self.gram[i, j]
        det = a * b - c * c
        u, v = sd[i] * self.overlap[i], sd[j] * self.overlap[j]
        z, w = (b * u - c * v) / det, (a * v - c * u) / det
        evidence = (u * z + v * w) / 2 - np.log(det) / 2
        evidence += bounds_mass(z, np.sqrt(b / det), low[i] / sd[i], high[i] / sd[i])
        evidence += bounds_mass(w, np.sqrt(a / det), low[j] / sd[j], high[j] / sd[j])
        of_i, of_j = self.rows[i] * sd[i][:, None], self.rows[j] * sd[j][:, None]
        shift = of_i * z[:, None] + of_j * w[:, None]
        spread = (of_i**2 * b[:, None] + of_j**2 * a[:, None] - 2 * of_i * of_j * c[:, None]) / det[:, None]
        return evidence, shift, spread
