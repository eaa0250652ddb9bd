"""Cracking energy density on the planes through a point (Mars 2002): the energy that a crack in a plane can release.

dW_c = n . s . d(e) n on the plane with unit normal n, s the Cauchy stress, e the strain. Work of the normal stress
n.s.n counts only while it pulls: closed faces press on each other. Work of the shear stress always counts, as faces
slide without friction.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.solid.six_components import FIRST, PLACE, SECOND

Array = NDArray[np.float64]


def tensors(components: Array) -> Array:
    """(..., 3, 3) of tensor components (..., 6): rr, zz, tt, rz, rt, zt; shears are not doubled."""
    return np.asarray(np.asarray(components)[..., PLACE])


def six(matrices: Array) -> Array:
    """(..., 6) of symmetric tensors (..., 3, 3)."""
    return np.asarray(np.asarray(matrices)[..., FIRST, SECOND])


def products(normals: Array) -> Array:
    """(..., 6) weights with which six tensor components give n . a n of unit normals (..., 3)."""
    normals = np.asarray(normals, dtype=float)
    return np.asarray(normals[..., FIRST] * normals[..., SECOND] * np.where(FIRST == SECOND, 1.0, 2.0))


@dataclass(frozen=True, eq=False)
class PlaneCycle:
    """A cycle on planes, all (points, planes).

    Parameters
    ----------
    peak, valley : largest and least cracking energy density, J/m3; never below 0.
    stretch : largest principal stretch at the peak. opening : share of the normal stress in the energy gained from
        the valley to the peak; the rest is shear.
    drift : change over a whole revolution before it is taken out, J/m3.
    """

    peak: Array
    valley: Array
    stretch: Array
    opening: Array
    drift: Array

    @property
    def ratio(self) -> Array:
        """R = valley / peak."""
        return np.asarray(self.valley / np.maximum(self.peak, 1e-300))


@dataclass(frozen=True, eq=False)
class CrackingEnergy:
    """Stress and strain of points through a closed cycle.

    Parameters
    ----------
    stress : (points, times, 6) Cauchy stress of the rubber, Pa; the last time is the first one of the next cycle.
    strain : (points, times, 6) logarithmic strain; shears are tensor components, not doubled.
    before : number of the first times that lead from the unstrained rubber to the start of the cycle.
    """

    stress: Array
    strain: Array
    before: int = 0

    @functools.cached_property
    def _largest_stretches(self) -> Array:
        """(points, times of the cycle) largest principal stretch."""
        return np.asarray(np.exp(np.linalg.eigvalsh(tensors(self.strain[:, self.before :]))[..., -1]))

    @functools.cached_property
    def _steps(self) -> tuple[Array, Array, Array]:
        """Of every step: symmetric part of s d(e), mean stress and change of strain, each (points, steps, 6)."""
        mean = (self.stress[:, 1:] + self.stress[:, :-1]) / 2
        change = np.diff(self.strain, axis=1)
        work = tensors(mean) @ tensors(change)
        return six((work + np.swapaxes(work, -1, -2)) / 2), mean, change

    @functools.cached_property
    def _rough_steps(self) -> tuple[Any, Any, Any]:
        """`_steps` in single precision, for a search."""
        work, mean, change = (np.ascontiguousarray(part, dtype=np.float32) for part in self._steps)
        return work, mean, change

    def _path(self, steps: tuple[Array, Array, Array], weights: Array) -> tuple[Array, Array, Array]:
        """Energy (points, times of the cycle, planes), steps of its part by the normal stress (points, steps, planes),
        and drift (points, planes)."""
        work, mean, change = steps
        turned = np.swapaxes(np.asarray(weights, dtype=work.dtype), -1, -2)
        energy, pull, normal = work @ turned, mean @ turned, change @ turned
        normal *= pull
        energy -= normal
        np.maximum(np.sign(pull, out=pull), 0, out=pull)
        normal *= pull
        energy += normal
        energies, drift = _closed(energy, self.before)
        return energies, normal, drift

    def extremes(self, weights: Array) -> tuple[Array, Array, Array]:
        """Peak, valley and stretch of `on` in single precision, for a search over planes."""
        energies, _, _ = self._path(self._rough_steps, weights)
        at = energies.argmax(axis=1)
        peak = np.take_along_axis(energies, at[:, None], axis=1)[:, 0]
        stretch = np.take_along_axis(self._largest_stretches, at, axis=1)
        return np.maximum(peak, 0.0), np.maximum(energies.min(axis=1), 0.0), stretch

    def on(self, weights: Array) -> PlaneCycle:
        """The cycle on planes, of `products` (planes, 6), or (points, planes, 6) for planes of every point.

        The integral depends on the path where principal directions turn, so that a revolution may end at another
        energy. This drift is taken out evenly over the revolution; the result does not depend on its start.
        """
        energies, normal, drift = self._path(self._steps, weights)
        opened, _ = _closed(normal, self.before)
        at, least = energies.argmax(axis=1), energies.argmin(axis=1)
        peak, valley = (np.take_along_axis(energies, index[:, None], axis=1)[:, 0] for index in (at, least))
        pulled, before = (np.take_along_axis(opened, index[:, None], axis=1)[:, 0] for index in (at, least))
        gained = peak - valley
        share = np.clip((pulled - before) / np.where(gained > 0, gained, 1.0), 0.0, 1.0)
        stretch = np.take_along_axis(self._largest_stretches, at, axis=1)
        return PlaneCycle(np.maximum(peak, 0.0), np.maximum(valley, 0.0), stretch, share, np.abs(drift))


def _closed(steps: Array, before: int) -> tuple[Array, Array]:
    """Sums of steps (points, steps, planes) from the start of the cycle on, without their drift, and the drift."""
    sums = np.zeros((steps.shape[0], steps.shape[1] + 1, steps.shape[2]), dtype=steps.dtype)
    np.cumsum(steps, axis=1, out=sums[:, 1:])
    values = sums[:, before:]
    drift = values[:, -1] - values[:, 0]
    values -= np.linspace(0, 1, values.shape[1], dtype=steps.dtype)[:, None] * drift[:, None]
    return values, drift
