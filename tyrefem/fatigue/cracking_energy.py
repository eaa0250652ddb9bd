"""Cracking energy density on the planes through a point (Mars 2002): the energy that a crack in a plane can release.

dW_c = n . s . d(e) n on the plane with unit normal n, s the Cauchy stress, e the strain. Work of the normal stress
n.s.n counts only while it pulls: closed faces press on each other. Work of the shear stress always counts, as faces
slide without friction.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: The six components of a symmetric tensor in (r, z, t).
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
_I, _J = (np.array(index) for index in zip(*PAIRS, strict=True))
_PLACE = np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]])


def tensors(components: Array) -> Array:
    """(..., 3, 3) of tensor components (..., 6): rr, zz, tt, rz, rt, zt; shears are not doubled."""
    return np.asarray(np.asarray(components)[..., _PLACE])


def six(matrices: Array) -> Array:
    """(..., 6) of symmetric tensors (..., 3, 3)."""
    return np.asarray(np.asarray(matrices)[..., _I, _J])


def products(normals: Array) -> Array:
    """(..., 6) weights with which six tensor components give n . a n of unit normals (..., 3)."""
    normals = np.asarray(normals, dtype=float)
    return np.asarray(normals[..., _I] * normals[..., _J] * np.where(_I == _J, 1.0, 2.0))


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
    def largest_strains(self) -> Array:
        """(points, times) largest principal logarithmic strain."""
        return np.asarray(np.linalg.eigvalsh(tensors(self.strain))[..., -1])

    def on(self, weights: Array) -> PlaneCycle:
        """The cycle on planes, of `products` (planes, 6), or (points, planes, 6) for planes of every point.

        The integral depends on the path where principal directions turn, so that a revolution may end at another
        energy. This drift is taken out evenly over the revolution; the result does not depend on its start.
        """
        mean = (self.stress[:, 1:] + self.stress[:, :-1]) / 2
        change = np.diff(self.strain, axis=1)
        a, b = tensors(mean), tensors(change)
        work = a @ b
        turned = np.swapaxes(np.asarray(weights), -1, -2)
        total = six((work + np.swapaxes(work, -1, -2)) / 2) @ turned
        pull = mean @ turned
        normal = pull * (change @ turned)
        opening = np.where(pull > 0, normal, 0.0)
        energy = np.zeros((total.shape[0], total.shape[1] + 1, total.shape[2]))
        opened = np.zeros_like(energy)
        np.cumsum(total - normal + opening, axis=1, out=energy[:, 1:])
        np.cumsum(opening, axis=1, out=opened[:, 1:])
        energies, drift = _closed(energy[:, self.before :])
        opening_energies, _ = _closed(opened[:, self.before :])
        at, least = (index[:, None] for index in (energies.argmax(axis=1), energies.argmin(axis=1)))
        largest = np.broadcast_to(self.largest_strains[:, self.before :, None], energies.shape)
        peak, valley = (np.take_along_axis(energies, index, axis=1)[:, 0] for index in (at, least))
        pulled, before = (np.take_along_axis(opening_energies, index, axis=1)[:, 0] for index in (at, least))
        strain = np.take_along_axis(largest, at, axis=1)[:, 0]
        gained = peak - valley
        share = np.clip((pulled - before) / np.where(gained > 0, gained, 1.0), 0.0, 1.0)
        return PlaneCycle(np.maximum(peak, 0.0), np.maximum(valley, 0.0), np.exp(strain), share, np.abs(drift))


def _closed(values: Array) -> tuple[Array, Array]:
    """Values (points, times, planes) of a closed cycle without their drift, and the drift (points, planes)."""
    drift = values[:, -1] - values[:, 0]
    return values - np.linspace(0, 1, values.shape[1])[:, None] * drift[:, None], drift
