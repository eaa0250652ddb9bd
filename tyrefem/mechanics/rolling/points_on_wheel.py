"""Points of the tread round the wheel: their displacements in families of motions, and loads of forces on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.footprint.elements import COMPONENTS
from tyrefem.mechanics.rolling.loaded_tyre import MotionFamily
from tyrefem.mechanics.rolling.tread_influence import TreadInfluence

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PointsOnWheel:
    """Points of the tread at angles round the wheel, whose forces and displacements are those of hats.

    Parameters
    ----------
    influence : points of the tread. harmonics : pi over it is half the width of a hat. angles : rad.
    """

    influence: TreadInfluence
    harmonics: int
    angles: Array

    def _waves(self, family: MotionFamily, count: int) -> Array:
        """(3, n_angles, count) of the components (r, z, t)."""
        n = np.arange(count)
        smooth = np.sinc(n / (2 * self.harmonics)) ** 2
        phase = np.multiply.outer(self.angles, n)
        cos, sin = np.cos(phase) * smooth, np.sin(phase) * smooth
        return np.stack([sin, sin, -cos] if family.odd else [cos, cos, sin])

    def _signs(self, family: MotionFamily) -> Array:
        """(3, m) of the motion of each point, which may be on the other side than its node."""
        return np.where(self.influence.source[1] < 0, family.signs[:, None], 1.0)

    def displacements(self, family: MotionFamily, motions: Array) -> Array:
        """(n_angles, 3, m, k) along (r, z, t), m, of motions (k, n, 3, nodes), m."""
        waves = self._waves(family, motions.shape[1])
        at = np.einsum("cjn,kncm->jcmk", waves, motions[..., self.influence.source[0]], optimize=True)
        return np.asarray(at * self._signs(family)[..., None])

    def loads(self, family: MotionFamily, forces: Array, count: int) -> Array:
        """(count, 3, nodes), N per radian, of forces (n_angles, 3, m) along (r, z, t), N: their part of a family."""
        shares = np.full(count, 1 / np.pi)
        shares[0] /= 2
        waves = self._waves(family, count) * shares / (2 if family.tyre.half else 1)
        parts = np.einsum("cjn,jcm->ncm", waves, forces * self._signs(family), optimize=True)
        nodes = self.influence.source[0]
        loads = np.zeros((count, COMPONENTS, len(self.influence.tread.nodes)))
        for load, part in zip(loads, parts, strict=True):
            np.add.at(load.T, nodes, part.T)
        return family.free(loads)
