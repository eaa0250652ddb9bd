"""Evidence of many sets of effects at once, in a linear model of whitened readings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.diagnose.inference.evidence import bounds_mass
from tyrefem.diagnose.inference.linear_model import DesignMatrix
from tyrefem.diagnose.unknowns.candidates import Members

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class _SameSize:
    """Sets ``rows`` (m,) with k amplitudes each: columns, bounds over sd, posterior covariance over sd, and more.

    ``shift`` (m, k): what effects without amplitude take from the overlaps. ``half``: ln det(1 + S G S) / 2.
    ``nuisance`` (m, k, b): change of the bounded nuisance; ``variance`` (m, b): of it, with the amplitudes unknown.
    """

    rows: NDArray[np.intp]
    columns: NDArray[np.intp]
    sd: Array
    low: Array
    high: Array
    covariance: Array
    spread: Array
    half: Array
    shift: Array
    nuisance: Array
    variance: Array


class SetEvidences(Brief):
    """ln p(d | set) of many sets for data d with given overlaps J^T d; `LinearModel.log_evidence` in arrays."""

    def __init__(self, design: DesignMatrix, sets: Sequence[Members]) -> None:
        self.design, self.sets = design, tuple(sets)
        n, bounded = design.nuisance, design.bounded
        _, projection, _ = design.marginal
        present = np.zeros((len(self.sets), len(design.unknowns)))
        amplitudes: dict[int, list[tuple[int, NDArray[np.intp]]]] = {}
        for row, members in enumerate(self.sets):
            present[row, design.columns([unknown for member in members for unknown in member.presence])] = 1.0
            columns = design.columns([unknown for member in members for unknown in member.amplitudes])
            amplitudes.setdefault(len(columns), []).append((row, columns))
        # The signal of effects without amplitude is subtracted from the data: d' = d - J 1.
        self._present = present
        self._shift = present @ design.gram
        self._fixed = np.einsum("sk,sk->s", present, self._shift) / 2
        self._mean_shift = self._shift[:, :n] @ design.inverse.T
        self._reduced_shift = self._shift[:, n:] - self._shift[:, :n] @ projection.T
        self._variance = np.diag(design.inverse)[bounded]
        self._groups = [self._group(each) for each in amplitudes.values()]

    def _title(self) -> str:
        return f"{len(self.sets)} sets"

    def _group(self, sets: list[tuple[int, NDArray[np.intp]]]) -> _SameSize:
        design, n = self.design, self.design.nuisance
        gram, projection, _ = design.marginal
        rows = np.array([row for row, _ in sets])
        at = np.array([columns for _, columns in sets], dtype=np.intp).reshape(len(sets), -1) - n
        k = at.shape[1]
        sd = design.sd[n:][at]
        limits = np.array([(unknown.low, unknown.high) for unknown in design.unknowns[n:]]).reshape(-1, 2)
        matrix = np.eye(k) + gram[at[:, :, None], at[:, None, :]] * sd[:, :, None] * sd[:, None, :]
        covariance: Array = np.asarray(np.linalg.inv(matrix), dtype=float)
        nuisance = projection[:, design.bounded][at]
        wide = covariance * sd[:, :, None] * sd[:, None, :]
        return _SameSize(
            rows,
            at,
            sd,
            limits[at, 0] / sd,
            limits[at, 1] / sd,
            covariance,
            np.sqrt(np.diagonal(covariance, axis1=1, axis2=2)),
            np.linalg.slogdet(matrix)[1] / 2,
            self._reduced_shift[rows[:, None], at],
            nuisance,
            self._variance + np.einsum("mib,mij,mjb->mb", nuisance, wide, nuisance),
        )

    def log_evidence(self, overlap: Array) -> Array:
        """(n_sets,) up to a constant of the data, for J^T d = ``overlap`` (k,)."""
        design, n = self.design, self.design.nuisance
        _, projection, half = design.marginal
        overlaps = overlap[:n] - self._shift[:, :n]
        means = design.inverse @ overlap[:n] - self._mean_shift
        result = self._present @ overlap - self._fixed - half + np.einsum("sn,sn->s", overlaps, means) / 2
        reduced = overlap[n:] - projection @ overlap[:n]
        bounded = means[:, design.bounded]
        for group in self._groups:
            right = group.sd * (reduced[group.columns] - group.shift)
            z = np.einsum("mij,mj->mi", group.covariance, right)
            inside = bounds_mass(z, group.spread, group.low, group.high).sum(axis=1)
            mean = bounded[group.rows] - np.einsum("mk,mkb->mb", z * group.sd, group.nuisance)
            mass = design.nuisance_mass(mean, group.variance)
            result[group.rows] += np.einsum("mk,mk->m", right, z) / 2 - group.half + inside + mass
        return result
