"""Strain energy that a study gives region by region: estimated, where no law here fits the tyre."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field

from tyrefem.cards import Card, Temperature, Text
from tyrefem.errors import InputError, InputWarning, nearest
from tyrefem.quantity import Unit
from tyrefem.strain import Zone

if TYPE_CHECKING:
    from collections.abc import Mapping

    from tyrefem.loading import LoadCase
    from tyrefem.section import Section

Array = NDArray[np.float64]
Rows = tuple[tuple[float, float], ...]


def _rows(value: Any) -> Rows:
    """``"12 kJ/m**3"``, or rows ``[["0 mm", "12 kJ/m**3"], ...]`` along the meridian, s rising."""
    if not isinstance(value, list | tuple):
        return ((0.0, Unit("J/m**3", ge=0)(value)),)
    if not value or not all(isinstance(row, list | tuple) and len(row) == 2 for row in value):
        raise InputError("must be like '12 kJ/m**3' or rows [['0 mm', '12 kJ/m**3'], ['70 mm', '20 kJ/m**3']]")
    rows = tuple((Unit("m", ge=0)(s), Unit("J/m**3", ge=0)(energy)) for s, energy in value)
    if any(after <= before for (before, _), (after, _) in pairwise(rows)):
        raise InputError("the distances from the crown must rise from row to row")
    return rows


class GivenEnergy(Card):
    """Strain energy per cycle U, J/m3, of every region at one load and pressure.

    ``regions``: a number, or rows of distance from the crown and energy, linear between them and constant beyond.
    ``temperature``: at which the energies hold, degC; where it is given they follow the modulus (with
    ``mechanics.feedback``).
    """

    load: Annotated[float, Unit("N", gt=0)]
    pressure: Annotated[float, Unit("Pa", gt=0)]
    temperature: Temperature | None = None
    regions: dict[str, Annotated[Rows, BeforeValidator(_rows)]] = Field(min_length=1)
    source: Text

    def check_regions(self, section: Section) -> None:
        """Raise `InputError` unless exactly the section's regions are given."""
        for region in self.regions:
            if region not in section.regions:
                message = f"section '{section.name}' has no region '{region}'{nearest(region, section.regions)}"
                raise InputError(message, field="regions")
        for region in section.regions:
            if region not in self.regions:
                raise InputError(f"no strain energy for region '{region}' (it may be '0 J/m**3')", field="regions")

    def without_effect(self, section: Section) -> tuple[InputWarning, ...]:
        """Rows that lie so far outside of their region that no point of it is told by them."""
        warnings = []
        for region, rows in self.regions.items():
            pieces = [piece for piece in section.pieces if piece.region == region]
            if len(rows) < 2 or not pieces:
                continue
            start, end = min(piece.start for piece in pieces), max(piece.end for piece in pieces)
            idle = [s for s, following in pairwise([s for s, _ in rows]) if following <= start + 1e-9]
            idle += [s for before, s in pairwise([s for s, _ in rows]) if before >= end - 1e-9]
            if idle:
                places = ", ".join(f"{s * 1e3:.4g}" for s in idle)
                words = f"rows at {places} mm have no effect: it runs from {start * 1e3:.4g} to {end * 1e3:.4g} mm"
                warnings.append(InputWarning(words, field=f"regions.{region}"))
        return tuple(warnings)


@dataclass(frozen=True, eq=False)
class Given:
    """U = U_given(s) (D / D_given)^2 m: linear elasticity carries the given energy to other deflections D [m].

    m, ``softened``, is a region's modulus over that at which the energy was given; 1 where not given.

    >>> from tyrefem.loading import LoadCase
    >>> from tyrefem.section import load
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
