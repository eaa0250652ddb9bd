"""How a transient solution changes with parameters of the problem: tangents from the assembled operators."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from tyrefem.conduction.balance import HeatBalance
from tyrefem.conduction.loads import Load, SourceLoad, State
from tyrefem.conduction.operators import Operators
from tyrefem.conduction.points import located
from tyrefem.conduction.quick import GAMMA, StageSolver
from tyrefem.errors import InputError

if TYPE_CHECKING:
    from tyrefem.conduction.problem import Conduction

Array = NDArray[Any]


@dataclass(frozen=True)
class Perturbed:
    """A problem that differs from the base one by a small ``step`` of a parameter; ``initial``: its start, degC."""

    problem: Conduction
    step: float
    initial: float | None = None


@dataclass(frozen=True)
class Tangents:
    """d(temperature)/d(parameter).

    Attributes
    ----------
    times : (n_times,) s; values : (n_parameters, n_times, n) per unit of parameter at the unknowns.
    reservoirs : (n_parameters, n_times, n_reservoirs).
    """

    operators: Operators
    times: Array
    values: Array
    reservoirs: Array

    def at(self, points: Any) -> Array:
        """Tangents at points (n_points, 2): (n_parameters, n_times, n_points)."""
        value = located(self.operators, points).value()
        parameters, times, size = self.values.shape
        return (value @ self.values.reshape(-1, size).T).T.reshape(parameters, times, -1)


def stage_times(breaks: Sequence[float], first: float = 3.0, growth: float = 1.7, longest: float = 80.0) -> Array:
    """Times at which `tangents` wants the base solution: every step's start, first stage and end.

    Steps grow from ``first`` (s) by ``growth`` to ``longest`` after every break, where data jump; breaks include the
    first and the last time.

    >>> stage_times([0.0, 10.0], first=4.0, growth=1.5).round(2)
    array([ 0.  ,  1.17,  4.  ,  5.76, 10.  ])
    """
    times = [float(breaks[0])]
    for start, end in pairwise(breaks):
        sizes: list[float] = []
        while sum(sizes) < end - start:
            sizes.append(min(first * growth ** len(sizes), longest))
        scale = (end - start) / sum(sizes)
        if len(sizes) > 1 and scale < 0.75:  # the last step would overshoot by far: spread what is left
            sizes = sizes[:-1]
            scale = (end - start) / sum(sizes)
        t = start
        for number, size in enumerate(sizes):
            step = size * scale
            last = end if number == len(sizes) - 1 else t + step
            times += [t + GAMMA * (last - t), last]
            t = last
    return np.array(times)


def tangents(
    base: Conduction, times: Array, values: Array, reservoirs: Array, perturbed: Sequence[Perturbed]
) -> Tangents:
    """Tangents along a known solution of ``base``.

    M ds/dt = -(dF/du) s + [F(y; p + step) - F(y; p)]/step - (dM/dp) du/dt, linear in s, so that all parameters share
    one factorisation per step. dF/du holds conduction, films and the sources' slopes with temperature.

    Parameters
    ----------
    base : the problem; its boundaries may not be `Fixed`.
    times : (n_times,) s as `stage_times` gives them; values (n_times, n), reservoirs (n_times, m): the solution there.
    perturbed : the same problem on the same mesh object with one parameter changed each.

    Raises
    ------
    InputError : another mesh or element, or a fixed boundary.
    """
    ops = base.operators
    for one in perturbed:
        if one.problem.operators is not ops:
            raise InputError("a perturbed problem must be on the base problem's own mesh", field="perturbed")
    with threadpool_limits(1, user_api="blas"):
        return _march(base, times, values, reservoirs, perturbed)


def _march(
    base: Conduction, times: Array, values: Array, reservoirs: Array, perturbed: Sequence[Perturbed]
) -> Tangents:
    ops, n, m, count = base.operators, base.operators.size, reservoirs.shape[1], len(perturbed)
    balance, reference = base._balance(), base._balance()
    if balance.fixed.dofs.size:
        raise InputError("tangents need a problem without Fixed boundaries", field="boundaries")
    others = [one.problem._balance() for one in perturbed]
    heat = balance.reservoir_capacity(reservoirs[0])
    start_state = State(values[0], reservoirs[0])
    for each in (reference, *others):
        each.freeze(float(times[0]), start_state)
    direct = [_Direct(reference, other, one.step) for other, one in zip(others, perturbed, strict=True)]
    ordering = ops.ordering(np.arange(n))
    s = np.zeros((n + m, count))
    for column, one in enumerate(perturbed):
        if one.initial is not None:
            s[:, column] = (one.initial - values[0, 0]) / one.step
    found = np.zeros((len(times), n + m, count))
    found[0] = s
    for first in range(0, len(times) - 1, 2):
        h = times[first + 2] - times[first]
        # Data are seen from inside the step: a jump at its end belongs to the next one.
        inside = [times[first + 1], times[first + 2] - 1e-9 * max(1.0, times[first + 2])]
        slopes: list[Array] = []
        for stage, t in enumerate(inside):
            y = State(values[first + 1 + stage], reservoirs[first + 1 + stage])
            if stage == 0:
                balance.freeze(t, y)
                solve = StageSolver(ordering, balance, GAMMA * h, heat)
            forcing = _forcing(balance, direct, t, y, heat)
            source = _source_slope(balance, t, y)
            start = s + (1 - GAMMA) * h * slopes[0] if stage else s
            right = forcing - _linear(balance, start)
            guess = slopes[0] if stage else solve(right)
            # The slope of the sources is small against the rest: one correction of a guess takes it in.
            for _ in range(2):
                hot = start + GAMMA * h * guess
                extra = np.zeros_like(right)
                extra[:n] = source(hot[:n])
                guess = solve(right + extra)
            slopes.append(guess)
            found[first + 1 + stage] = start + GAMMA * h * guess
        s = found[first + 2]
    return Tangents(ops, np.asarray(times), found[:, :n].transpose(2, 0, 1), found[:, n:].transpose(2, 0, 1))


def _linear(balance: HeatBalance, s: Array) -> Array:
    n = balance.ops.size
    body, gas = s[:n], s[n:]
    return np.vstack([balance.S @ body - balance.B @ gas, balance.D @ gas - balance.B.T @ body])


def _rate(balance: HeatBalance, t: float, y: State) -> Array:
    """Heat into every unknown, W; exact wherever the linear part was frozen."""
    G, Gg, _ = balance.remainder(t, y)
    body = G - balance.S @ y.u + balance.B @ y.g
    return np.concatenate([body, Gg + balance.B.T @ y.u - balance.D @ y.g])


class _Direct:
    """What one parameter changes in the heat of every unknown: only loads that differ are evaluated.

    Both problems are frozen at the same state, so that what they have in common drops out exactly.
    """

    def __init__(self, base: HeatBalance, other: HeatBalance, step: float) -> None:
        self.base, self.other, self.step = base, other, step
        ours = {id(load.cause) for load in base.acting if load.cause is not None}
        theirs = {id(load.cause) for load in other.acting if load.cause is not None}
        self.added = [load for load in other.acting if id(load.cause) not in ours or load.cause is None]
        self.gone = [load for load in base.acting if id(load.cause) not in theirs or load.cause is None]
        self.S = None if np.array_equal(base.S_data, other.S_data) else base.ops.matrix(other.S_data - base.S_data)
        self.B = None if np.array_equal(base.B, other.B) else other.B - base.B
        self.D = None if np.array_equal(base.D, other.D) else other.D - base.D

    def rate(self, t: float, y: State, lost: Callable[[Load], Array]) -> Array:
        """(n + m,) W per unit of the parameter; ``lost`` (n + m,): heat by a load of the base problem."""
        heat = np.zeros(y.u.size + y.g.size)
        body, gas = heat[: y.u.size], heat[y.u.size :]
        for load in self.added:
            load.remainder(t, y, body, gas)
        for load in self.gone:
            heat -= lost(load)
        if self.S is not None:
            body -= self.S @ y.u
        if self.B is not None:
            body += self.B @ y.g
            gas += self.B.T @ y.u
        if self.D is not None:
            gas -= self.D @ y.g
        return heat / self.step


def _forcing(balance: HeatBalance, direct: Sequence[_Direct], t: float, y: State, heat: Array) -> Array:
    """(n + m, n_parameters): what each parameter does directly, per unit of it."""
    n = y.u.size
    found = np.zeros((n + heat.size, len(direct)))
    own = _rate(balance, t, y)
    slope: Array | None = None

    @functools.cache
    def lost(load: Load) -> Array:
        heat = np.zeros(len(found))
        load.remainder(t, y, heat[:n], heat[n:])
        return heat

    for column, one in enumerate(direct):
        found[:, column] = one.rate(t, y, lost)
        other = one.other
        if other.variable_capacity:
            other.M_data = other.mass(y.u)
        changed = not np.array_equal(other.M_data, balance.M_data)
        if changed:
            if slope is None:
                slope = balance.ops.ordering(np.arange(n)).factor(balance.M_data).solve(own[:n].copy())
            found[:n, column] -= balance.ops.matrix(other.M_data - balance.M_data) @ slope / one.step
        capacity = other.reservoir_capacity(y.g)
        found[n:, column] -= (capacity - heat) / one.step * own[n:] / np.where(heat > 0, heat, 1.0)
    return found


def _source_slope(balance: HeatBalance, t: float, y: State) -> Any:
    """(d load / d temperature) as a function of tangents (n, n_parameters)."""
    parts = []
    for load in balance.loads:
        if isinstance(load, SourceLoad) and not load.static:
            step = 0.1
            slope = (load.at_nodes(t, y.u + step) - load.at_nodes(t, y.u - step)) / (2 * step)
            parts.append((load, slope[:, None]))

    def apply(s: Array) -> Array:
        total = np.zeros_like(s)
        for load, slope in parts:
            total += load.matrix @ (slope * s[load.dofs])
        return total

    return apply
