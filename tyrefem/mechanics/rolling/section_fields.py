"""Motion and strains of the whole section under the forces of the road on the tread of a tyre."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.mechanics.footprint.compliance import TreadCompliance
from tyrefem.mechanics.footprint.elements import COMPONENTS
from tyrefem.mechanics.rolling.rolling_grid import RollingGrid
from tyrefem.mechanics.rolling.tread_influence import MIRROR, PHASE

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class SectionFields(Brief):
    """Displacements u = Re((U_r, U_z, -i U_t) e^(i n t)) of a section, and their strains.

    The forces of a half section's two sides are half a symmetric and half an antisymmetric pair.

    Parameters
    ----------
    grid : points of the tread. components : (n_angles, m, 3) forces of the road on them along (r, z, t), N.
    """

    grid: RollingGrid
    components: Array

    @functools.cached_property
    def waves(self) -> Complex:
        """(harmonics + 1, 3, m) amplitudes of the forces, N per radian: F = Re(phase F_n e^(i n t))."""
        n = np.arange(self.grid.harmonics + 1)
        shares = np.sinc(n * self.grid.step / (2 * np.pi)) ** 2 / np.where(n == 0, 2 * np.pi, np.pi)
        waves = shares[:, None] * np.exp(-1j * np.multiply.outer(n, self.grid.angles))
        return np.asarray(np.einsum("nj,jpc->ncp", waves, self.components) / PHASE[:, None])

    @functools.cached_property
    def sides(self) -> tuple[Complex, ...]:
        """(harmonics + 1, n_dofs) amplitudes U, m, of a full section; of a half section, of the side z > 0 and of the
        mirror image of the other."""
        influence, tread = self.grid.influence, self.grid.influence.tread
        if not tread.half:
            return (self._moved(tread, self._on_nodes(self.waves)),)
        _, signs = influence.source
        here = self._on_nodes(self.waves, signs > 0)
        there = self._on_nodes(self.waves * MIRROR[:, None], signs < 0)
        same = self._moved(tread, (here + there) / 2)
        other = self._moved(TreadCompliance(influence.antisymmetric), (here - there) / 2)
        return same + other, same - other

    def _on_nodes(self, waves: Complex, chosen: NDArray[np.bool_] | slice = slice(None)) -> Complex:
        """(harmonics + 1, 3, nodes) of the forces on ``chosen`` points, at the section's nodes."""
        influence = self.grid.influence
        nodes, _ = influence.source
        placed = np.zeros((*waves.shape[:2], len(influence.tread.nodes)), dtype=complex)
        placed[:, :, nodes[chosen]] = waves[:, :, chosen]
        return placed

    def _moved(self, tread: TreadCompliance, waves: Complex) -> Complex:
        """(harmonics + 1, n_dofs) amplitudes under (harmonics + 1, 3, nodes) forces."""
        harmonics = tread.harmonics
        loads = np.zeros((len(waves), harmonics.elements.n_dofs), dtype=complex)
        loads[:, (COMPONENTS * tread.nodes + np.arange(COMPONENTS)[:, None]).ravel()] = waves.reshape(len(waves), -1)
        loads[:, harmonics.held] = 0.0
        if self.grid.influence.lossy:
            return np.asarray(tread.responses(loads))
        return tread.responses(loads.real.copy()) + 1j * tread.responses(loads.imag.copy())

    def strains(self, angles: Array) -> tuple[Array, ...]:
        """(6, n_elements, n_points, n_angles) strains of each of `sides` at angles, rad; order rr, zz, tt, rz, rt, zt,
        engineering shears."""
        elements = self.grid.influence.tread.harmonics.elements
        turn = np.exp(1j * np.multiply.outer(np.arange(self.grid.harmonics + 1), np.asarray(angles)))
        waves = np.stack([turn] * 4 + [-1j * turn] * 2)
        fields = []
        for side in self.sides:
            amplitudes = [elements.strain(n, u.real) + 1j * elements.strain(n, u.imag) for n, u in enumerate(side)]
            fields.append(np.einsum("ncep,cnt->cept", np.stack(amplitudes), waves, optimize=True).real)
        return tuple(fields)
