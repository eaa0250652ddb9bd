"""Strain energy given in the study by region: an estimate for tyres to which no strain law applies."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from tyrefem.inputs.study_card import Rows
from tyrefem.mechanics.strain_cycle import Zone

if TYPE_CHECKING:
    from collections.abc import Mapping

    from tyrefem.geometry import Section
    from tyrefem.inputs.loading import LoadCase

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Given:
    """U = U_given(s) (D / D_given)^2 m: linear elasticity scales the given energy to other deflections D [m].

    m, ``softened``, is a region's modulus over that at which the energy was given; 1 where it is missing.

    >>> from tyrefem.inputs.loading import LoadCase
    >>> from tyrefem.geometry import load
    >>> section, rows = load("passenger-205-55r16"), ((0.0, 1e4), (0.08, 3e4))
    >>> cycle = Given(section, {"tread": rows}, 0.02, LoadCase(2e3, 0.01, 2.1e5, 0.316))
    >>> points = section.place([0.0, 0.04], [0.014, 0.014]).T
    >>> cycle.energy_density("tread", points).round(6).tolist()
    [2500.0, 5000.0]
    """

    section: Section
    regions: Mapping[str, Rows]
    deflection: float
    case: LoadCase
    softened: Mapping[str, float] = field(default_factory=dict)

    @property
    def zones(self) -> tuple[Zone, ...]:
        """The regions."""
        return tuple(Zone(region, region, region) for region in self.regions)

    def energy_density(self, zone: str, points: Array) -> Array:
        """U, J/m3, at points (2, n) of a region."""
        s, _ = self.section.locate(np.asarray(points, dtype=float).T)
        stations, energies = np.transpose(self.regions[zone])
        factor = (self.case.deflection / self.deflection) ** 2 * self.softened.get(zone, 1.0)
        return np.asarray(np.interp(np.abs(s), stations, energies) * factor)
