"""What a section is made of: layers, their pieces, and the rating of the tyre."""

from __future__ import annotations

from dataclasses import dataclass

from tyrefem.section.division import Division
from tyrefem.section.profile import Profile


@dataclass(frozen=True)
class Layer:
    """One layer from crown to bead: its thickness along the meridian and the regions it is cut into.

    >>> Layer("rubber", Profile((0.0,), (0.01,)), Division(("tread", "sidewall"), (0.05, 0.15))).name
    'rubber'
    """

    name: str
    thickness: Profile
    regions: Division


@dataclass(frozen=True)
class Piece:
    """Part of one layer between two stations, all of one region."""

    layer: int
    start: float
    end: float
    region: str


@dataclass(frozen=True)
class Rating:
    """What the tyre is rated for, and the bead wire. SI units.

    ``width`` and ``diameter`` are the nominal ones of the deflection law, ``bead_wire_area`` is per bundle.
    """

    width: float
    diameter: float
    load: float
    pressure: float
    cord_angle: float
    bead_wire_area: float
    bead_bundles: int

    @property
    def bead_area(self) -> float:
        """A_B, the bead wire area of all bundles on one side [m2]."""
        return self.bead_wire_area * self.bead_bundles
