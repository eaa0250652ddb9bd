"""Steady states of the heat balance by Newton's method."""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import splu

from tyrefem.conduction.balance import HeatBalance
from tyrefem.conduction.errors import SolverError
from tyrefem.conduction.surface_loads import ConvectionLoad, FilmLoad, RadiationLoad
from tyrefem.conduction.terms import State
from tyrefem.errors import InputError

_MOST = 60


def solve_steady(balance: HeatBalance, y: State, t: float, tolerance: float = 1e-9) -> State:
    """Solve 0 = -S u + B g + G(t, u) from a first guess; `tolerance` is for the last correction, K.

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
    body, gas = balance.heat(t, y)
    return np.concatenate((body[balance.fixed.free], gas))


def _correction(balance: HeatBalance, t: float, y: State, residual: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Newton correction; slopes of user functions by differences in T."""
    balance.freeze(t, y)
    free = balance.fixed.free
    unknown = np.concatenate((free, y.u.size + np.arange(y.g.size)))
    J = balance.jacobian(t, y)[unknown][:, unknown]
    try:
        step = splu(J.tocsc()).solve(residual)
    except RuntimeError as error:
        raise SolverError("the steady problem is singular: some part has no way to lose heat") from error
    return step[: free.size], step[free.size :]


def anchored(balance: HeatBalance, outside: set[int], t: float) -> bool:
    """True if a given temperature fixes the level: by Fixed, film, convection, radiation, or through a reservoir.

    `outside` holds the numbers of reservoirs that exchange heat with a given temperature, directly or in a chain.
    """
    if balance.fixed.dofs.size:
        return True
    for load in balance.loads:
        if isinstance(load, ConvectionLoad) or (isinstance(load, RadiationLoad) and load.factor > 0):
            return True
        if isinstance(load, FilmLoad) and np.max(load.h(t)) > 0 and load.reservoir in (None, *outside):
            return True
    return False
