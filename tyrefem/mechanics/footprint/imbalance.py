"""What the search for a balance in large motion left unbalanced."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.footprint.elements import COMPONENTS
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.nonlinear import NonlinearForces

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Imbalance:
    """What the search for a balance left, which that of a tyre with another stiffness keeps.

    A balance is off by some d within its tolerance, mostly in motions that hardly any stiffness holds. A search that
    starts from it would go on where that one ended, and a part of d would be taken for a change. With what was left
    both balances are off by nearly the same d, and their difference by little.

    Parameters
    ----------
    forces : (highest + 1, n_dofs) g + B' f, N per radian. gaps : (n_angles, nodes) of the closed points, m.
    load : that of the balance minus the sum of its contact forces, N.
    """

    forces: Array
    gaps: Array
    load: float

    @classmethod
    def of(cls, near: Footprint) -> Imbalance:
        """Of a footprint in large motion."""
        assert near.balanced is not None
        grid = near.grid
        forces = NonlinearForces(near.pressing.harmonics, len(near.balanced) - 1).forces(near.balanced)
        pushed = grid.load_harmonics(near.direction * near.forces)[: len(forces)]
        for of, component in enumerate(grid.tread.components):
            forces[:, COMPONENTS * grid.tread.nodes + component] += pushed[:, of]
        gaps = np.where(near.forces > 0, near.gaps, 0.0).reshape(grid.n_angles, -1)
        return cls(forces, gaps, near.load - near.pressure_integral)

    def gaps_at(self, n_angles: int) -> Array:
        """(k,) gaps with another number of angles."""
        fitted = np.zeros((n_angles, self.gaps.shape[1]))
        count = min(n_angles, len(self.gaps))
        fitted[:count] = self.gaps[:count]
        return fitted.ravel()
