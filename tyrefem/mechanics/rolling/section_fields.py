"""Motion and strains of the whole section under the forces of the road on the tread of a tyre."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.mechanics.footprint.compliance import TreadCompliance, interpolation, solved_harmonics
from tyrefem.mechanics.footprint.elements import COMPONENTS
from tyrefem.mechanics.rolling.lagging_strains import strain_amplitudes, strain_waves
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


def _without(loads: Complex, others: Complex) -> Complex:
    """Loads less others of fewer harmonics."""
    left = loads.copy()
    left[: len(others)] -= others
    return left


def force_waves(grid: RollingGrid, components: Array) -> Complex:
    """(harmonics + 1, 3, m) amplitudes of forces (n_angles, m, 3) along (r, z, t), N per radian:
    F = Re(phase F_n e^(i n t))."""
    n = np.arange(grid.harmonics + 1)
    shares = np.sinc(n * grid.step / (2 * np.pi)) ** 2 / np.where(n == 0, 2 * np.pi, np.pi)
    waves = shares[:, None] * np.exp(-1j * np.multiply.outer(n, grid.angles))
    return np.asarray(np.einsum("nj,jpc->ncp", waves, components) / PHASE[:, None])


@dataclass(frozen=True, eq=False)
class SectionFields(Brief):
    """Displacements u = Re((U_r, U_z, -i U_t) e^(i n t)) of a section under forces on its tread, and their strains.

    The forces of a half section's two sides are half a symmetric and half an antisymmetric pair. Made by `of`.

    Parameters
    ----------
    tread : compliance of the section. loads : (harmonics + 1, 3, nodes) force amplitudes along (r, z, t) at the tread's
        nodes, N per radian; of a half section, their symmetric part.
    deflection : m, of the tyre that bears them.
    antisymmetric : of a half section, compliance and loads of the antisymmetric part.
    less : motion that is taken off; None: none.
    more : (harmonics + 1, n_dofs) motion that is added, m; of a half section, its symmetric and its antisymmetric part.
    """

    tread: TreadCompliance
    loads: Complex
    deflection: float = 0.0
    antisymmetric: tuple[TreadCompliance, Complex] | None = None
    less: SectionFields | None = None
    more: tuple[Complex, ...] = ()

    @classmethod
    def of(cls, grid: RollingGrid, components: Array, deflection: float = 0.0) -> SectionFields:
        """Under forces (n_angles, m, 3) of the road on the points of a grid along (r, z, t), N."""
        influence, waves = grid.influence, force_waves(grid, components)
        nodes, signs = influence.source

        def on_nodes(amplitudes: Complex, chosen: NDArray[np.bool_]) -> Complex:
            placed = np.zeros((*amplitudes.shape[:2], len(influence.tread.nodes)), dtype=complex)
            placed[:, :, nodes[chosen]] = amplitudes[:, :, chosen]
            return placed

        if not influence.tread.half:
            return cls(influence.tread, on_nodes(waves, np.full(len(nodes), True)), deflection)
        # The side z > 0, and the mirror image of the forces on the other.
        here, there = on_nodes(waves, signs > 0), on_nodes(waves * MIRROR[:, None], signs < 0)
        odd = (TreadCompliance(influence.antisymmetric), (here - there) / 2)
        return cls(influence.tread, (here + there) / 2, deflection, odd)

    def beside(self, loads: Sequence[Complex], motions: Sequence[Complex]) -> SectionFields:
        """With loads taken off and motions added, both of harmonics up to some: of a half section, symmetric and
        antisymmetric ones."""
        left = _without(self.loads, loads[0])
        if self.antisymmetric is None:
            return replace(self, loads=left, more=tuple(motions))
        tread, odd = self.antisymmetric
        return replace(self, loads=left, antisymmetric=(tread, _without(odd, loads[1])), more=tuple(motions))

    @property
    def harmonics(self) -> int:
        """Highest harmonic."""
        return len(self.loads) - 1

    @functools.cached_property
    def amplitudes(self) -> Complex:
        """(harmonics + 1, n_dofs) amplitudes U, m; of a half section, of its symmetric motion."""
        motion = section_motion(self.tread, self.loads)
        if self.more:
            motion[: len(self.more[0])] += self.more[0]
        return motion if self.less is None else motion - self.less.amplitudes

    @functools.cached_property
    def sides(self) -> tuple[Complex, ...]:
        """(harmonics + 1, n_dofs) amplitudes U, m, of a full section; of a half section, of the side z > 0 and of the
        mirror image of the other."""
        if self.antisymmetric is None:
            return (self.amplitudes,)
        odd = section_motion(*self.antisymmetric)
        if len(self.more) == 2:
            odd[: len(self.more[1])] += self.more[1]
        if self.less is not None and len(self.less.sides) == 2:
            odd = odd - (self.less.sides[0] - self.less.sides[1]) / 2
        return self.amplitudes + odd, self.amplitudes - odd

    def strains(self, angles: Array) -> tuple[Array, ...]:
        """(6, n_elements, n_points, n_angles) strains of each of `sides` at angles, rad; order rr, zz, tt, rz, rt, zt,
        engineering shears."""
        elements, waves = self.tread.harmonics.elements, strain_waves(self.harmonics, angles)
        fields = [strain_amplitudes(elements, side) for side in self.sides]
        return tuple(np.einsum("ncep,cnt->cept", field, waves, optimize=True).real for field in fields)
