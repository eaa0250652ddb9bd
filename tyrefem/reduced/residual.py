"""What the full model says of a reduced variant: a correction of its fields by one linear solve, without a run."""

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
from tyrefem.reduced.exponential import Marched
from tyrefem.reduced.march import march
from tyrefem.reduced.model import ReducedModel
from tyrefem.reduced.training import Snapshots, sources_at
from tyrefem.simulation.rolling_tyre import RollingTyre

Array = NDArray[np.float64]
#: Parts of a phase at which fields are corrected, and the one whose exchanges its matrix has.
PARTS, MIDDLE = np.array([0.02, 0.1, 0.3, 0.6, 1.0]), 0.3
#: The first field of a phase is one of its first s: a surface answers within seconds, however long the phase lasts.
EARLY, EARLIER = 15.0, 4.0
#: Error of a correction that is left over to the next, and solves for it at most.
LEFT, ITERATIONS = 0.1, 8
#: K, of the time integration of what is corrected.
TIME_TOLERANCE = 0.2


def parts(span: float, early: float = EARLY) -> Array:
    """Parts of a phase of so many s at which its fields are corrected: `PARTS`, and in a long phase earlier ones.

    ``early``: the first of them lies within so many s.

    >>> parts(600.0)
    array([0.02, 0.1 , 0.3 , 0.6 , 1.  ])
    >>> parts(10_800.0)[:3] * 10_800.0
    array([ 13.5,  54. , 216. ])
    """
    ends = list(PARTS)
    while ends[0] * span > early:
        ends.insert(0, ends[0] / EARLIER)
    return np.array(ends)


def corrected(model: ReducedModel, tyre: RollingTyre, share: float, early: float = EARLY) -> tuple[Snapshots, float]:
    """`correction` of a variant that is marched alone."""
    return correction(march(Batch(model, [reduced_balance(model, tyre)], TIME_TOLERANCE)), 0, share, early)


def correction(marched: Marched, place: int, share: float, early: float = EARLY) -> tuple[Snapshots, float]:
    """Fields and heat sources of a variant as the full model corrects its reduced ones, and the largest correction, K.

    With the residual of the full heat balance at the reduced field u = V a and its rate V a',

        (M / tau + S) c = G(t, u) - S u + B g - M V a',

    u + c is what an implicit step of the full model makes of u: c is what the modes lack for this variant, over a time
    tau. Its size is an estimate of the error too.

    Parameters
    ----------
    marched, place : the variant's batch and its place there. share : tau over the duration of every phase.
    """
    balance, model = marched.batch.balances[place], marched.batch.model
    tyre = balance.tyre
    full = balance_of(model.operators, tyre.bodies, tyre.boundaries, tyre.sources, balance.reservoirs)
    m = model.size
    fields, sources, largest = [], [], 0.0
    for number, (start, end) in enumerate(pairwise([*tyre.drive.starts, tyre.drive.end])):
        span = end - start
        times = start + parts(span, early) * span * (1 - 1e-9)
        states, slopes = marched.states(times)[:, place], marched.slopes(times)[:, place]
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
    """The factored matrix of the study that the model was made for, in one of its phases; kept with the model."""

    def factored() -> StageMatrix:
        base = model.base
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
    """Rates (n, k) of (M + tau S) rate = right, the reservoirs (lumped) with it, by conjugate gradients.

    A variant's matrix is near the one that is factored: three or four solves take the place of a factorisation, and
    what is left, `LEFT` of a correction, is for the next round. Where it is not near, its own is factored.
    """
    n = len(right)

    def times(x: Array) -> Array:
        u, g = x[:n], x[n:]
        product = full.M @ u + tau * (full.S @ u - full.B @ g)
        return np.concatenate([product, full.C[:, None] * g + tau * (full.D @ g - full.B.T @ u)])

    r = np.concatenate([right, lumped])
    # Every unknown by its own heat capacity and conductance: a measure of what is left that costs no solve.
    scale = 1.0 / np.concatenate([full.M.diagonal() + tau * full.S.diagonal(), full.C + tau * np.diag(full.D)])
    x, p, before = np.zeros_like(r), np.zeros_like(r), np.full(r.shape[1], np.inf)
    enough = LEFT**2 * (scale @ r**2)
    for _ in range(ITERATIONS):
        z = _by(near, r, n)
        rz = np.sum(r * z, axis=0)
        p = z + rz / np.maximum(before, 1e-300) * p
        q = times(p)
        a = rz / np.maximum(np.sum(p * q, axis=0), 1e-300)
        x += a * p
        r -= a * q
        before = rz
        if (scale @ r**2 <= enough).all():
            return x[:n]
    return _by(StageMatrix(full, tau / GAMMA), np.concatenate([right, lumped]), n)[:n]


def _by(matrix: StageMatrix, right: Array, n: int) -> Array:
    """Solve a factored matrix, the reservoirs bordering it, for columns."""
    solution = matrix.factor.solve(np.asfortranarray(right[:n]))
    if not matrix.m:
        return np.asarray(solution)
    g = np.linalg.solve(matrix.schur, right[n:] + matrix.E.T @ right[:n])
    return np.concatenate([solution + matrix.E @ g, g])
