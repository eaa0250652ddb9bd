"""Energy that the rubber of a rolling tyre turns into heat, under the forces of its contact."""

from __future__ import annotations

import functools
from collections.abc import Iterator
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


@dataclass(frozen=True, eq=False)
class BodyLoss(Brief):
    """Loss of a tyre whose stiffness is complex (`LossyHarmonics`), in a revolution under forces F of its contact.

    With U = C_n F, C_n the compliance of the tread, and K_n - i K''_n the stiffness of the whole section:

    sum over n of 2 pi^2 n U* K''_n U = - sum over n of 2 pi^2 n Im(U* F)

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
    def energy(self) -> float:
        """Energy lost in a revolution by the whole tyre, J; zero without loss. By the compliance of the tread."""
        influence, highest = self.grid.influence, self.grid.harmonics
        if not influence.lossy:
            return 0.0
        weights, waves = interpolation(highest), self.waves.reshape(highest + 1, -1)
        total = 0.0
        for column, solved in enumerate(solved_harmonics(highest)):
            served = np.flatnonzero(weights[:, column])
            compliance = influence.solved(solved).reshape(waves.shape[1], -1)
            moved = waves[served] @ compliance.T
            work = (moved.conj() * waves[served]).sum(axis=1).imag
            total -= float((weights[served, column] * served * work).sum())
        return 2 * np.pi**2 * total

    @functools.cached_property
    def energy_of_section(self) -> float:
        """The same energy by the amplitudes U of the whole section and K''_n: a check, far slower.

        The forces of a half section's two sides are half a symmetric and half an antisymmetric pair, whose losses add
        up.
        """
        return sum(self._lost(tread, waves) for tread, waves in self._families()) if self.grid.influence.lossy else 0.0

    def _families(self) -> Iterator[tuple[TreadCompliance, Complex]]:
        """Symmetric and antisymmetric motions of both halves, or those of a full section, with their forces."""
        influence, tread = self.grid.influence, self.grid.influence.tread
        if not tread.half:
            yield tread, self._on_nodes(self.waves)
            return
        _, sides = influence.source
        here = self._on_nodes(self.waves, sides > 0)
        there = self._on_nodes(self.waves * MIRROR[:, None], sides < 0)
        # Both halves lose alike: sqrt(2) times the forces on one stands for both.
        yield tread, (here + there) / np.sqrt(2)
        yield TreadCompliance(influence.antisymmetric), (here - there) / np.sqrt(2)

    def _on_nodes(self, waves: Complex, chosen: NDArray[np.bool_] | slice = slice(None)) -> Complex:
        """(harmonics + 1, 3, nodes) of the forces on ``chosen`` points, at the section's nodes."""
        influence = self.grid.influence
        nodes, _ = influence.source
        placed = np.zeros((*waves.shape[:2], len(influence.tread.nodes)), dtype=complex)
        placed[:, :, nodes[chosen]] = waves[:, :, chosen]
        return placed

    def _lost(self, tread: TreadCompliance, waves: Complex) -> float:
        """J in a revolution under (harmonics + 1, 3, nodes) forces on one section."""
        harmonics = tread.harmonics
        assert isinstance(harmonics, LossyHarmonics)
        loads = np.zeros((len(waves), harmonics.elements.n_dofs), dtype=complex)
        loads[:, (COMPONENTS * tread.nodes + np.arange(COMPONENTS)[:, None]).ravel()] = waves.reshape(len(waves), -1)
        loads[:, harmonics.held] = 0.0
        total = 0.0
        for n, u in enumerate(tread.responses(loads)):
            total += 2 * np.pi**2 * n * float((u.conj() @ (harmonics.loss(n) @ u)).real)
        return total
