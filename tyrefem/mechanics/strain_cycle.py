"""The strain cycle of a rolling tyre: load case -> strain-energy density, zone by zone.

A provider offers ``zones`` (name, region and extent of each) and ``energy_density(zone, points)`` in J/m3.
`arcs` is the NASA report's provider, `given` takes numbers of the study; `tyrefem.inputs.study_card.Mechanics` names
the provider. Two methods are optional:
``spectrum(zone, points)``: U by harmonic order `ORDERS`, (orders, n);
``solved_case``: the load case with the contact that the provider computes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from tyrefem.inputs.loading import LoadCase

#: Energy lost per cycle over U tan d / pi. In the report U stands for E' e0^2; strictly it is half of that (eq 25).
LOSS_FACTOR = {"nasa": 1.0, "sinusoid": 2.0}


Array = NDArray[np.float64]


#: Steps per octave of `ORDERS`.
_STEPS = 4


#: Cycles per revolution by which the strain energy of harmonics is kept: 1, 2^(1/4), 2^(1/2), ... to 362.
ORDERS = tuple(float(x) for x in 2 ** (np.arange(8.5 * _STEPS + 1) / _STEPS))


@dataclass(frozen=True)
class Zone:
    """A part of a region with one strain law: the part of ``region`` between two meridian distances (|s|, m)."""

    name: str
    region: str
    title: str
    start: float = 0.0
    end: float = np.inf


class StrainCycle(Protocol):
    """What a strain provider must offer."""

    @property
    def zones(self) -> tuple[Zone, ...]:
        """The zones, which together cover every region that generates heat."""

    def energy_density(self, zone: str, points: Array) -> Array:
        """Strain energy per cycle U, J/m3, at points (2, n) in (r, z)."""


def solved_case(cycle: StrainCycle, case: LoadCase) -> LoadCase:
    """The load case with the contact that the provider computes; without such a provider the given load case."""
    case_in_contact: LoadCase = getattr(cycle, "solved_case", case)
    return case_in_contact


def by_order(harmonics: Array) -> Array:
    """(orders, ...) values of harmonics (n + 1, ...) shared between the two nearest `ORDERS`, linear in log n.

    The sum over orders is within 0.1 % of that over harmonics for a power law of frequency with the exponent 0.3, and
    within 0.4 % for a single Maxwell element.

    >>> by_order(np.array([0.0, 1.0, 5.0, 8.0])).round(3).tolist()
    [1.0, 0.0, 0.0, 0.0, 5.0, 0.0, 5.281, 2.719]
    """
    place = _STEPS * np.log2(np.arange(1, len(harmonics)))
    if len(place) == 0:
        return np.zeros((1, *np.shape(harmonics)[1:]))
    below = np.floor(place + 1e-9).astype(int)
    above = np.maximum(place - below, 0.0)
    energies = np.zeros((int(np.ceil(place[-1] - 1e-9)) + 1, *np.shape(harmonics)[1:]))
    for n, (order, share) in enumerate(zip(below, above, strict=True), start=1):
        energies[order] += (1 - share) * harmonics[n]
        if share > 1e-9:
            energies[order + 1] += share * harmonics[n]
    return energies
