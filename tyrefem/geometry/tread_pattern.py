"""What transverse grooves and sipes leave of the tread's stiffness."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TreadPattern:
    """Transverse grooves and sipes through the outermost layer, evenly round the wheel.

    Parameters
    ----------
    void : share of the circumference that transverse grooves take.
    block_length : L, rubber between two cuts (groove or sipe) along the circumference, m.

    >>> pattern = TreadPattern(0.08, 0.015)
    >>> pattern.rubber, round(float(pattern.bending(np.array(0.0083))), 3)
    (0.92, 0.907)
    """

    void: float
    block_length: float

    @property
    def rubber(self) -> float:
        """Share of the circumference that is rubber: it bears loads in all directions."""
        return 1 - self.void

    def bending(self, height: Array) -> Array:
        """Shear stiffness along the circumference of blocks of a height h, m, over that of a long rib:

        1 / (1 + h^2 / (3 L^2)).

        A force F on a block of area A moves its top by F h/(G A) + F h^3/(12 E I), E = 3 G, I = A L^2/12: shear, and
        bending between two faces that stay parallel, the belt's and the road's.
        """
        return np.asarray(1 / (1 + (np.asarray(height) / self.block_length) ** 2 / 3))
