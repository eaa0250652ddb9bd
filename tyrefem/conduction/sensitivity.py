"""Sensitivities of a transient solution to parameters of the problem, from the assembled operators."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from tyrefem.conduction.balance import HeatBalance
from tyrefem.conduction.direct_sensitivity import DirectHeat
from tyrefem.conduction.fixed_steps import GAMMA, StageSolver
from tyrefem.conduction.operators import Operators
from tyrefem.conduction.points import located
from tyrefem.conduction.sources import SourceLoad
from tyrefem.conduction.surface_loads import FluxLoad
from tyrefem.conduction.terms import State
from tyrefem.errors import InputError
from tyrefem.threads import one_thread

if TYPE_CHECKING:
    from tyrefem.conduction.problem import Conduction

Array = NDArray[Any]

#: Half the temperature difference for slopes of sources and heat capacities, K.
_BUMP = 0.1


@dataclass(frozen=True)
class Perturbed:
    """A problem with a parameter changed by a small ``step``; ``initial``: initial temperature, degC."""

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
        """Sensitivities at points (n_points, 2): (n_parameters, n_times, n_points)."""
        value = located(self.operators, points).value()
        parameters, times, size = self.values.shape
        return (value @ self.values.reshape(-1, size).T).T.reshape(parameters, times, -1)


def stage_times(breaks: Sequence[float], first: float = 3.0, growth: float = 1.7, longest: float = 80.0) -> Array:
    """Times at which `tangents` needs the base solution: start, first stage and end of every step.

    Steps grow from ``first`` (s) by ``growth`` to ``longest`` after every break, where data jump. Breaks include the
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
        if len(sizes) > 1 and scale < 0.75:  # the last step would be far too long: distribute the rest
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
    """Sensitivities along a known solution of ``base``.

    M ds/dt = -(dF/du) s + [F(y; p + step) - F(y; p)]/step - (dM/dp) du/dt is linear in s: all parameters share one
    factorisation per step. dF/du contains conduction, films and the temperature slopes of sources, fluxes,
    conductivities and heat capacities.

    Parameters
    ----------
    base : the problem, without `Fixed` boundaries.
    times : (n_times,) s from `stage_times`; values (n_times, n), reservoirs (n_times, m): the solution at these times.
    perturbed : problems on the same mesh object, each with one changed parameter.

    Raises
    ------
    InputError : another mesh or element, or a fixed boundary.
    """
    ops = base.operators
    for column in perturbed:
        if base.states is not None or column.problem.states is not None:
            raise InputError("states that follow a rate have no tangents: simulate again", field="states")
        if column.problem.operators is not ops:
            raise InputError("a perturbed problem must be on the base problem's own mesh", field="perturbed")
    with one_thread():
        direct = _direct(base, times, values, reservoirs, perturbed)
        s = np.zeros((ops.size + reservoirs.shape[1], len(perturbed)))
        for number, perturbation in enumerate(perturbed):
            initial = values[0, 0] if perturbation.initial is None else perturbation.initial
            given = [each.initial for each in perturbation.problem.reservoirs.values()]
            known = [each.initial for each in base.reservoirs.values()]
            starts = [
                initial if new is None and old is None else reservoirs[0, k] if new is None else new
                for k, (new, old) in enumerate(zip(given, known, strict=True))
            ]
            s[: ops.size, number] = (initial - values[0, 0]) / perturbation.step
            s[ops.size :, number] = (np.array(starts, dtype=float) - reservoirs[0]) / perturbation.step
        return _integrate(base, times, values, reservoirs, direct, direct.rate, s)


def tangents_over_time(
    base: Conduction, times: Array, values: Array, reservoirs: Array, sources: Sequence[Perturbed], knots: Array
) -> Tangents:
    """Sensitivities to sources whose strength follows a hat function of time, 1 at one knot and 0 at the others.

    M ds/dt = -(dF/du) s + h_k(t) [F(y; p + step) - F(y; p)]/step with the hat h_k of knot k. Before the first and after
    the last knot the strength stays constant, so the hats of a source add up to a constant source.

    Parameters
    ----------
    times, values, reservoirs : see `tangents`; a time step must be shorter than the distance of two knots.
    sources : problems with a source of strength ``step`` at all times. knots : (n_knots,) s, increasing.

    Returns
    -------
    Tangents with the parameters (source 1 at knot 1, source 1 at knot 2, ...).
    """
    with one_thread():
        direct = _direct(base, times, values, reservoirs, sources)
        hats = np.eye(len(knots))

        def heat(t: float, y: State) -> Array:
            now = np.array([np.interp(t, knots, hat) for hat in hats])
            return np.asarray((direct(t, y)[:, :, None] * now).reshape(len(values[0]) + y.g.size, -1))

        start = np.zeros((base.operators.size + reservoirs.shape[1], len(sources) * len(knots)))
        return _integrate(base, times, values, reservoirs, heat, direct.rate, start)


def _direct(
    base: Conduction, times: Array, values: Array, reservoirs: Array, perturbed: Sequence[Perturbed]
) -> DirectHeat:
    """Direct effect of the parameters on the heat balance."""
    if base._balance().fixed.dofs.size:
        raise InputError("tangents need a problem without Fixed boundaries", field="boundaries")
    return DirectHeat(
        base._balance(),
        [perturbation.problem._balance() for perturbation in perturbed],
        [perturbation.step for perturbation in perturbed],
        float(times[0]),
        State(values[0], reservoirs[0]),
    )


def _integrate(
    base: Conduction,
    times: Array,
    values: Array,
    reservoirs: Array,
    direct: Callable[[float, State], Array],
    rate: Callable[[float, State], Array],
    s: Array,
) -> Tangents:
    """Integrate the sensitivities from ``s`` (n + m, count) at the start; ``direct``: right side, ``rate``: du/dt."""
    ops, n, count = base.operators, base.operators.size, s.shape[1]
    m = len(s) - n
    balance = base._balance()
    heat = balance.reservoir_capacity(reservoirs[0])
    ordering = ops.ordering(np.arange(n))
    derivatives = np.zeros((len(times), n + m, count))
    derivatives[0] = s
    for first in range(0, len(times) - 1, 2):
        h = times[first + 2] - times[first]
        # Data are limits from inside the step: a jump at its end belongs to the next step.
        inside = [times[first + 1], times[first + 2] - 1e-9 * max(1.0, times[first + 2])]
        slopes: list[Array] = []
        for stage, t in enumerate(inside):
            y = State(values[first + 1 + stage], reservoirs[first + 1 + stage])
            if stage == 0:
                balance.freeze(t, y)
                solve = StageSolver(ordering, balance, GAMMA * h, heat)
            slope = _slope(balance, t, y, rate(t, y) if balance.variable_capacity else None)
            start = s + (1 - GAMMA) * h * slopes[0] if stage else s
            right = direct(t, y) - _linear(balance, start)
            guess = slopes[0] if stage else solve(right)
            # This slope is small compared with the rest: one correction of a guess is enough.
            for _ in range(2):
                hot = right.copy()
                hot[:n] += slope @ (start[:n] + GAMMA * h * guess[:n])
                guess = solve(hot)
            slopes.append(guess)
            derivatives[first + 1 + stage] = start + GAMMA * h * guess
        s = derivatives[first + 2]
    return Tangents(
        ops, np.asarray(times), derivatives[:, :n].transpose(2, 0, 1), derivatives[:, n:].transpose(2, 0, 1)
    )


def _linear(balance: HeatBalance, s: Array) -> Array:
    n = balance.ops.size
    body, gas = s[:n], s[n:]
    return np.vstack([balance.S @ body - balance.B @ gas, balance.D @ gas - balance.B.T @ body])


def _slope(balance: HeatBalance, t: float, y: State, rate: Array | None) -> csr_matrix:
    """d(heat beside the linear part - M du/dt)/d(temperature), (n, n); rate: du/dt if M varies.

    Sources, fluxes and conductivities that depend on temperature; films and radiation are in the linear part.
    """
    data = np.zeros(balance.ops.nnz)
    for load in balance.loads:
        if isinstance(load, SourceLoad) and not load.static:
            data += load.slope(t, y.u, _BUMP)
    for capacity in balance.capacities.values():
        if not capacity.constant and rate is not None:
            data -= capacity.slope(y.u, rate, _BUMP)
    slope = balance.ops.matrix(data)
    for load in balance.loads:
        if isinstance(load, FluxLoad) and load.of_temperature:
            slope = slope + load.jacobian(t, y)
    for conduction in balance.conduction:
        slope = slope + conduction.slope(t, y)
    return slope
