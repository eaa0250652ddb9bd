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

from tyrefem.geometry.wall import inside_mesh
from tyrefem.reduced.balance import ReducedBalance, matrices_of
from tyrefem.reduced.budget import by_shape
from tyrefem.reduced.solution import BatchSolution
from tyrefem.simulation.sensors import true_places

Array = NDArray[np.float64]
#: Parts of a phase at which the residual is evaluated; tau over the phase's duration.
PARTS, TAU = np.array([0.01, 0.03, 0.1, 0.25, 0.5, 1.0]), 0.1
#: The estimate is so many times the largest step at sensors and at the nodes that get hottest: with 1.6 it held on all
#: of 200 variants of seven numbers, with 1.75 on 200 others, too.
SAFETY_FACTOR = 1.75


def estimated_errors(solution: BatchSolution) -> Array | None:
    """Estimated error of temperatures at sensors and at the hottest places, (B,) K; None: the model has no further
    modes."""
    batch = solution.batch
    if batch.model.further is None:
        return None
    balances = [balance.on(balance.model.enriched) for balance in batch.balances]
    M, K = matrices_of(balances)
    m, size = batch.model.size, balances[0].model.size
    films, loads = (by_shape(balances, of) for of in (_films, _loads))
    source_load = by_shape(balances, lambda balance: balance.model.load)
    places = [_rows(balance) for balance in (balances if len(films) > 1 else balances[:1])]
    largest = np.zeros(len(balances))
    drive = balances[0].tyre.drive
    for start, end in pairwise([*drive.starts, drive.end]):
        times = start + PARTS * (end - start) * (1 - 1e-9)
        states, slopes = solution.states(times), solution.slopes(times)
        moments = [batch.boundary_data(float(t)) for t in times]
        A = K + _combined(moments[2].films, films)
        right = np.empty((*K.shape[:2], len(times)))
        for i, moment in enumerate(moments):
            y, rate = (_embedded(each[i], m, size) for each in (states, slopes))
            q = batch.heat([float(times[i])], states[i][:, :m, None])
            heat = _times(np.swapaxes(loads, 1, 2), moment.films * moment.sinks)
            heat[:, size:] += moment.powers
            heat[:, :size] += (source_load @ q)[:, :, 0]
            changed = moment.films - moments[2].films
            if changed.any():
                heat -= _times(_combined(changed, films), y)
            right[:, :, i] = heat - _times(A, y) - _times(M, rate)
        step = np.linalg.solve(M / (TAU * (end - start)) + A, right)
        for b, change in enumerate(step):
            at = places[b if len(places) > 1 else 0] @ change[:size]
            largest[b] = max(largest[b], float(np.abs(at).max()), float(np.abs(change[size:]).max(initial=0.0)))
    return SAFETY_FACTOR * largest


def _combined(coefficients: Array, matrices: Array) -> Array:
    """(B, n, n) sums of exchange matrices (1 or B, j, n, n) with coefficients (B, j)."""
    if len(matrices) == 1:
        return np.asarray(np.tensordot(coefficients, matrices[0], axes=1))
    return np.array([np.tensordot(h, each, axes=1) for h, each in zip(coefficients, matrices, strict=True)])


def _films(balance: ReducedBalance) -> Array:
    return balance.stack


def _loads(balance: ReducedBalance) -> Array:
    return balance.loads


def _times(matrices: Array, vectors: Array) -> Array:
    return np.asarray((matrices @ vectors[:, :, None])[:, :, 0])


def _embedded(states: Array, m: int, size: int) -> Array:
    """States (B, m + reservoirs) with zeros for the further modes."""
    further = np.zeros((len(states), size - m))
    return np.concatenate([states[:, :m], further, states[:, m:]], axis=1)


def _rows(balance: ReducedBalance) -> Array:
    """Rows of the modes at the sensors and at the nodes that were nearly the hottest in training."""
    model, study = balance.model, balance.tyre.study
    hot = np.vstack(list(model.hot_rows.values()))
    places = np.array(list(true_places(study).values()))
    if not len(places):
        return hot
    inside = inside_mesh(study.section, balance.tyre.mesh.size, *study.section.locate(places))
    return np.vstack([model.rows(inside), hot])
