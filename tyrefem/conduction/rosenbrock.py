"""One step of the linearly implicit Rosenbrock-W method ROS34PW2 for the heat balance.

The module holds its coefficients, those of its continuous extension, and mass solves.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.conduction.balance import HeatBalance
from tyrefem.conduction.stage_matrix import GAMMA, StageMatrix
from tyrefem.conduction.terms import State

Array = NDArray[Any]


# Rang & Angermann, BIT 45 (2005) 761-787, ROS34PW2: order 3 for any Jacobian approximation, L-stable.
ALPHA = np.array(
    [
        [0.0, 0.0, 0.0, 0.0],
        [0.87173304301691801, 0.0, 0.0, 0.0],
        [0.84457060015369423, -0.11299064236484185, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ]
)
LOWER = np.array(
    [
        [GAMMA, 0.0, 0.0, 0.0],
        [-0.87173304301691801, GAMMA, 0.0, 0.0],
        [-0.90338057013044082, 0.054180672388095326, GAMMA, 0.0],
        [0.24212380706095346, -1.2232505839045147, 0.54526025533510214, GAMMA],
    ]
)
WEIGHT = np.array([0.24212380706095346, -1.2232505839045147, 1.5452602553351020, GAMMA])
EMBEDDED = np.array([0.37810903145819369, -0.096042292212423178, 0.5, 0.2179332607542295])
NODE, SHIFT = ALPHA.sum(axis=1), LOWER.sum(axis=1)


def _dense_weights() -> Array:
    """W with b(theta) = W @ (theta, theta^2, theta^3), from the third-order conditions of the partial step.

    sum b = theta, sum b alpha = theta^2/2, sum b gamma = 0, sum b beta beta = theta^3/6; b(1) is WEIGHT.
    """
    beta = ALPHA + LOWER
    conditions = np.array([np.ones(4), NODE, SHIFT, beta @ beta.sum(axis=1)])
    right = np.array([[1, 0, 0], [0, 1 / 2, 0], [0, 0, 0], [0, 0, 1 / 6]])
    return np.linalg.solve(conditions, right)


DENSE = _dense_weights()


def dense_weights(theta: float) -> Array:
    """Stage weights (4,) of the solution at the fraction theta of a step.

    >>> bool(np.allclose(dense_weights(1.0), WEIGHT))
    True
    """
    return WEIGHT if theta >= 1.0 else DENSE @ np.array([theta, theta**2, theta**3])


def conjugate_gradients(M: Any, right: Array, tolerance: float = 1e-11) -> Array:
    """Solution of a mass matrix, which is well conditioned after scaling by its diagonal."""
    scale = 1.0 / M.diagonal()
    x = scale * right
    r = right - M @ x
    z = scale * r
    p, rz = z.copy(), float(r @ z)
    goal = tolerance**2 * float(right @ (scale * right))
    for _ in range(500):
        if rz <= goal:
            break
        q = M @ p
        a = rz / float(p @ q)
        x += a * p
        r -= a * q
        z = scale * r
        rz, old = float(r @ z), rz
        p = z + (rz / old) * p
    return x


class Step:
    """The stages of one step from state y at t, and the solution, energies and slopes from them."""

    def __init__(self, balance: HeatBalance, t: float, h: float, y: State) -> None:
        n, m, ledger = y.u.size, y.g.size, len(balance.entries)
        self.balance, self.t, self.h, self.y = balance, t, h, y
        self.ku, self.kg, self.P = np.zeros((4, n)), np.zeros((4, m)), np.zeros((4, ledger))

    def run(self, matrix: StageMatrix, first: float, last: float) -> float:
        """Compute the stages with data from `first` to `last` only; return the error estimate, K."""
        b, t, h, y = self.balance, self.t, self.h, self.y
        ku, kg, gh = self.ku, self.kg, GAMMA * h
        fixed = b.fixed.dofs
        start = min(max(t, first), last)
        later = min(start + 1e-3 * h, last)
        slope = b.time_slope(start, y, later - start)
        fixed_slope = np.zeros(fixed.size)
        if fixed.size and not b.fixed.constant:
            fixed_slope = (b.fixed(later) - b.fixed(start)) / (later - start)
        k_fixed = np.zeros(0)
        for i in range(4):
            ti = min(max(t + NODE[i] * h, first), last)
            U = State(y.u + h * (ALPHA[i, :i] @ ku[:i]), y.g + h * (ALPHA[i, :i] @ kg[:i])) if i else y
            b.balance_massless(ti, U.u, U.g)
            W = State(h * (LOWER[i, :i] @ ku[:i]), h * (LOWER[i, :i] @ kg[:i]))
            V = State(U.u + W.u, U.g + W.g)
            G, Gg, P = b.remainder(ti, U)
            if b.variable_capacity:
                rate = self._rate(U, G, b.B @ U.g, max(ti - (later - start), first), later - start)
                ru = b.M @ rate - b.S @ W.u + b.B @ W.g
            else:
                ru = G - b.S @ V.u
                if b.m:
                    ru += b.B @ V.g
            rg = Gg + b.B.T @ V.u - b.D @ V.g
            if b.variable_reservoirs:
                true = Gg + b.B.T @ U.u - b.D @ U.g
                rg[b.massive] += true[b.massive] * (b.C / np.where(b.C, b.reservoir_capacity(U.g), 1) - 1)[b.massive]
            if slope is not None:
                factor = h * SHIFT[i]
                ru += factor * slope[0]
                rg += factor * slope[1]
                P += factor * slope[2]
                G = G + factor * slope[0]
            if fixed.size:
                target = b.fixed(ti) + h * SHIFT[i] * fixed_slope
                k_fixed = (target - V.u[fixed]) / gh
            matrix.solve(ru, rg, k_fixed, ku[i], kg[i])
            V.u += gh * ku[i]
            V.g += gh * kg[i]
            b.add_linear_powers(V, P)
            if fixed.size and not b.variable_capacity:
                r = b.M_fixed @ ku[i] + b.S_fixed @ V.u - b.B[fixed] @ V.g - G[fixed]
                for slot, part in b.fixed.parts:
                    P[slot] = r[part].sum()
            elif fixed.size:
                P += b.reaction(ti, U, rate)
            self.P[i] = P
        difference = h * ((WEIGHT - EMBEDDED) @ ku)
        error = float(np.max(np.abs(difference[b.fixed.free]), initial=0.0))
        if b.rated.size:
            error = max(error, float(np.max(np.abs(h * ((WEIGHT - EMBEDDED) @ kg))[b.rated])))
        return error if np.isfinite(error) else np.inf

    def _rate(self, U: State, G: Array, border: Array, before: float, dt: float) -> Array:
        """du/dt with the exact M(U), by conjugate gradients scaled with the diagonal."""
        b = self.balance
        M, free, fixed = b.ops.matrix(b.mass(U.u)), b.fixed.free, b.fixed.dofs
        rate = np.zeros(U.u.size)
        right = G - b.S @ U.u + border
        if fixed.size:
            rate[fixed] = (b.fixed(before + dt) - b.fixed(before)) / dt if not b.fixed.constant else 0.0
            right = right - M @ rate
            M = M[free][:, free]
        rate[free] = conjugate_gradients(M, right[free])
        return rate

    def at(self, theta: float) -> State:
        """The state at t + theta h, by the method's continuous extension."""
        weights = dense_weights(theta)
        return State(self.y.u + self.h * (weights @ self.ku), self.y.g + self.h * (weights @ self.kg))

    def energies(self, theta: float) -> Array:
        """Energy of every ledger entry from t to t + theta h, J; consistent with `at` to rounding."""
        weights = dense_weights(theta)
        return self.h * (weights @ self.P)

    def slope(self, theta: float) -> Array:
        """du/dt at t + theta h."""
        return (DENSE @ np.array([1.0, 2 * theta, 3 * theta**2])) @ self.ku
