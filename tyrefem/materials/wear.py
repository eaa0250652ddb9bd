"""``[wear]`` of a tread's card: rubber that friction takes from its surface."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.materials.properties import Sourced
from tyrefem.quantity import Unit

Array = NDArray[np.float64]


class Wear(Sourced):
    """Depth worn by one passing through the footprint: depth (e / energy)^exponent, e the friction energy per area.

    Exponent 1: the volume worn is proportional to the energy (Schallamach 1958). Severe slip has more.

    Parameters
    ----------
    depth : at ``energy``, m. energy : J/m2 of one passing. exponent : m.

    >>> rubber = Wear.check({"depth": "5 nm", "energy": "1 kJ/m**2", "source": "estimate: example"})
    >>> rubber.of([0.0, 1e3, 2e3]).tolist()
    [0.0, 5e-09, 1e-08]
    """

    depth: Annotated[float, Unit("m", gt=0, le=1e-3)]
    energy: Annotated[float, Unit("J/m**2", gt=0, le=1e7)] = 1e3
    exponent: Annotated[float, Unit("1", gt=0, le=10)] = 1.0

    @property
    def uncertain_fields(self) -> tuple[tuple[str, ...], ...]:
        """None: temperatures do not depend on the table."""
        return ()

    def of(self, energy: ArrayLike) -> Array:
        """Depth of one passing, m, at friction energies, J/m2; same shape."""
        return np.asarray(
            self.depth * (np.maximum(np.asarray(energy, dtype=float), 0.0) / self.energy) ** self.exponent
        )
