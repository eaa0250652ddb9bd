"""Elements that fold on the way to a balance: the search makes their stiffness convex."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.footprint.nonlinear import Tangent

Array = NDArray[np.float64]
#: Elements fold in a change if their energy is below this share of the least.
LEAST = 1e-3


@dataclass(eq=False)
class FoldingElements:
    """Elements of a tyre that fold on the way, each from the middle of the contact up to an angle.

    A Newton step far from balance can fold a soft surface element whose neighbours would hold it at the balance: its
    tangent has negative energies, and the search has no end. With their signs turned (`Tangent.convex`) the step is
    shorter in these elements only; the balance itself is that of the exact forces.

    Parameters
    ----------
    reach : (e,) largest angle over half a turn; 0: the element does not fold. Empty at first.
    """

    reach: Array = field(default_factory=lambda: np.zeros(0))

    def __bool__(self) -> bool:
        return bool(self.reach.any())

    def add(self, tangent: Tangent, change: Array) -> bool:
        """Adds elements with a negative energy in a change (highest + 1, n_dofs); whether there are new ones."""
        energies = tangent.energies(change)
        negative = energies < min(LEAST * energies.min(), 0.0)
        reach = (negative * self._angles(energies.shape[1])).max(axis=1)
        before = self.reach if len(self.reach) else np.zeros(len(reach))
        self.reach = np.maximum(before, reach)
        return bool((reach > before).any())

    def convex(self, tangent: Tangent) -> Tangent:
        """The tangent with convex stiffness in these elements."""
        if not self:
            return tangent
        count = len(tangent.outside.round.angles)
        return tangent.convex(self._angles(count) <= self.reach[:, None])

    @staticmethod
    def _angles(count: int) -> Array:
        """(m,) upper ends of the angles' intervals over half a turn."""
        return np.arange(1, count + 1) / count
