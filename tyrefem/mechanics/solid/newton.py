"""Equilibrium of a body under a rising pressure: Newton with line search and adaptive load steps."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.mechanics.solid.body import Body
from tyrefem.mechanics.solid.compounds import determinant
from tyrefem.mechanics.solid.elements import Indices

Array = NDArray[np.float64]
#: A Newton step smaller than this share of the largest coordinate is below rounding errors.
ROUND_OFF = 1e-13
#: After a load step with at most this many evaluations, the next one is twice as large.
EASY = 12
#: Part of a Newton step's share by which it must reduce the work along it, or the residual.
ENOUGH = 0.1
#: SuperLU for matrices of a symmetric pattern: pivots are taken off the diagonal only where it is small.
PIVOTS: dict[str, Any] = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.01, "options": {"SymmetricMode": True}}


@dataclass(frozen=True)
class NewtonChoice:
    """Settings of the search for equilibrium.

    ``tolerance`` : unbalanced force over that of the pressure; ``iterations`` : most per load step; ``first_step``,
    ``smallest_step`` : of the load, over the total; ``line_search`` : most halvings of a Newton step.
    """

    tolerance: float = 1e-8
    iterations: int = 32
    first_step: float = 0.5
    smallest_step: float = 1e-3
    line_search: int = 3
    largest_change: float = 0.3


@dataclass(frozen=True, eq=False)
class Equilibrium(Brief):
    """Displacement (2, n_nodes), m, in equilibrium with a pressure, Pa, with the load steps and residuals.

    ``residuals`` holds the unbalanced force, over that of the pressure, at every iteration of every load step.
    """

    displacement: Array
    pressure: float
    steps: tuple[float, ...]
    residuals: tuple[tuple[float, ...], ...] = field(repr=False)


class StuckError(Exception):
    """A load step that did not converge; the message gives the place of the largest error."""


def equilibrium(
    body: Body, pressure: float, choice: NewtonChoice | None = None, near: Array | None = None
) -> Equilibrium:
    """The equilibrium of a body under a pressure, reached in steps from the undeformed state.

    ``near``: (2, n_nodes) displacement, m, of a nearby equilibrium, from which the search starts; without convergence
    there, the steps follow.

    Raises
    ------
    InputError : no equilibrium; the message gives the share of the load, the place (r, z) and its region.
    """
    choice = choice or NewtonChoice()
    if not np.isfinite(pressure):
        raise InputError(f"the pressure must be a finite number, not {pressure:g} Pa", field="pressure")
    if near is not None and pressure and near.shape == (2, body.rings.n_nodes):
        with suppress(StuckError):
            displacement, history = _newton(body, near, pressure, choice)
            return Equilibrium(displacement, pressure, (1.0,), (history,))
    before = now = np.zeros((2, body.rings.n_nodes))
    reached, last, step = 0.0, 0.0, choice.first_step
    easy = True
    steps: list[float] = []
    residuals: list[tuple[float, ...]] = []
    while pressure and reached < 1:
        aim = min(1.0, reached + step)
        guess = now + (now - before) * (aim - reached) / last if last and easy else now
        try:
            try:
                displacement, history = _newton(body, guess, aim * pressure, choice)
            except StuckError:
                if guess is now:
                    raise
                displacement, history = _newton(body, now, aim * pressure, choice)
        except StuckError as stuck:
            step = (aim - reached) / 2
            if step < choice.smallest_step:
                raise InputError(
                    f"no equilibrium beyond {reached:.1%} of {pressure / 1e3:.4g} kPa (load step {len(steps) + 1}): "
                    f"{stuck}",
                    field="pressure",
                ) from None
            continue
        before, now, last, reached = now, displacement, aim - reached, aim
        steps.append(aim)
        residuals.append(history)
        easy = len(history) <= EASY
        step *= 2.0 if easy else 1.0
    return Equilibrium(now, pressure, tuple(steps), tuple(residuals))


def spun_equilibrium(body: Body, still: Equilibrium, choice: NewtonChoice | None = None) -> Equilibrium:
    """The equilibrium of a body with its centrifugal load, reached in steps from the one without.

    Raises
    ------
    InputError : no equilibrium; the message gives the share of the load, the place (r, z) and its region.
    """
    choice = choice or NewtonChoice()
    if body.centrifugal is None:
        return still
    now, reached, step = still.displacement, 0.0, 1.0
    steps, residuals = list(still.steps), list(still.residuals)
    while reached < 1:
        aim = min(1.0, reached + step)
        part = replace(body, centrifugal=body.centrifugal.at(aim))
        try:
            now, history = _newton(part, now, still.pressure, choice)
        except StuckError as stuck:
            step = (aim - reached) / 2
            if step < choice.smallest_step:
                raise InputError(
                    f"no equilibrium beyond {reached:.1%} of the centrifugal load at "
                    f"{body.centrifugal.angular_speed:.4g} rad/s: {stuck}",
                    field="speed",
                ) from None
            continue
        reached = aim
        steps.append(aim)
        residuals.append(history)
    return Equilibrium(now, still.pressure, tuple(steps), tuple(residuals))


def _newton(body: Body, start: Array, pressure: float, choice: NewtonChoice) -> tuple[Array, tuple[float, ...]]:
    from scipy.sparse.linalg import splu

    free, now = body.free, start
    if not _possible(body, now):
        raise StuckError(_folded(body, now))
    size = abs(pressure) * float(np.linalg.norm(body.load(now)[free]))
    if body.centrifugal is not None:
        size += float(np.linalg.norm(body.centrifugal.force(body.rings.nodes + now)[free]))
    residual = body.residual(now, pressure)
    history = [float(np.linalg.norm(residual[free])) / size]
    while history[-1] > choice.tolerance:
        if len(history) > choice.iterations or not np.isfinite(history[-1]):
            raise StuckError(out_of_balance(body, residual, free))
        matrix = body.stiffness(now, pressure)[free][:, free]
        change = np.zeros(now.shape)
        try:
            change.T.flat[free] = -splu(matrix.tocsc(), **PIVOTS).solve(residual[free])
        except RuntimeError:
            raise StuckError("nothing holds the body: its stiffness is singular") from None
        now, residual = _line_search(body, now, change, residual, pressure, choice)
        history.append(float(np.linalg.norm(residual[free])) / size)
        if np.abs(change).max() <= ROUND_OFF * np.abs(body.rings.nodes).max():
            break
    return now, tuple(history)


def _line_search(
    body: Body, now: Array, change: Array, residual: Array, pressure: float, choice: NewtonChoice
) -> tuple[Array, Array]:
    """The step along ``change``, shortened to the largest change of a gradient, halved while it inverts elements or the
    work along it grows."""
    free = body.free
    along = change.T.ravel()[free]
    work, size = abs(along @ residual[free]), np.linalg.norm(residual[free])
    gradient = body.deformation(change) - np.eye(3)[..., None, None]
    share, best = min(1.0, choice.largest_change / max(float(np.abs(gradient).max()), 1e-300)), None
    for _ in range(choice.line_search + 1):
        tried = now + share * change
        if _possible(body, tried):
            left = body.residual(tried, pressure)
            better = abs(along @ left[free])
            less = 1 - ENOUGH * share
            if better <= less * work or np.linalg.norm(left[free]) <= less * size:
                return tried, left
            if best is None or better < best[0]:
                best = (better, tried, left)
        share /= 2
    if best is None:
        raise StuckError(_folded(body, now + share * change))
    return best[1], best[2]


def _possible(body: Body, displacement: Array) -> bool:
    f = body.deformation(displacement)
    return bool((determinant(f) > 0).all() and (f[2, 2] > 0).all())


def _folded(body: Body, displacement: Array) -> str:
    volume = determinant(body.deformation(displacement))
    element, point = np.unravel_index(int(volume.argmin()), volume.shape)
    return f"the mesh folds {place_words(body, body.rings.points[:, element, point], int(element))}"


def out_of_balance(body: Body, residual: Array, free: Indices) -> str:
    """Where the forces (n_dofs,) on the ``free`` degrees of freedom are farthest from balance, in words."""
    size = np.zeros(len(residual))
    size[free] = residual[free]
    node = int(np.hypot(*size.reshape(-1, 2).T).argmax())
    element = int(np.flatnonzero((body.rings.element_nodes == node).any(axis=1))[0])
    return f"the forces stay out of balance, most {place_words(body, body.rings.nodes[:, node], element)}"


def place_words(body: Body, place: Array, element: int) -> str:
    """A place (r, z), m, of an element in words, with its region."""
    r, z = place * 1e3
    return f"at (r, z) = ({r:.1f}, {z:.1f}) mm, region '{body.rings.region_of(element)}'"
