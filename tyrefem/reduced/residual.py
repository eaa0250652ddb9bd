"""What the full model says of a reduced variant: a correction of its fields by one linear solve, without a run."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.loads import State
from tyrefem.conduction.ros34pw2 import GAMMA
from tyrefem.conduction.setup import balance_of
from tyrefem.conduction.stage_matrix import StageMatrices
from tyrefem.reduced.batch import Batch
from tyrefem.reduced.model import ReducedModel
from tyrefem.reduced.train import Snapshots, sources_at
from tyrefem.rolling import RollingTyre

Array = NDArray[np.float64]
#: Parts of a phase at which fields are corrected.
PARTS = np.array([0.02, 0.1, 0.3, 0.6, 1.0])
#: K, of the time integration of what is corrected.
TIME_TOLERANCE = 0.2


def corrected(model: ReducedModel, tyre: RollingTyre, share: float) -> tuple[Snapshots, float]:
    """Fields and heat sources of a variant as the full model corrects its reduced ones, and the largest correction, K.

    With the residual of the full heat balance at the reduced field u = V a and its rate V a',

        (M / tau + S) c = G(t, u) - S u + B g - M V a',

    u + c is what an implicit step of the full model makes of u: c is what the modes lack for this variant, over a time
    tau. Its size is an estimate of the error too.

    Parameters
    ----------
    share : tau over the duration of every phase.
    """
    balance = model.balance(tyre)
    marched = Batch(model, [balance], TIME_TOLERANCE).march()
    full = balance_of(model.operators, tyre.bodies, tyre.boundaries, tyre.sources, balance.reservoirs)
    matrices, m = StageMatrices(), model.size
    fields, sources, largest = [], [], 0.0
    for start, end in pairwise([*tyre.drive.starts, tyre.drive.end]):
        span = end - start
        times = start + PARTS * span * (1 - 1e-9)
        states, slopes = marched.states(times)[:, 0], marched.slopes(times)[:, 0]
        values, rates = (each[:, :m] @ model.V.T for each in (states, slopes))
        full.freeze(float(times[2]), State(values[2], states[2, m:]))
        tau = share * span
        matrix = matrices.get(full, tau / GAMMA)
        for i, t in enumerate(times):
            U = State(values[i], states[i, m:])
            G, Gg, _ = full.remainder(float(t), U)
            right = G - full.S @ U.u + full.B @ U.g - full.M @ rates[i]
            lumped = Gg + full.B.T @ U.u - full.D @ U.g - full.C * slopes[i, m:]
            rate, rate_g = np.zeros(len(U.u)), np.zeros(len(U.g))
            matrix.solve(right, lumped, np.zeros(0), rate, rate_g)
            largest = max(largest, float(np.abs(tau * rate).max()))
            fields.append(U.u + tau * rate)
            sources.append(sources_at(model.operators, tyre, float(t), fields[-1]))
    return Snapshots(np.array(fields), np.array(sources)), largest
