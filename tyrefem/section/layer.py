"""What a section is made of: layers, their pieces, and the rating of the tyre; and how these are read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.section.division import Division
from tyrefem.section.line import Line
from tyrefem.section.profile import Profile

Array = NDArray[np.float64]


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


class Layered(Protocol):
    """Layers along a meridian, as measures, outlines, checks and warnings read them; a `Section` is one."""

    @property
    def name(self) -> str: ...
    @property
    def half(self) -> bool: ...
    @property
    def line(self) -> Line: ...
    @property
    def layers(self) -> tuple[Layer, ...]: ...
    @property
    def built_layers(self) -> tuple[Layer, ...]: ...
    @property
    def outer(self) -> Division: ...
    @property
    def pieces(self) -> tuple[Piece, ...]: ...
    @property
    def grooves(self) -> tuple[tuple[float, float], ...]: ...
    @property
    def groove_boundary(self) -> str: ...
    @property
    def breaks(self) -> tuple[float, ...]: ...
    @property
    def regions(self) -> tuple[str, ...]: ...
    @property
    def boundaries(self) -> tuple[str, ...]: ...
    @property
    def rating(self) -> Rating | None: ...
    @property
    def nominal_width(self) -> float: ...
    @property
    def overall_width(self) -> float: ...
    @property
    def outer_diameter(self) -> float: ...
    def require_region(self, name: str) -> None: ...
    def interfaces(self, s: ArrayLike) -> Array: ...
    def interface_slopes(self, s: ArrayLike) -> Array: ...
    def place(self, s: ArrayLike, depth: ArrayLike) -> Array: ...
    def total_thickness(self, s: ArrayLike) -> Array: ...
    def area(self, region: str | None = None) -> float: ...
    def volume(self, region: str | None = None) -> float: ...
    def inner_surface_area(self) -> float: ...
    def gas_volume(self) -> float: ...
