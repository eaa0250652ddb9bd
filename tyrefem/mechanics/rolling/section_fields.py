"""Motion and strains of the whole section under the forces of the road on the tread of a tyre."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.mechanics.footprint.compliance import TreadCompliance, interpolation, solved_harmonics
from tyrefem.mechanics.footprint.elements import COMPONENTS
from tyrefem.mechanics.rolling.lossy_harmonics import LossyHarmonics
from tyrefem.mechanics.rolling.rolling_grid import RollingGrid
from tyrefem.mechanics.rolling.tread_influence import MIRROR, PHASE

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


def section_motion(tread: TreadCompliance, waves: Complex) -> Complex:
    """(harmonics + 1, n_dofs) amplitudes, m, under forces (harmonics + 1, 3, nodes) on the tread, N per radian."""
    harmonics = tread.harmonics
    loads = np.zeros((len(waves), harmonics.elements.n_dofs), dtype=complex)
    loads[:, (COMPONENTS * tread.nodes + np.arange(COMPONENTS)[:, None]).ravel()] = waves.reshape(len(waves), -1)
    loads[:, harmonics.held] = 0.0
    if isinstance(harmonics, LossyHarmonics):
        return np.asarray(tread.responses(loads))
    highest = len(waves) - 1
    weights, moved = interpolation(highest), np.zeros_like(loads)
    for column, n in enumerate(solved_harmonics(highest)):
        served = np.flatnonzero(weights[:, column])
        if len(served):
            both = np.concatenate([loads[served].real, loads[served].imag]).T
            real, imaginary = np.split(harmonics.solve(n, both).T, 2)
            moved[served] += weights[served, column, None] * (real + 1j * imaginary)
    return moved


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
    def loads(self) -> Complex:
        """(harmonics + 1, 3, nodes) of the forces at the section's nodes; of a half section, their symmetric part."""
        influence = self.grid.influence
        if not influence.tread.half:
            return self._on_nodes(self.waves)
        here, there = self._halves
        return (here + there) / 2

    @functools.cached_property
    def _halves(self) -> tuple[Complex, Complex]:
        """Forces on the side z > 0 of a half section, and the mirror image of those on the other."""
        _, signs = self.grid.influence.source
        return self._on_nodes(self.waves, signs > 0), self._on_nodes(self.waves * MIRROR[:, None], signs < 0)

    @functools.cached_property
    def sides(self) -> tuple[Complex, ...]:
        """(harmonics + 1, n_dofs) amplitudes U, m, of a full section; of a half section, of the side z > 0 and of the
        mirror image of the other."""
        influence, tread = self.grid.influence, self.grid.influence.tread
        if not tread.half:
            return (section_motion(tread, self.loads),)
        here, there = self._halves
        same = section_motion(tread, self.loads)
        other = section_motion(TreadCompliance(influence.antisymmetric), (here - there) / 2)
        return same + other, same - other

    def _on_nodes(self, waves: Complex, chosen: NDArray[np.bool_] | slice = slice(None)) -> Complex:
        """(harmonics + 1, 3, nodes) of the forces on ``chosen`` points, at the section's nodes."""
        influence = self.grid.influence
        nodes, _ = influence.source
        placed = np.zeros((*waves.shape[:2], len(influence.tread.nodes)), dtype=complex)
        placed[:, :, nodes[chosen]] = waves[:, :, chosen]
        return placed

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
