"""Stress and strain of the rubber at the Gauss points of a pressed tyre, over one revolution."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.fatigue.cracking_energy import CrackingEnergy, six, tensors
from tyrefem.mechanics.finite_elements import FiniteElements
from tyrefem.mechanics.footprint.elements import WheelAngles
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics
from tyrefem.mechanics.rolling.rolled_footprint import RolledFootprint
from tyrefem.mechanics.rolling.turning import cycle_of
from tyrefem.mechanics.solid.compounds import determinant

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
#: Steps from the unstrained tyre to the state opposite the footprint.
STEPS = 8
#: Least stretch of a small strain: below it linear motion has no meaning at all.
SMALLEST = 0.05
#: Components rt, zt change their sign from one side of the footprint to the other.
MIRROR = np.array([1.0, 1.0, 1.0, 1.0, -1.0, -1.0])


@dataclass(frozen=True, eq=False)
class MatrixCycle:
    """What the rubber of every point bears: the compound of a cord layer at the strain of the layer.

    A tyre that rolls with friction is strained differently before and behind its footprint.

    The state at an angle is V F_0, F_0 that of inflation and V the stretch of the rolling tyre beyond it: sqrt(1 + 2 E)
    with Green's strain E in large motion, 1 + e with the linear strain e in linear motion. Rotations are left out:
    axes turn with the rubber. Stress: the compound's law at V F_0, and the pressure kappa (Proj J - 1) of the body.
    Strain: logarithmic, ln(V F_0 F_0' V) / 2. Cords bear the rest of the layer's stress and have no part in it.

    Parameters
    ----------
    cycle : a load case with a footprint.
    """

    cycle: FiniteElements

    @property
    def footprint(self) -> Footprint:
        """The tyre on the road."""
        assert self.cycle.footprint is not None
        return self.cycle.footprint

    @functools.cached_property
    def angles(self) -> WheelAngles:
        """Equal steps from the middle of the footprint to the opposite side."""
        footprint = self.footprint
        highest = footprint.lagging.harmonics if isinstance(footprint, RolledFootprint) else footprint.harmonics
        return WheelAngles(footprint.pressing.harmonics.elements, highest)

    @property
    def _one_sided(self) -> bool:
        """True if both sides of the footprint are mirror images."""
        return not isinstance(self.footprint, RolledFootprint)

    @functools.cached_property
    def _linear_angles(self) -> Array:
        """(m,) rad, the opposite side last: of half a revolution, or of a whole one."""
        half = self.angles.angles
        return half if self._one_sided else np.concatenate([-half[:0:-1], half])

    @functools.cached_property
    def _inflated(self) -> Array:
        """F_0 (e, q, 3, 3)."""
        return np.moveaxis(self.cycle.tyre.deformation, (0, 1), (-2, -1))

    @functools.cached_property
    def _strains(self) -> StrainHarmonics:
        return StrainHarmonics(self.footprint) if self._one_sided else cycle_of(self.footprint)

    @functools.cached_property
    def _at_nodes(self) -> tuple[Array, Array]:
        """(3, n_nodes, m) displacement, and what over r gives the gradient's third column."""
        value, slope = self.angles.at_nodes(self.footprint.amplitudes)
        slope[0] -= value[2]
        slope[2] += value[0]
        return value, slope

    def _gradient(self, chosen: Indices) -> Array:
        """(e, q, m, 3, 3) displacement gradient H_ki at all angles, as `WheelAngles.gradient` has it."""
        elements, (value, slope) = self.angles.elements, self._at_nodes
        nodes, over_r = elements.element_nodes[chosen], elements.values / elements.radii[chosen][..., None]
        columns = (*((by, value) for by in elements.gradients[:, chosen]), (over_r, slope))
        rows = [[by @ values[k][nodes] for by, values in columns] for k in range(3)]
        return np.moveaxis(np.array(rows), (0, 1), (-2, -1))

    def _stretch(self, elements: Indices) -> tuple[Array, Array]:
        """V (e, q, m, 3, 3) and the change of volume det V."""
        if self.footprint.balanced is None or not self._one_sided:
            linear = np.moveaxis(self._strains.strain(self._linear_angles, elements), 0, -1)
            linear[..., 3:] /= 2
            if self.footprint.balanced is not None:
                values, vectors = np.linalg.eigh(np.eye(3) + 2 * tensors(linear))
                stretches = np.sqrt(np.maximum(values, SMALLEST**2))
                return _spectral(stretches, vectors), stretches.prod(axis=-1)
            volume = 1 + linear[..., :3].sum(axis=-1)
            values, vectors = np.linalg.eigh(np.eye(3) + tensors(linear))
            return _spectral(np.maximum(values, SMALLEST), vectors), volume
        f = self._gradient(elements) + np.eye(3)
        volume = determinant(np.moveaxis(f, (-2, -1), (0, 1)))
        values, vectors = np.linalg.eigh(f.swapaxes(-1, -2) @ f)
        return _spectral(np.sqrt(np.maximum(values, SMALLEST**2)), vectors), volume

    def _pressure(self, elements: Indices, volume: Array) -> Array:
        """(e, q, m) kappa (Proj J - 1), as the body itself has it."""
        body = self.cycle.tyre.body
        functions, weights = body.rings.linear_functions[elements], body.rings.weights[elements][..., None]
        moments = functions.transpose(0, 2, 1) @ (weights * volume)
        return np.asarray(body.bulk[elements][:, None, None] * (functions @ moments - 1))

    def energies(self, region: str, members: Indices) -> CrackingEnergy:
        """The path of stress and strain of elements of a region, points (elements x Gauss points) in order.

        From rest in proportion to the state opposite the footprint, and once round the wheel.
        """
        compound = self.cycle.tyre.body.parts[region].compound
        stretch, volume = self._stretch(members)
        inflated = self._inflated[members][:, :, None]
        f = stretch @ inflated
        values, vectors = np.linalg.eigh(f @ f.swapaxes(-1, -2))
        logarithms = np.log(values) / 2
        pressure = self._pressure(members, volume * determinant(np.moveaxis(inflated, (-2, -1), (0, 1))))
        opposite = slice(-1, None)
        share = np.linspace(0, 1, STEPS + 1)[:-1]
        before = logarithms[:, :, opposite] * share[:, None]
        strains, stresses = [], []
        for logs, axes, p in (
            (before, vectors[:, :, opposite], pressure[:, :, opposite] * share),
            (logarithms, vectors, pressure),
        ):
            turned = np.broadcast_to(axes, (*logs.shape, 3))
            kirchhoff = compound.stress(np.moveaxis(_spectral(np.exp(logs), turned), (-2, -1), (0, 1)))
            stress = np.moveaxis(kirchhoff, 0, -1) / np.exp(logs.sum(axis=-1))[..., None]
            stress[..., :3] += p[..., None]
            stresses.append(stress)
            strains.append(six(_spectral(logs, turned)))
        rounded = _round if self._one_sided else _once_round
        return CrackingEnergy(rounded(*stresses), rounded(*strains), before=STEPS)


def _spectral(values: Array, vectors: Array) -> Array:
    """Tensors of principal values (..., 3) and directions (..., 3, 3)."""
    return np.asarray((vectors * values[..., None, :]) @ vectors.swapaxes(-1, -2))


def _round(before: Array, half: Array) -> Array:
    """(points, times, 6): up to the opposite side, forward over the mirrored half to the footprint, and back."""
    opposite_to_middle = half[:, :, ::-1] * MIRROR
    path = np.concatenate([before, opposite_to_middle, half[:, :, 1:]], axis=2)
    return np.asarray(path.reshape(-1, *path.shape[2:]))


def _once_round(before: Array, whole: Array) -> Array:
    """(points, times, 6): up to the opposite side, and from there backwards, as rubber runs, to it again."""
    path = np.concatenate([before, whole[:, :, ::-1]], axis=2)
    return np.asarray(path.reshape(-1, *path.shape[2:]))
