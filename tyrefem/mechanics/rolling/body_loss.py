"""Energy that the rubber of a rolling tyre turns into heat, under the forces of its contact."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.mechanics.footprint.compliance import interpolation, solved_harmonics
from tyrefem.mechanics.rolling.lossy_harmonics import LossyHarmonics
from tyrefem.mechanics.rolling.section_fields import SectionFields
from tyrefem.mechanics.rolling.tread_influence import TreadInfluence

Complex = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class BodyLoss(Brief):
    """Loss of a tyre whose stiffness is complex (`LossyHarmonics`), in a revolution under forces F of its contact.

    With U = C_n F, C_n the compliance of the tread, and K_n - i K''_n the stiffness of the whole section:

    sum over n of 2 pi^2 n U* K''_n U = - sum over n of 2 pi^2 n Im(U* F)

    Parameters
    ----------
    influence : compliance of the points of the tread. waves : (harmonics + 1, 3, m) forces on them, as `force_waves`.
    fields : the section under these forces.
    """

    influence: TreadInfluence
    waves: Complex
    fields: SectionFields

    @functools.cached_property
    def energy(self) -> float:
        """Energy lost in a revolution by the whole tyre, J; zero without loss. By the compliance of the tread."""
        influence, highest = self.influence, len(self.waves) - 1
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
        """The same energy by the amplitudes U of the whole section and K''_n: a check, far slower."""
        harmonics = self.influence.tread.harmonics
        if not isinstance(harmonics, LossyHarmonics):
            return 0.0
        total = 0.0
        for side in self.fields.sides:
            for n, u in enumerate(side):
                total += 2 * np.pi**2 * n * float((u.conj() @ (harmonics.loss(n) @ u)).real)
        return total
