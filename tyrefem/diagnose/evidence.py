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

    def with_data(self, data: Array) -> Linear:
        """The same model of other data; what does not depend on them is kept."""
        _ = self._marginal
        other = Linear(self.unknowns, self.nuisance, data, self.jacobian)
        for name in ("place", "gram", "sd", "_inverse", "_marginal"):
            if name in self.__dict__:
                other.__dict__[name] = self.__dict__[name]
        return other

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
        """With the nuisance integrated out: Gram of the others, G_en (G_nn + S^-2)^-1, and ln det(1 + S G S) / 2."""
        n = self.nuisance
        sd = self.sd[:n]
        projection = self.gram[n:, :n] @ self._inverse
        gram = self.gram[n:, n:] - projection @ self.gram[:n, n:]
        return gram, projection, float(np.linalg.slogdet(np.eye(n) + self.gram[:n, :n] * np.outer(sd, sd))[1] / 2)

    @cached_property
    def _inverse(self) -> Array:
        """(G + S^-2)^-1 of the nuisance."""
        n = self.nuisance
        sd = self.sd[:n]
        return np.asarray(np.linalg.inv(np.eye(n) + self.gram[:n, :n] * sd[:, None] * sd[None, :]) * np.outer(sd, sd))

    def columns(self, unknowns: Sequence[Unknown]) -> NDArray[np.intp]:
        """Columns of unknowns."""
        return np.array([self.place[one] for one in unknowns], dtype=np.intp)

    def log_evidence(self, members: Members) -> float:
        """ln p(d | the members' amplitudes and the nuisance), up to a constant of the data."""
        n = self.nuisance
        overlap, fixed = self.overlap, 0.0
        present = self.columns([one for member in members for one in member.presence])
        if len(present):
            # What is simply there is taken off the data: d' = d - J 1.
            overlap = overlap - self.gram[:, present].sum(axis=1)
            fixed = float(self.overlap[present].sum() - self.gram[np.ix_(present, present)].sum() / 2)
        gram, projection, half = self._marginal
        own = fixed - half + float(overlap[:n] @ self._inverse @ overlap[:n]) / 2
        unknowns = [one for member in members for one in member.amplitudes]
        if not unknowns:
            return own
        at = self.columns(unknowns) - n
        limits = np.array([(one.low, one.high) for one in unknowns])
        reduced = overlap[n:][at] - projection[at] @ overlap[:n]
        return own + fit(gram[np.ix_(at, at)], reduced, self.sd[n:][at], *limits.T).log_evidence

    def fit(self, unknowns: Sequence[Unknown]) -> Fit:
        """Posterior of the given unknowns, all others null."""
        at = self.columns(unknowns)
        limits = np.array([(one.low, one.high) for one in unknowns]).reshape(-1, 2)
        return fit(self.gram[np.ix_(at, at)], self.overlap[at], self.sd[at], *limits.T)

    @property
    def constant(self) -> float:
        """-|d|^2/2, which evidences about other points need."""
        return float(-self.data @ self.data / 2)
