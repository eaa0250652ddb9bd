"""Blocks of a tread: they bend, where a rib is only sheared."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.solid.six_components import components, outer

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TreadBlocks:
    """What bending takes off the compound's energy, with a = F n, c = F t (n: across the tread, t: hoop):

    W = -(1 - b) G/2 (a . c)^2  [J/m3].

    In simple shear by g between n and t the compound has G g; with this b G g is left. Other strains do not change.

    Parameters
    ----------
    normal : (2, ...) unit vector (r, z) across the tread, before inflation.
    missing : (...) (1 - b) G, Pa.

    >>> blocks = TreadBlocks(np.array([1.0, 0.0]), np.array(2e5))
    >>> sheared = np.eye(3) + 0.1 * np.eye(3)[:, [2]] * np.eye(3)[[0]]
    >>> (blocks.stress(sheared).round(6) + 0.0).tolist()
    [0.0, 0.0, -4000.0, 0.0, -20000.0, 0.0]
    """

    normal: Array
    missing: Array

    @property
    def directions(self) -> tuple[Array, Array]:
        """(3, ...) n and t as (r, z, theta), before inflation."""
        none = np.zeros_like(self.normal[:1])
        return np.concatenate([self.normal, none]), np.concatenate([none, none, none + 1])

    def energy(self, deformation: Array) -> Array:
        """W, J/m3."""
        a, c = self._carried(deformation)
        return np.asarray(-self.missing / 2 * (a * c).sum(axis=0) ** 2)

    def stress(self, deformation: Array) -> Array:
        """Kirchhoff stress W' (a c + c a), W' by a . c; Pa, (6, ...)."""
        a, c = self._carried(deformation)
        return np.asarray(-self.missing * (a * c).sum(axis=0) * _dyad(a, c))

    def tangent(self, deformation: Array) -> Array:
        """Spatial tangent J c: W'' (a c + c a)(a c + c a); Pa, (6, 6, ...)."""
        dyad = _dyad(*self._carried(deformation))
        return np.asarray(-self.missing * outer(dyad, dyad))

    def _carried(self, deformation: Array) -> tuple[Array, Array]:
        a, c = (np.einsum("ij...,j...->i...", deformation, d) for d in self.directions)
        return a, c


def _dyad(a: Array, c: Array) -> Array:
    mixed = a[:, None] * c[None]
    return components(mixed + mixed.swapaxes(0, 1))
