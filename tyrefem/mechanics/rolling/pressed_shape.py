"""The shape of a tyre pressed in large motion, from which friction moves the tread."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.mechanics.footprint.elements import COMPONENTS
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.rolling.loaded_compliance import LoadedCompliance
from tyrefem.mechanics.rolling.tread_influence import MIRROR, TreadInfluence

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PressedShape(Brief):
    """What large motion adds to small motion under the same forces f: d = u - C f at the points of the tread.

    Friction adds forces to those of the pressed tyre, and the tread moves with the compliance C of small motion about
    the inflated tyre from there. Without friction the contact of d is the footprint itself.

    As friction pulls, d turns round the wheel by the angle s at which the forces do no work in turning it further:

    u = d(t + s) + C f,   sum over the points of f . d'(t + s) = 0

    u is the derivative by f of C f . f/2 + max over s of f . d(t + s), which does not change where f turns round the
    wheel. So the work of a revolution on an elastic tyre vanishes, as it must (`SteadyRolling`).

    The pressed tyre is softer or stiffer than the inflated one by D (`LoadedCompliance`). D turns with the shape and
    acts on what friction adds to its forces f0: D (f - f0(t + s)) more.

    Parameters
    ----------
    footprint : the upright tyre without friction. elastic : C of its points without loss, where the rolling tyre has
        loss: the footprint has none; None: that of the rolling tyre.
    loaded : D; None: none.
    """

    footprint: Footprint
    elastic: TreadInfluence | None = None
    loaded: LoadedCompliance | None = None

    def offsets(self, influence: TreadInfluence, harmonics: int, angles: Array, kernel: Array) -> Array:
        """(n_angles, 3, m) d of the points of the whole tread along (r, z, t), averaged with the hats, m.

        ``kernel``: `TreadInfluence.kernel` of these angles.
        """
        if self.elastic is not None:
            kernel = self.elastic.kernel(harmonics, len(angles))
        displacements = self._displacements(influence, harmonics, angles)
        forces = self._forces(influence, angles, np.pi / harmonics, displacements)
        count = len(angles)
        linear = np.zeros_like(displacements)
        for to in range(count):
            behind = kernel[count - 1 + to - np.arange(count)]
            linear[to] = np.einsum("japbq,jbq->ap", behind, forces, optimize=True)
        return displacements - linear

    def forces(self, influence: TreadInfluence, harmonics: int, angles: Array) -> Array:
        """(n_angles, 3, m) f: forces of the road on the points of the pressed tyre along (r, z, t), N."""
        return self._forces(influence, angles, np.pi / harmonics, self._displacements(influence, harmonics, angles))

    def _displacements(self, influence: TreadInfluence, harmonics: int, angles: Array) -> Array:
        """(n_angles, 3, m) displacements along (r, z, t), m."""
        nodes, sides = influence.source
        dofs = COMPONENTS * influence.tread.nodes[nodes] + np.arange(COMPONENTS)[:, None]
        amplitudes = self.footprint.amplitudes
        n = np.arange(len(amplitudes))
        smooth = np.sinc(n / (2 * harmonics)) ** 2
        phase = np.multiply.outer(angles, n)
        waves = np.stack([np.cos(phase), np.cos(phase), np.sin(phase)]) * smooth
        return np.asarray(
            np.einsum("cjn,ncm->jcm", waves, amplitudes[:, dofs], optimize=True)
            * np.where(sides < 0, MIRROR[:, None], 1.0)
        )

    def _forces(self, influence: TreadInfluence, angles: Array, step: float, displacements: Array) -> Array:
        """(n_angles, 3, m) forces of the road on the points along (r, z, t), N."""
        footprint, (r, z) = self.footprint, influence.places
        nodes, _ = influence.source
        pressure = np.stack(
            [
                np.interp(np.abs(angles), footprint.grid.angles, footprint.pressure[:, node], right=0.0)
                for node in nodes
            ],
            axis=1,
        )
        radius = r + displacements[:, 0]
        sin, cos = np.sin(angles)[:, None], np.cos(angles)[:, None]
        places = np.stack([
            radius * sin + displacements[:, 2] * cos,
            radius * cos - displacements[:, 2] * sin,
            z + displacements[:, 1],
        ])  # fmt: skip
        _, (x, y, left) = footprint.pressing.road.gaps(places.reshape(3, -1), footprint.loaded_radius)
        x, y, left = (part.reshape(pressure.shape) for part in (x, y, left))
        into = np.stack([x * sin + y * cos, left, x * cos - y * sin], axis=1)
        return np.asarray(-into * (pressure * influence.lengths * r * step)[:, None])
