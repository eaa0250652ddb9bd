"""One Newton step of a tyre in large motion against the road: conjugate gradients on all harmonics together."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.complementarity import contact_forces
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.directions import SearchedDirections
from tyrefem.mechanics.footprint.grid import ContactGrid
from tyrefem.mechanics.footprint.harmonics import SYMMETRIC
from tyrefem.mechanics.footprint.nonlinear import Tangent

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]
#: Largest number of conjugate-gradient iterations in a step.
ITERATIONS = 400
#: Iterations over which a rate of motion must have settled.
DELAY = 8


@dataclass(frozen=True, eq=False)
class LinearFactors:
    """Factors of K_n for every harmonic, computed once: the tyre in small motions."""

    pressing: Pressing
    _factors: dict[int, Any] = field(default_factory=dict, init=False, repr=False)
    _under_tread: dict[int, Array] = field(default_factory=dict, init=False, repr=False)

    @functools.cached_property
    def free(self) -> Indices:
        """Degrees of freedom that are not fixed."""
        return self.pressing.harmonics.free

    @functools.cached_property
    def tread(self) -> Indices:
        """(c m,) degrees of freedom on which the road may act."""
        return self.pressing.tread.dofs.ravel()

    def factor(self, n: int) -> Any:
        """SuperLU factors of a harmonic's free degrees of freedom, with a cache."""
        from scipy.sparse.linalg import splu

        if n not in self._factors:
            matrix = self.pressing.harmonics.stiffness(n)[self.free][:, self.free].tocsc()
            try:
                self._factors[n] = splu(matrix, permc_spec="MMD_AT_PLUS_A", **SYMMETRIC)
            except RuntimeError:
                raise InputError(f"harmonic {n:g} has no stiffness: nothing holds the body") from None
        return self._factors[n]

    def under_tread(self, n: int) -> Array:
        """(n_free, c m) displacements of a harmonic under unit loads on the tread, m per N per radian, with a cache."""
        if n not in self._under_tread:
            places = np.searchsorted(self.free, self.tread)
            loads = np.zeros((len(self.free), len(places)))
            loads[places, np.arange(len(places))] = 1.0
            self._under_tread[n] = self.factor(n).solve(loads)
        return self._under_tread[n]

    def compliance(self, count: int) -> Array:
        """(count, c m, c m) compliance of the tread in the first harmonics."""
        places = np.searchsorted(self.free, self.tread)
        return np.stack([self.under_tread(n)[places] for n in range(count)])

    def solve(self, loads: Array) -> Array:
        """(n, n_dofs) displacements, m, under loads (n, n_dofs), N per radian, of the first n harmonics."""
        displacements = np.zeros_like(loads)
        for n, load in enumerate(loads):
            displacements[n, self.free] = self.factor(n).solve(load[self.free])
        return displacements

    @staticmethod
    def work(forces: Array, motion: Array) -> float:
        """Work on the whole wheel over pi, J: n = 0 counts twice."""
        each = np.einsum("nd,nd->n", forces, motion)
        return float(each.sum() + each[0])


@dataclass(frozen=True, eq=False)
class Touching:
    """The points of possible contact, along their directions into the road.

    Parameters
    ----------
    factors : the tyre in small motions. grid : the points. direction : (c, k) into the road.
    """

    factors: LinearFactors
    grid: ContactGrid
    direction: Array

    @functools.cached_property
    def rows(self) -> Array:
        """(k, (highest + 1) c m) displacement of a point into the road per amplitude of the tread."""
        c, k = self.direction.shape
        m, highest = len(self.grid.tread.nodes), self.grid.harmonics
        angle, node, rows = np.arange(k) // m, np.arange(k) % m, np.zeros((k, highest + 1, c, m))
        for of in range(c):
            rows[np.arange(k), :, of, node] = (self.direction[of] * self.grid.shapes[of][:, angle]).T
        return rows.reshape(k, -1)

    @functools.cached_property
    def compliance(self) -> Array:
        """(k, k) displacement of a point per force at another, in small motions, m/N."""
        k, size = len(self.rows), len(self.factors.tread)
        per_force = self.rows.reshape(k, -1, size) * self.grid.shares[:, None]
        displacement = per_force.transpose(1, 0, 2) @ self.factors.compliance(per_force.shape[1])
        return np.asarray(displacement.transpose(1, 0, 2).reshape(k, -1) @ self.rows.T)

    def into(self, motion: Array, points: Any = slice(None)) -> Array:
        """Displacement of points into the road, m, for amplitudes (highest + 1, n_dofs)."""
        return np.asarray(self.rows[points] @ motion[:, self.factors.tread].ravel())

    def closed(self, gaps: Array, forces: Array, start: Flags) -> Flags:
        """(k,) contact set for gaps, m, under forces, N, with the compliance of small motions."""
        free = gaps - self.compliance @ forces
        return contact_forces(self.compliance, free, start if start.any() else None)[1]

    def _loads(self, forces: Array, points: Any) -> Array:
        flat = forces @ self.rows[points]
        return np.asarray(flat.reshape(-1, len(self.factors.tread)) * self.grid.shares[:, None])

    def all_displacements(self, loads: Array) -> Array:
        """(k, highest + 1, n_dofs) displacements, m, under loads (k, (highest + 1) c m) on the tread's amplitudes."""
        highest, size = self.grid.harmonics, len(self.factors.tread)
        split = loads.reshape(len(loads), highest + 1, size) * self.grid.shares[:, None]
        displacements = np.zeros((len(loads), highest + 1, self.factors.pressing.harmonics.elements.n_dofs))
        for n in range(highest + 1):
            displacements[:, n, self.factors.free] = split[:, n] @ self.factors.under_tread(n).T
        return displacements

    def loads(self, forces: Array, points: Any = slice(None)) -> Array:
        """(highest + 1, n_dofs) N per radian of unit forces into the road."""
        loads = np.zeros((self.grid.harmonics + 1, self.factors.pressing.harmonics.elements.n_dofs))
        loads[:, self.factors.tread] = self._loads(forces, points)
        return loads

    def displacements(self, forces: Array, points: Any = slice(None)) -> Array:
        """(highest + 1, n_dofs) displacements under `loads` in small motions, m."""
        displacements = np.zeros((self.grid.harmonics + 1, self.factors.pressing.harmonics.elements.n_dofs))
        for n, load in enumerate(self._loads(forces, points)):
            displacements[n, self.factors.free] = self.factors.under_tread(n) @ load
        return displacements


@dataclass(frozen=True, eq=False)
class NewtonStep:
    """A step (highest + 1, n_dofs), m; its contact forces (k,), N; iterations; ``stable``: the stiffness was positive
    in all search directions."""

    motion: Array
    forces: Array
    iterations: int
    stable: bool


@dataclass(frozen=True)
class SearchEnd:
    """What ends conjugate gradients: the relative ``residual`` in the preconditioner's norm, or its work, J, below
    ``least``; or, without internal forces, a relative change of the energy x J x below ``settled`` over `DELAY`
    iterations (0: never)."""

    residual: float = 0.0
    least: float = 0.0
    settled: float = 0.0


def newton_step(
    touching: Touching,
    touched: Flags,
    tangent: Tangent,
    distance: Array,
    end: SearchEnd,
    searched: SearchedDirections | None = None,
    start: Array | None = None,
) -> NewtonStep:
    """J x + B' f = -g with B x = w on the closed points: conjugate gradients on the motions with B x = 0.

    The preconditioner is the linear tyre with the same points fixed, K^-1 - K^-1 B' (B K^-1 B')^-1 B K^-1, corrected
    by the directions of earlier steps.

    Parameters
    ----------
    touching : points and linear tyre. touched : (k,) contact set.
    tangent : g, internal forces, and J, their derivative. distance : w, gaps (k,) to close, m.
    end : what ends the search.
    searched : directions of earlier steps; those of this step are added. start : a guess of the step, m.
    """
    from scipy.linalg import cho_factor, cho_solve

    closed = np.flatnonzero(touched)
    factors, held = touching.factors, touching.factors.pressing.harmonics.held
    factor = cho_factor(touching.compliance[np.ix_(closed, closed)]) if len(closed) else None
    total = np.zeros(len(closed))
    searched = SearchedDirections() if searched is None else searched
    rows = touching.rows[closed]

    def solve(right: Array) -> Array:
        return right if factor is None else np.asarray(cho_solve(factor, right))

    def free(forces: Array) -> Array:
        forces[:, held] = 0.0
        return forces

    def into(motion: Array) -> Array:
        return np.asarray(rows @ motion[:, factors.tread].ravel())

    def projected(motions: Any) -> Any:
        at_tread = motions[:, :, factors.tread].reshape(len(motions), -1)
        forces = solve((at_tread @ rows.T).T).T
        return motions - touching.all_displacements(forces @ rows).astype(motions.dtype)

    def preconditioned(residual: Array) -> tuple[Array, Array]:
        forces = np.zeros(len(closed))

        def linear(right: Array) -> Array:
            motion = factors.solve(right)
            forces[:] = solve(into(motion))
            return motion - touching.displacements(forces, closed)

        motion = searched.corrected(residual, linear)
        total[:] += forces
        return residual - touching.loads(forces, closed), motion

    searched.refine(touching.grid.harmonics)
    searched.project(projected)
    x = np.zeros(tangent.forces.shape) if start is None else start
    x = x + touching.displacements(solve(distance[closed] - into(x)), closed)
    residual, change = preconditioned(free(-tangent.forces - tangent.product(x)))
    size = first = factors.work(residual, change)
    along, stable, count = change, True, 0
    moved: list[Any] = []
    forced: list[Any] = []
    energies: list[float] = []
    drops: list[float] = []
    left = factors.work(x, tangent.product(x)) if end.settled else 0.0
    while stable and count < ITERATIONS and size > max(end.residual**2 * first, end.least):
        if end.settled and count >= DELAY and sum(drops[-DELAY:]) <= end.settled * (left - sum(drops)):
            break
        bent = free(tangent.product(along))
        energy = factors.work(along, bent)
        stable, count = energy > 0, count + 1
        if stable:
            x = x + size / energy * along
            drops.append(size**2 / energy)
            scale = 1 / np.sqrt(energy)
            moved.append((scale * along).astype(np.float32))
            forced.append((scale * bent).astype(np.float32))
            energies.append(1.0)
            residual, change = preconditioned(residual - size / energy * bent)
            size, before = factors.work(residual, change), size
            along = change + size / before * along
    searched.add(moved, forced, energies)
    forces = np.zeros(len(touching.rows))
    forces[closed] = total
    return NewtonStep(x, forces, count, stable)
