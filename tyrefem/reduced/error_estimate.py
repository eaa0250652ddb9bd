"""Estimated error of every reduced variant, from the residual of its heat balance on further modes.

W = (V, further modes of the snapshots). With the reduced solution u = V a, its rate and the balance on W,

    (M / tau + A) c = G(t, u) - A u + B g - M V a'      on W,      tau = 0.1 of a phase,

c is what an implicit step would add: `reduced.residual` solves the same on the full mesh, here W has one and a half
times as many unknowns as V. A hierarchical estimator (Hain, Ohlberger, Radic & Urban 2019, Adv. Comput. Math. 45): an
error outside of W is not seen, so its coverage is measured (docs/evidence/reduced.md).
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tyrefem.geometry.meshing.sagitta import kept_inside
from tyrefem.reduced.balance import ReducedBalance
from tyrefem.reduced.batch import steady
from tyrefem.reduced.budget import by_shape
from tyrefem.reduced.shared_product import shared_product
from tyrefem.reduced.solution import BatchSolution
from tyrefem.simulation.sensors import true_places

Array = NDArray[np.float64]
#: Parts of a phase at which the residual is evaluated; tau over the phase's duration.
PARTS, TAU = np.array([0.01, 0.03, 0.1, 0.25, 0.5, 1.0]), 0.1
#: Number of the part whose films are in the matrix.
MIDDLE = 2
#: The estimate is so many times the largest step at sensors and at the nodes that get hottest: with 1.6 it held on all
#: of 200 variants of seven numbers, with 1.75 on 200 others, too.
SAFETY_FACTOR = 1.75


def estimated_errors(solution: BatchSolution) -> Array | None:
    """Estimated error of temperatures at sensors and at the hottest places, (B,) K; None: the model has no further
    modes."""
    batch = solution.batch
    if batch.model.further is None:
        return None
    drive, largest = batch.balances[0].alike.drive, np.zeros(len(batch.balances))
    residual = _Residual(solution)
    places: list[Array] = []
    for number, (start, end) in enumerate(pairwise([*drive.starts, drive.end])):
        times = start + PARTS * (end - start) * (1 - 1e-9)
        steps, of_reservoirs = residual.steps(number, times, TAU * (end - start))
        places = places or _places(residual)
        at = np.array([np.abs(rows @ step).max() for rows, step in zip(places, steps, strict=True)])
        largest = np.maximum(largest, np.maximum(at, np.abs(of_reservoirs).max(axis=(1, 2), initial=0.0)))
    return SAFETY_FACTOR * largest


class _Residual:
    """Residual of a batch's solution on the further modes F, and what an implicit step makes of it.

    The batch has the matrices on V and the reservoirs, (B, n, n). The rows of F are combined here: their columns are
    those of the batch's unknowns, then those of F.
    """

    def __init__(self, solution: BatchSolution) -> None:
        batch, m = solution.batch, solution.batch.model.size
        self.solution, self.batch, self.m = solution, batch, m
        self.enriched = [balance.on(balance.model.enriched) for balance in batch.balances]
        size, n = self.enriched[0].model.size, len(batch.balances[0].start)
        order = [*range(m), *range(size, size + n - m), *range(m, size)]
        self.n = n

        def rows(matrices: Array) -> Array:
            return matrices[..., m:size, order]

        self.films = by_shape(self.enriched, lambda balance: rows(balance.stack))
        self.loads = by_shape(self.enriched, lambda balance: balance.loads[:, m:size])
        self.source_load = by_shape(self.enriched, lambda balance: balance.model.load[m:])
        regions = list(batch.model.mass)
        along, across, capacity = np.array(
            [[balance.bodies[region] for region in regions] for balance in batch.balances]
        ).transpose(2, 0, 1)
        body = [*range(m), *range(m, size)]

        def of_bodies(matrices: Array) -> Array:
            # Reservoirs have no capacity or conduction in common with F.
            part = matrices[..., m:, body]
            return np.concatenate([part[..., :m], np.zeros((*part.shape[:-1], n - m)), part[..., m:]], axis=-1)

        masses = by_shape(self.enriched, lambda balance: of_bodies(balance.model.stacked[0]))
        conduction = by_shape(self.enriched, lambda balance: of_bodies(balance.model.stacked[1]))
        self.M = _combined(capacity, masses)
        self.K = _combined(along, conduction[:, :, 0]) + _combined(across, conduction[:, :, 1])

    def steps(self, number: int, times: Array, tau: float) -> tuple[Array, Array]:
        """Steps of (V, F), (B, m + f, k) K, and of the reservoirs, (B, reservoirs, k) K, at times of a phase."""
        batch, m, n = self.batch, self.m, self.n
        states, slopes = (each.transpose(1, 2, 0) for each in self.solution.states_and_slopes(times))
        constant = all(steady(balance, number) for balance in batch.balances)
        moments = [batch.boundary_data(float(t)) for t in (times[:1] if constant else times)]
        middle = moments[0 if constant else MIDDLE].films
        M, K = batch.matrices
        A, A_F = K + _combined(middle, batch.films), self.K + _combined(middle, self.films)
        q = batch.heat([float(t) for t in times], states[:, :m])
        right, right_F = shared_product(batch.source_load, q), shared_product(self.source_load, q)
        right = np.concatenate([right, np.zeros((len(right), n - m, len(times)))], axis=1)
        right -= A @ states + M @ slopes
        right_F -= A_F[:, :, :n] @ states + self.M[:, :, :n] @ slopes
        for i, moment in enumerate(moments):
            given = (moment.films * moment.sinks)[:, None]
            columns = slice(None) if constant else slice(i, i + 1)
            right[:, :, columns] += moment.constant[:, :, None]
            right_F[:, :, columns] += (given @ self.loads).transpose(0, 2, 1)
            changed = moment.films - middle
            if changed.any():
                right[:, :, columns] -= _combined(changed, batch.films) @ states[:, :, columns]
                right_F[:, :, columns] -= _combined(changed, self.films)[:, :, :n] @ states[:, :, columns]
        H_F = self.M / tau + A_F
        # The batch's unknowns are eliminated: what is left is a system of F, a third of the whole.
        coupling = H_F[:, :, :n]
        both = np.concatenate([coupling.transpose(0, 2, 1), right], axis=2)
        window = self.solution.window_at(float(times[0]))
        if constant:
            # The batch has solved the eigenproblem of these A and M: H is diagonal in its eigenvectors.
            scale = 1 / (1 / tau + window.decay)[:, :, None]
            known = window.back @ (scale * (window.back.transpose(0, 2, 1) @ both))
        else:
            known = np.linalg.solve(M / tau + A, both)
        f = coupling.shape[1]
        further = np.linalg.solve(H_F[:, :, n:] - coupling @ known[:, :, :f], right_F - coupling @ known[:, :, f:])
        first = known[:, :, f:] - known[:, :, :f] @ further
        return np.concatenate([first[:, :m], further], axis=1), first[:, m:]


def _combined(coefficients: Array, matrices: Array) -> Array:
    """(B, i, j) sums of matrices (1 or B, c, i, j) with coefficients (B, c)."""
    if len(matrices) == 1:
        return np.asarray(np.tensordot(coefficients, matrices[0], axes=1))
    return np.asarray(np.einsum("bc,bcij->bij", coefficients, matrices, optimize=True))


def _places(residual: _Residual) -> list[Array]:
    """Rows of the modes of every variant, (k, m + f): see `_rows`."""
    balances = residual.enriched
    tyres = dict.fromkeys(balance.alike for balance in balances)
    sensors = {tuple(true_places(tyre.study).values()) for tyre in tyres}
    if len(residual.films) == 1 and len(sensors) == 1:
        return [_rows(balances[0])] * len(balances)
    return [_rows(balance) for balance in balances]


def _rows(balance: ReducedBalance) -> Array:
    """Rows of the modes at the sensors and at the nodes that were nearly the hottest in training."""
    model, study = balance.model, balance.alike.study
    hot = np.vstack(list(model.hot_rows.values()))
    places = np.array(list(true_places(study).values()))
    if not len(places):
        return hot
    return np.vstack([model.rows(kept_inside(model.base.mesh, places)), hot])
