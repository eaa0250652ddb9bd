"""The linear model of whitened readings: evidence of any set of effects, from Gram matrices alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.inference.evidence import bounds_mass, posterior
from tyrefem.diagnose.unknowns.candidates import Members
from tyrefem.diagnose.unknowns.unknown import Unknown

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DesignMatrix(Brief):
    """Derivatives of whitened readings: ``jacobian`` (n, k).

    ``nuisance``: number of the unknowns, the first ones, that belong to every model.
    """

    unknowns: tuple[Unknown, ...]
    nuisance: int
    jacobian: Array

    @cached_property
    def place(self) -> dict[Unknown, int]:
        """Unknown -> number of its column."""
        return {unknown: column for column, unknown in enumerate(self.unknowns)}

    def columns(self, unknowns: Sequence[Unknown]) -> NDArray[np.intp]:
        """Numbers of the columns of unknowns."""
        return np.array([self.place[unknown] for unknown in unknowns], dtype=np.intp)

    @cached_property
    def gram(self) -> Array:
        """J^T J."""
        return np.asarray(self.jacobian.T @ self.jacobian)

    @cached_property
    def sd(self) -> Array:
        """Prior standard deviations."""
        return np.array([unknown.sd for unknown in self.unknowns])

    @cached_property
    def inverse(self) -> Array:
        """(G + S^-2)^-1 of the nuisance unknowns."""
        n = self.nuisance
        sd = self.sd[:n]
        return np.asarray(np.linalg.inv(np.eye(n) + self.gram[:n, :n] * sd[:, None] * sd[None, :]) * np.outer(sd, sd))

    @cached_property
    def bounded(self) -> NDArray[np.intp]:
        """Columns of the nuisance unknowns that have bounds."""
        nuisance = self.unknowns[: self.nuisance]
        return np.flatnonzero([np.isfinite(unknown.low) or np.isfinite(unknown.high) for unknown in nuisance])

    def nuisance_mass(self, mean: Array, variance: Array) -> Array:
        """(...) ln of the mass of `bounded` unknowns within their bounds, over that of their priors.

        ``mean``, ``variance`` (..., n_bounded): of their posterior without bounds.
        """
        sd, (low, high) = self.sd[self.bounded], self._bounds
        return np.asarray(bounds_mass(mean / sd, np.sqrt(variance) / sd, low, high).sum(axis=-1))

    @cached_property
    def _bounds(self) -> tuple[Array, Array]:
        """(n_bounded,) each: bounds of the `bounded` unknowns over their prior standard deviations."""
        limits = np.array([(self.unknowns[i].low, self.unknowns[i].high) for i in self.bounded]).reshape(-1, 2)
        low, high = limits.T / self.sd[self.bounded]
        return low, high

    @cached_property
    def marginal(self) -> tuple[Array, Array, float]:
        """Nuisance integrated out: Gram matrix of the others, G_en (G_nn + S^-2)^-1, ln det(1 + S G S) / 2."""
        n = self.nuisance
        sd = self.sd[:n]
        projection = self.gram[n:, :n] @ self.inverse
        gram = self.gram[n:, n:] - projection @ self.gram[:n, n:]
        return gram, projection, float(np.linalg.slogdet(np.eye(n) + self.gram[:n, :n] * np.outer(sd, sd))[1] / 2)


@dataclass(frozen=True, eq=False)
class LinearModel(Brief):
    """d = J x + e with whitened ``data`` d (n,), e ~ N(0, 1), and priors and bounds of x."""

    design: DesignMatrix
    data: Array

    def with_data(self, data: Array) -> LinearModel:
        """The same model for other data."""
        return LinearModel(self.design, data)

    def without(self, unknowns: Sequence[Unknown]) -> LinearModel:
        """The model in which some unknowns are 0."""
        design = self.design
        kept = [column for column, unknown in enumerate(design.unknowns) if unknown not in unknowns]
        nuisance = sum(column < design.nuisance for column in kept)
        names = tuple(design.unknowns[column] for column in kept)
        return LinearModel(DesignMatrix(names, nuisance, design.jacobian[:, kept]), self.data)

    @property
    def jacobian(self) -> Array:
        """(n, k)."""
        return self.design.jacobian

    @cached_property
    def overlap(self) -> Array:
        """J^T d."""
        return np.asarray(self.jacobian.T @ self.data)

    def log_evidence(self, members: Members) -> float:
        """ln p(d | the members' amplitudes and the nuisance), up to a constant of the data."""
        design, n = self.design, self.design.nuisance
        overlap, fixed = self.overlap, 0.0
        present = design.columns([unknown for member in members for unknown in member.presence])
        if len(present):
            # The signal of effects without amplitude is subtracted from the data: d' = d - J 1.
            overlap = overlap - design.gram[:, present].sum(axis=1)
            fixed = float(self.overlap[present].sum() - design.gram[np.ix_(present, present)].sum() / 2)
        gram, projection, half = design.marginal
        mean, at_bounds = design.inverse @ overlap[:n], design.bounded
        of_nuisance = fixed - half + float(overlap[:n] @ mean) / 2
        variance = np.diag(design.inverse)[at_bounds]
        unknowns = [unknown for member in members for unknown in member.amplitudes]
        if not unknowns:
            return of_nuisance + float(design.nuisance_mass(mean[at_bounds], variance))
        at = design.columns(unknowns) - n
        limits = np.array([(unknown.low, unknown.high) for unknown in unknowns])
        reduced, sd = overlap[n:][at] - projection[at] @ overlap[:n], design.sd[n:][at]
        solved = posterior(gram[np.ix_(at, at)], reduced, sd, *limits.T)
        # The bounds of base numbers and sensors count as those of amplitudes do, from the posterior without any.
        rows, wide = projection[np.ix_(at, at_bounds)], solved.covariance
        free = wide @ reduced
        mass = design.nuisance_mass(
            mean[at_bounds] - free @ rows, variance + np.einsum("in,ij,jn->n", rows, wide, rows)
        )
        return of_nuisance + solved.log_evidence + float(mass)

    def least_misfit(self, members: Members) -> float:
        """min |d - J x|^2 + |x/sd|^2 over the members' amplitudes and the nuisance."""
        design = self.design
        present = design.columns([unknown for member in members for unknown in member.presence])
        data = self.data - self.jacobian[:, present].sum(axis=1)
        amplitudes = [unknown for member in members for unknown in member.amplitudes]
        unknowns = [*design.unknowns[: design.nuisance], *amplitudes]
        at = design.columns(unknowns)
        limits = np.array([(unknown.low, unknown.high) for unknown in unknowns]).reshape(-1, 2)
        J, sd = self.jacobian[:, at], design.sd[at]
        x = posterior(design.gram[np.ix_(at, at)], J.T @ data, sd, *limits.T).mean
        r = data - J @ x
        return float(r @ r + ((x / sd) ** 2).sum())

    @property
    def constant(self) -> float:
        """-|d|^2/2, needed to compare evidences of models about different points."""
        return float(-self.data @ self.data / 2)
