"""All trials stacked and whitened: evidence of any set of candidates, from Gram matrices alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tyrefem.diagnose.gauss import Fit, fit
from tyrefem.diagnose.unknowns import Candidate, Unknown

Array = NDArray[np.float64]
Members = tuple[Candidate, ...]


@dataclass(frozen=True, eq=False)
class Linear:
    """d = J x + e about x = 0, whitened: ``data`` (n,), ``jacobian`` (n, k) of ``unknowns``; ``nuisance``: how many of
    them, the first, belong to every model.
    """

    unknowns: tuple[Unknown, ...]
    nuisance: int
    data: Array
    jacobian: Array

    @cached_property
    def place(self) -> dict[Unknown, int]:
        """Unknown -> its column."""
        return {one: column for column, one in enumerate(self.unknowns)}

    @cached_property
    def gram(self) -> Array:
        """J^T J."""
        return np.asarray(self.jacobian.T @ self.jacobian)

    @cached_property
    def overlap(self) -> Array:
        """J^T d."""
        return np.asarray(self.jacobian.T @ self.data)

    @cached_property
    def sd(self) -> Array:
        """Prior standard deviations."""
        return np.array([one.sd for one in self.unknowns])

    @cached_property
    def _marginal(self) -> tuple[Array, Array, float]:
        """(Gram, overlap, log evidence of the nuisance alone) of the candidates with the nuisance integrated out."""
        n = self.nuisance
        sd = self.sd[:n]
        matrix = np.eye(n) + self.gram[:n, :n] * sd[:, None] * sd[None, :]
        solved = np.linalg.solve(matrix, sd[:, None] * self.gram[:n, n:])
        gram = self.gram[n:, n:] - (sd[:, None] * self.gram[:n, n:]).T @ solved
        own = np.linalg.solve(matrix, sd * self.overlap[:n])
        overlap = self.overlap[n:] - (sd[:, None] * self.gram[:n, n:]).T @ own
        log_evidence = float((sd * self.overlap[:n]) @ own / 2 - np.linalg.slogdet(matrix)[1] / 2)
        return gram, overlap, log_evidence

    def columns(self, unknowns: Sequence[Unknown]) -> NDArray[np.intp]:
        """Columns of unknowns."""
        return np.array([self.place[one] for one in unknowns], dtype=np.intp)

    def log_evidence(self, members: Members) -> float:
        """ln p(d | the members' amplitudes and the nuisance), up to a constant of the data."""
        unknowns = [one for member in members for one in member.amplitudes]
        gram, overlap, own = self._marginal
        if not unknowns:
            return own
        at = self.columns(unknowns) - self.nuisance
        limits = np.array([(one.low, one.high) for one in unknowns])
        return own + fit(gram[np.ix_(at, at)], overlap[at], self.sd[self.nuisance :][at], *limits.T).log_evidence

    def fit(self, unknowns: Sequence[Unknown]) -> Fit:
        """Posterior of the given unknowns, all others null."""
        at = self.columns(unknowns)
        limits = np.array([(one.low, one.high) for one in unknowns]).reshape(-1, 2)
        return fit(self.gram[np.ix_(at, at)], self.overlap[at], self.sd[at], *limits.T)

    @property
    def constant(self) -> float:
        """-|d|^2/2, which evidences about other points need."""
        return float(-self.data @ self.data / 2)
