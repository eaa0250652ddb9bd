"""One Newton step of a tyre in large motion against the road: conjugate gradients on all harmonics together."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.footprint.nonlinear import Tangent
from tyrefem.mechanics.footprint.rotations import Rotations
from tyrefem.mechanics.footprint.touching import Touching

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]
#: Largest number of conjugate-gradient iterations in a step.
ITERATIONS = 400
#: Iterations over which a rate of motion must have settled.
DELAY = 4


@dataclass(frozen=True, eq=False)
class NewtonStep:
    """A step (highest + 1, n_dofs), m; its contact forces (k,), N; iterations; ``residual`` -g - J x - B' f, N per
    radian, that the search leaves; ``unstable``: the search direction with negative stiffness, if the search met
    one."""

    motion: Array
    forces: Array
    iterations: int
    residual: Array
    unstable: Array | None = None

    @property
    def stable(self) -> bool:
        """Whether the stiffness was positive in all search directions."""
        return self.unstable is None


@dataclass(frozen=True)
class SearchEnd:
    """What ends conjugate gradients: the relative ``residual`` in the preconditioner's norm, or its work, J, below
    ``least``; or, without internal forces, a relative change of the energy x J x below ``settled`` over `DELAY`
    iterations (0: never)."""

    residual: float = 0.0
    least: float = 0.0
    settled: float = 0.0


@dataclass(frozen=True, eq=False)
class Preconditioner:
    """The taut tyre turned with the deformed one, P = R K^-1 R', with closed points B x - C f = 0.

    Parameters
    ----------
    touching : points of possible contact. closed : numbers of the closed points. rotations : R.
    """

    touching: Touching
    closed: Indices
    rotations: Rotations

    @functools.cached_property
    def tail(self) -> Array:
        """C of the closed points."""
        return self.touching.tail[np.ix_(self.closed, self.closed)]

    @functools.cached_property
    def _loads(self) -> Array:
        return self.touching.loads[self.closed]

    @functools.cached_property
    def _turned(self) -> tuple[Array, Array]:
        """R' B', and the displacement rows B R."""
        loads = self.rotations.backward_at(self._loads, self.touching.grid.tread.nodes)
        return loads, loads / self.touching.grid.shares[: loads.shape[1], None, None]

    @functools.cached_property
    def _factor(self) -> Any:
        """Factors of S = B P B' + C."""
        from scipy.linalg import cho_factor

        loads, rows = self._turned
        schur = self.touching.tyre.compliance(loads, rows)
        return cho_factor((schur + schur.T) / 2 + self.tail)

    def forces(self, right: Array) -> Array:
        """S^-1 b."""
        from scipy.linalg import cho_solve

        return right if not len(right) else np.asarray(cho_solve(self._factor, right))

    def into(self, motion: Array) -> Array:
        """B x."""
        return self.touching.into(motion)[self.closed]

    def loaded(self, field: Array, forces: Array) -> Array:
        """A field of forces (highest + 1, n_dofs) minus B' f."""
        field = field.copy()
        if len(forces):
            flat = forces @ self._loads.reshape(len(forces), -1)
            tread = self.touching.tyre.tread
            field[:, tread] -= flat.reshape(len(field), *tread.shape)
        field[:, self.rotations.held] = 0.0
        return field

    def displacements(self, forces: Array) -> Array:
        """P B' f."""
        return self.rotations.forward(self._small(forces))

    def _small(self, forces: Array) -> Array:
        loads = self._turned[0]
        flat = forces @ loads.reshape(len(forces), -1)
        return self.touching.tyre.solve_tread(flat.reshape(loads.shape[1:]))

    def __call__(self, residual: Array, pressed: Array) -> tuple[Array, Array]:
        """Motion z and force change d with B z = C (q + d), for the residual r + B' q, q = ``pressed``.

        z = P (r - B' d), d = S^-1 (B P r - C q).
        """
        motion = self.touching.tyre.solve(self.rotations.backward(residual))
        change = pressed
        if len(pressed):
            rows = self._turned[1]
            moved = rows.reshape(len(rows), -1) @ motion[:, self.touching.tyre.tread].ravel()
            change = self.forces(moved - self.tail @ pressed)
            motion -= self._small(change)
        return self.rotations.forward(motion), change

    def energy(self, forces: Array, others: Array | None = None) -> float:
        """f C h over pi, J; h = f by default."""
        return float(forces @ self.tail @ (forces if others is None else others)) / np.pi if len(forces) else 0.0


def newton_step(
    touching: Touching,
    touched: Flags,
    tangent: Tangent,
    distance: Array,
    end: SearchEnd,
    rotations: Rotations,
    start: NewtonStep | None = None,
    damping: float = 0.0,
) -> NewtonStep:
    """J x + B' f = -g with B x - C f = w on the closed points, by projected conjugate gradients.

    C is the compliance of the harmonics that do not belong to x. The search runs in the pairs (x, f) with
    B x - C f = 0 (constraint preconditioner with regularisation: Dollar, Gould, Schilders and Wathen 2006).

    Parameters
    ----------
    touching : points. touched : (k,) contact set.
    tangent : g, internal forces, and J, their derivative. distance : w (k,), m.
    end : what ends the search. rotations : of the deformed tyre. start : a guess of the step.
    damping : share of the preconditioner's stiffness that is added to J.
    """
    closed = np.flatnonzero(touched)
    preconditioner = Preconditioner(touching, closed, rotations)
    work = touching.tyre.work
    x, total = np.zeros(tangent.forces.shape), np.zeros(len(closed))
    if start is not None:
        x, total = start.motion.copy(), start.forces[closed]
    if len(closed):
        missing = preconditioner.forces(distance[closed] - preconditioner.into(x) + preconditioner.tail @ total)
        x, total = x + preconditioner.displacements(missing), total - missing
    residual = preconditioner.loaded(-tangent.forces - tangent.product(x), total)
    pressed = np.zeros(len(closed))

    def searched() -> tuple[Array, float]:
        nonlocal residual, pressed, total
        change, forces = preconditioner(residual, pressed)
        residual, pressed, total = preconditioner.loaded(residual, forces), pressed + forces, total + forces
        return change, work(residual, change) + preconditioner.energy(pressed)

    along, size = searched()
    pushed, first, stable, count = pressed, size, True, 0
    stiff, stiff_pushed, damped = residual, pressed, np.zeros_like(x)
    drops: list[float] = []
    left = work(x, tangent.product(x)) + preconditioner.energy(total) if end.settled else 0.0
    while stable and count < ITERATIONS and size > max(end.residual**2 * first, end.least):
        if end.settled and count >= DELAY and sum(drops[-DELAY:]) <= end.settled * (left - sum(drops)):
            break
        bent, bent_pushed = tangent.product(along), pushed
        if damping:
            bent, bent_pushed = bent + damping * stiff, pushed + damping * stiff_pushed
        energy = work(along, bent) + preconditioner.energy(pushed, bent_pushed)
        stable, count = energy > 0, count + 1
        if stable:
            step = size / energy
            x += step * along
            damped += step * stiff
            drops.append(size * step)
            residual, pressed, before = residual - step * bent, pressed - step * bent_pushed, size
            change, size = searched()
            along, pushed = change + size / before * along, pressed + size / before * pushed
            stiff, stiff_pushed = residual + size / before * stiff, pressed + size / before * stiff_pushed
    forces = np.zeros(len(touching.rows))
    forces[closed] = total
    return NewtonStep(x, forces, count, residual + damping * damped, None if stable else along)
