"""The strain cycle of a rolling tyre: load case -> strain-energy density, zone by zone.

A provider offers ``zones`` (name, region and extent of each) and ``energy_density(zone, points)`` in J/m3.
`arcs` is the NASA report's, `given` takes the study's own numbers; `tyrefem.study_card.Mechanics` names the provider.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Zone:
    """A part of a region with one strain law: ``region`` between two meridian distances (|s|, m)."""

    name: str
    region: str
    title: str
    start: float = 0.0
    end: float = np.inf


class StrainCycle(Protocol):
    """What a strain provider must offer."""

    @property
    def zones(self) -> tuple[Zone, ...]:
        """The zones, which together cover every region that makes heat."""

    def energy_density(self, zone: str, points: Array) -> Array:
        """Strain energy per cycle U, J/m3, at points (2, n) in (r, z)."""
