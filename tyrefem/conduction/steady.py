"""Steady states of the heat balance by Newton's method."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse import bmat, csr_matrix, diags
from scipy.sparse.linalg import splu

from tyrefem.conduction.balance import HeatBalance
from tyrefem.conduction.errors import SolverError
from tyrefem.conduction.loads import ConvectionLoad, SourceLoad, State
from tyrefem.conduction.surface_loads import FilmLoad, FluxLoad, RadiationLoad
from tyrefem.errors import InputError

_MOST = 60
_BUMP = 1e-4


def solve_steady(balance: HeatBalance, y: State, t: float, tolerance: float = 1e-9) -> State:
    """Solve 0 = -S u + B g + G(t, u) from a first guess; `tolerance` is the last correction in K.

    Raises SolverError if Newton's method with step halving does not converge.
    """
    fixed, free = balance.fixed.dofs, balance.fixed.free
    y = State(y.u.copy(), y.g.copy())
    y.u[fixed] = balance.fixed(t)
    balance.freeze(t, y)
    residual = _residual(balance, t, y)
    scale = max(float(np.max(np.abs(residual))), 1e-30)
    for _ in range(_MOST):
        du, dg = _correction(balance, t, y, residual)
        size = max(float(np.max(np.abs(du), initial=0)), float(np.max(np.abs(dg), initial=0)))
        if not size < 1e9:
            raise SolverError("the steady problem is singular: no temperature balances its sources and sinks")
        best, part = float(np.linalg.norm(residual)), 1.0
        while True:
            trial = State(y.u.copy(), y.g + part * dg)
            trial.u[free] += part * du
            left, now = _try(balance, t, trial)
            if now <= max((1 - 1e-4 * part) * best, 1e-13 * scale * left.size) or (size <= tolerance and now < np.inf):
                break
            part *= 0.5
            if part < 1e-6:
                if size < 1e-6:
                    return y
                raise SolverError(f"no steady state found: the heat residual stays at {best:.3g} W")
        y, residual = trial, left
        if size <= tolerance:
            return y
    raise SolverError(f"no steady state after {_MOST} iterations; the last correction was {size:.3g} K")


def _try(balance: HeatBalance, t: float, y: State) -> tuple[np.ndarray, float]:
    """Residual and its norm; infinite where a user's function cannot be evaluated."""
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            residual = _residual(balance, t, y)
            return residual, float(np.linalg.norm(residual))
    except InputError:
        return np.zeros(0), np.inf


def _residual(balance: HeatBalance, t: float, y: State) -> np.ndarray:
    G, Gg, _ = balance.remainder(t, y)
    ru = G - balance.S @ y.u + balance.B @ y.g
    rg = Gg + balance.B.T @ y.u - balance.D @ y.g
    return np.concatenate((ru[balance.fixed.free], rg))


def _correction(balance: HeatBalance, t: float, y: State, residual: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Newton's correction; slopes of user functions by differences in T."""
    balance.freeze(t, y)
    J: Any = balance.S
    for region in balance.conduction:
        k, bumped = region.values(y.u), region.values(y.u + _BUMP)
        for slope, back, a, b in zip(region.q.slopes, region.q.slopes_t, k, bumped, strict=True):
            J = J + back @ diags(region.q.weight * (b - a) / _BUMP * (slope @ y.u)) @ region.q.value
    for load in balance.loads:
        if isinstance(load, SourceLoad) and not load.static:
            J = J - balance.ops.matrix(load.slope(t, y.u, _BUMP))
        elif isinstance(load, FluxLoad) and load.of_temperature:
            dq = (load.value(t, y.u + _BUMP) - load.value(t, y.u - _BUMP)) / (2 * _BUMP)
            data = np.zeros(balance.ops.nnz)
            np.add.at(data, *load.s.exchange(load.s.weight * dq))
            J = J - balance.ops.matrix(data)
    free = balance.fixed.free
    J = J.tocsr()[free][:, free]
    if y.g.size:
        B = csr_matrix(balance.B[free])
        J = bmat([[J, -B], [-B.T, csr_matrix(balance.D)]])
    try:
        step = splu(J.tocsc()).solve(residual)
    except RuntimeError as error:
        raise SolverError("the steady problem is singular: some part has no way to lose heat") from error
    return step[: free.size], step[free.size :]


def anchored(balance: HeatBalance, outside: set[int], t: float) -> bool:
    """Whether a given temperature holds the body: fixed, by a film, convection or radiation, or through a reservoir.

    `outside` numbers the reservoirs that exchange heat, directly or in a chain, with a given temperature.
    """
    if balance.fixed.dofs.size:
        return True
    for load in balance.loads:
        if isinstance(load, ConvectionLoad) or (isinstance(load, RadiationLoad) and load.factor > 0):
            return True
        if isinstance(load, FilmLoad) and np.max(load.h(t)) > 0 and load.reservoir in (None, *outside):
            return True
    return False
