"""Correction of a reduced solution by the residual of the full model: one linear solve instead of a full run."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.balance import HeatBalance
from tyrefem.conduction.stage_matrix import GAMMA, StageMatrix
from tyrefem.conduction.statement import balance_of
from tyrefem.conduction.terms import State
from tyrefem.reduced.balance import reduced_balance
from tyrefem.reduced.batch import Batch
from tyrefem.reduced.integration import integrate
from tyrefem.reduced.model import ReducedModel
from tyrefem.reduced.solution import BatchSolution
from tyrefem.reduced.training import Snapshots, sources_at
from tyrefem.simulation.rolling_tyre import RollingTyre

Array = NDArray[np.float64]
#: Parts of a phase at which fields are corrected, and the part whose films are in the matrix.
PARTS, MIDDLE = np.array([0.02, 0.1, 0.3, 0.6, 1.0]), 0.3
#: s: the first corrected field lies within this time, as a surface responds within seconds; ratio of the early times.
EARLY, EARLY_RATIO = 15.0, 4.0
#: Relative error that the solver leaves to the next round, and its iterations at most.
REMAINING_ERROR, ITERATIONS = 0.1, 8
#: K, of the time integration of the reduced solution.
TIME_TOLERANCE = 0.2


def parts(span: float, early: float = EARLY) -> Array:
    """Parts of a phase at which its fields are corrected: `PARTS`, and earlier ones if the phase is long.

    Parameters
    ----------
    span : duration of the phase, s. early : the first corrected field lies within this time, s.

    >>> parts(600.0)
    array([0.02, 0.1 , 0.3 , 0.6 , 1.  ])
    >>> parts(10_800.0)[:3] * 10_800.0
    array([ 13.5,  54. , 216. ])
    """
    ends = list(PARTS)
    while ends[0] * span > early:
        ends.insert(0, ends[0] / EARLY_RATIO)
    return np.array(ends)


def corrected_tyre(
    model: ReducedModel, tyre: RollingTyre, share: float, early: float = EARLY
) -> tuple[Snapshots, float]:
    """`correction` of a tyre in a batch of one."""
    return correction(integrate(Batch(model, [reduced_balance(model, tyre)], TIME_TOLERANCE)), 0, share, early)


def correction(solution: BatchSolution, place: int, share: float, early: float = EARLY) -> tuple[Snapshots, float]:
    """Corrected fields and heat sources of a variant, and the largest correction, K.

    With the residual of the full heat balance at the reduced field u = V a and its rate V a',

        (M / tau + S) c = G(t, u) - S u + B g - M V a',

    u + c is the result of an implicit step tau of the full model from u. c is what the modes cannot represent. Its size
    estimates the error.

    Parameters
    ----------
    solution, place : solution of the variant's batch, and its place there. share : tau over the phase's duration.
    """
    balance = solution.batch.balances[place]
    tyre, model = balance.tyre, balance.model
    full = balance_of(model.operators, tyre.bodies, tyre.boundaries, tyre.sources, balance.reservoirs)
    m = model.size
    fields, sources, largest = [], [], 0.0
    for number, (start, end) in enumerate(pairwise([*tyre.drive.starts, tyre.drive.end])):
        span = end - start
        times = start + parts(span, early) * span * (1 - 1e-9)
        states, slopes = solution.states(times)[:, place], solution.slopes(times)[:, place]
        values, rates = (each[:, :m] @ model.V.T for each in (states, slopes))
        middle = len(times) - len(PARTS) + int(np.searchsorted(PARTS, MIDDLE))
        full.freeze(float(times[middle]), State(values[middle], states[middle, m:]))
        tau = share * span
        right, lumped = np.empty((len(model.V), len(times))), np.empty((len(full.C), len(times)))
        for i, t in enumerate(times):
            U = State(values[i], states[i, m:])
            G, Gg, _ = full.remainder(float(t), U)
            right[:, i] = G - full.S @ U.u + full.B @ U.g - full.M @ rates[i]
            lumped[:, i] = Gg + full.B.T @ U.u - full.D @ U.g - full.C * slopes[i, m:]
        change = tau * solved(full, nearby(model, number, share), tau, right, lumped).T
        largest = max(largest, float(np.abs(change).max()))
        fields += list(values + change)
        sources += [sources_at(model.operators, tyre, float(t), u) for t, u in zip(times, values + change, strict=True)]
    return Snapshots(np.array(fields), np.array(sources)), largest


def nearby(model: ReducedModel, number: int, share: float) -> StageMatrix:
    """The factored matrix of the model's base study in a phase, at most its last; kept with the model."""
    model = model.on_reference
    base = model.base
    number = min(number, len(base.drive.starts) - 1)

    def factored() -> StageMatrix:
        ends = [*base.drive.starts, base.drive.end]
        span = ends[number + 1] - ends[number]
        balance = reduced_balance(model, base)
        full = balance_of(model.operators, base.bodies, base.boundaries, base.sources, balance.reservoirs)
        even = State(np.full(len(model.V), base.drive.initial), balance.start[model.size :])
        full.freeze(ends[number] + MIDDLE * span * (1 - 1e-9), even)
        return StageMatrix(full, share * span / GAMMA)

    matrix: StageMatrix = model.stage_matrices.get((number, share), factored)
    return matrix


def solved(full: HeatBalance, near: StageMatrix, tau: float, right: Array, lumped: Array) -> Array:
    """Rates (n, k) of (M + tau S) rate = right, coupled with the reservoirs (lumped), by conjugate gradients.

    The factored matrix of a nearby study is the preconditioner: three or four solves replace a factorisation. The
    error that remains, `REMAINING_ERROR`, is left to the next round. Without convergence, or with another number of
    reservoirs than the nearby study, the variant's matrix is factored.
    """
    n = len(right)
    if near.m != len(lumped):
        return _solved_by(StageMatrix(full, tau / GAMMA), np.concatenate([right, lumped]), n)[:n]

    def times(x: Array) -> Array:
        u, g = x[:n], x[n:]
        product = full.M @ u + tau * (full.S @ u - full.B @ g)
        return np.concatenate([product, full.C[:, None] * g + tau * (full.D @ g - full.B.T @ u)])

    r = np.concatenate([right, lumped])
    # Scaled by heat capacity and conductance of each unknown: this measure of the residual costs no solve.
    scale = 1.0 / np.concatenate([full.M.diagonal() + tau * full.S.diagonal(), full.C + tau * np.diag(full.D)])
    x, p, before = np.zeros_like(r), np.zeros_like(r), np.full(r.shape[1], np.inf)
    enough = REMAINING_ERROR**2 * (scale @ r**2)
    for _ in range(ITERATIONS):
        z = _solved_by(near, r, n)
        rz = np.sum(r * z, axis=0)
        p = z + rz / np.maximum(before, 1e-300) * p
        q = times(p)
        a = rz / np.maximum(np.sum(p * q, axis=0), 1e-300)
        x += a * p
        r -= a * q
        before = rz
        if (scale @ r**2 <= enough).all():
            return x[:n]
    return _solved_by(StageMatrix(full, tau / GAMMA), np.concatenate([right, lumped]), n)[:n]


def _solved_by(matrix: StageMatrix, right: Array, n: int) -> Array:
    """Solution for columns of a factored matrix that is bordered by the reservoirs."""
    solution = matrix.factor.solve(np.asfortranarray(right[:n]))
    if not matrix.m:
        return np.asarray(solution)
    g = np.linalg.solve(matrix.schur, right[n:] + matrix.E.T @ right[:n])
    return np.concatenate([solution + matrix.E @ g, g])
