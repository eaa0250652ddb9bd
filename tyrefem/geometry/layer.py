"""The layers of a section: thickness along the meridian, named parts and pieces; and the rating of the tyre.

A `Profile` holds a tabulated quantity, a `Division` the names along the meridian.

`Layered` is what measures, outlines, checks and warnings read of a section.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.brief import PickledFields
from tyrefem.errors import InputError
from tyrefem.geometry.meridian import Line
from tyrefem.geometry.tread_pattern import TreadPattern

Array = NDArray[np.float64]


#: Smallest and largest thickness of a layer [m], for all tyres; beyond it elements degenerate.
THINNEST, THICKEST = 1e-5, 1.0


@dataclass(frozen=True)
class Profile(PickledFields):
    """Values at stations ``s`` along the meridian [m], symmetric in ``s``.

    Parameters
    ----------
    s : stations, strictly increasing [m]; the profile is constant outside them.
    values : one value per station [m].
    interpolation : ``"linear"``, or ``"pchip"`` (smooth, and monotone between stations).

    Raises
    ------
    InputError : tables of different length, stations out of order, a value that is not positive.

    >>> thickness = Profile((0.0, 0.1), (0.02, 0.01))
    >>> thickness([0.05, -0.05, 0.2]).tolist()
    [0.015, 0.015, 0.01]
    >>> thickness.slope([0.05, -0.05]).round(12).tolist()
    [-0.1, 0.1]
    """

    s: tuple[float, ...]
    values: tuple[float, ...]
    interpolation: str = "linear"

    def __post_init__(self) -> None:
        s, values = np.asarray(self.s, dtype=float), np.asarray(self.values, dtype=float)
        if len(s) == 0 or len(s) != len(values):
            raise InputError(f"has {len(values)} values for {len(s)} stations s; one each is wanted")
        if not (np.isfinite(s).all() and np.isfinite(values).all()):
            raise InputError("holds a number that is not finite")
        if (np.diff(s) <= 0).any():
            first = int(np.argmax(np.diff(s) <= 0))
            raise InputError(f"stations s must rise, but {s[first + 1]:g} m follows {s[first]:g} m")
        if (values <= 0).any():
            raise InputError(f"must be positive everywhere, but is {values.min():g} m")
        if values.min() < THINNEST or values.max() > THICKEST:
            raise InputError(
                f"must be from {THINNEST:g} to {THICKEST:g} m, but goes from {values.min():g} to {values.max():g} m"
            )
        if self.interpolation == "pchip" and len(s) < 2:
            raise InputError("pchip interpolation needs two stations or more")

    @cached_property
    def _table(self) -> tuple[Array, Array]:
        return np.asarray(self.s, dtype=float), np.asarray(self.values, dtype=float)

    @cached_property
    def _pchip(self) -> tuple[Any, Any]:
        from scipy.interpolate import PchipInterpolator

        curve = PchipInterpolator(self.s, self.values)
        return curve, curve.derivative()

    def __call__(self, s: ArrayLike) -> Array:
        """The value at ``s`` (any shape) [m]."""
        x = np.abs(np.asarray(s, dtype=float))
        if self.interpolation == "pchip":
            return np.asarray(self._pchip[0](np.clip(x, self.s[0], self.s[-1])))
        return np.asarray(np.interp(x, *self._table))

    def slope(self, s: ArrayLike) -> Array:
        """d value/ds at ``s`` (any shape); at a kink, the slope on the side of larger ``|s|``."""
        s = np.asarray(s, dtype=float)
        stations, x = np.asarray(self.s), np.abs(s)
        inside = (x >= stations[0]) & (x < stations[-1])
        if self.interpolation == "pchip":
            slope = self._pchip[1](np.clip(x, stations[0], stations[-1]))
        elif len(stations) == 1:
            slope = np.zeros_like(x)
        else:
            pieces = np.diff(self.values) / np.diff(stations)
            slope = pieces[np.clip(np.searchsorted(stations, x, side="right") - 1, 0, len(pieces) - 1)]
        return np.asarray(np.where(inside, slope, 0.0) * np.where(s < 0, -1.0, 1.0))


@dataclass(frozen=True)
class Division:
    """Named parts of the meridian, from the crown to the bead.

    Parameters
    ----------
    names : of the parts.
    ends : of the parts, increasing [m]; the last is the end of the section.

    Raises
    ------
    InputError : a part that ends before its start, which thus has no length.

    >>> outer = Division(("tread", "sidewall"), (0.05, 0.15))
    >>> outer.at([0.02, 0.05, -0.1]).tolist()
    ['tread', 'tread', 'sidewall']
    """

    names: tuple[str, ...]
    ends: tuple[float, ...]

    def __post_init__(self) -> None:
        start = 0.0
        for name, end in zip(self.names, self.ends, strict=True):
            if not end > start + 1e-9:
                raise InputError(
                    f"'{name}' never appears: it begins at s = {start:g} m, where the part before it ends, and ends at"
                    f" {end:g} m; parts follow each other from crown to bead and cannot overlap"
                )
            start = end

    def at(self, s: ArrayLike) -> NDArray[np.str_]:
        """The name at ``s`` (any shape, either side); a border belongs to the part nearer the crown."""
        s = np.abs(np.asarray(s, dtype=float))
        return np.asarray(self.names)[np.searchsorted(np.asarray(self.ends[:-1]) + 1e-12, s)]

    def cut(self, start: float, end: float, name: str) -> Division:
        """The division with another name between two stations.

        Raises
        ------
        InputError : the interval is not within one part.

        >>> Division(("tread",), (0.1,)).cut(0.02, 0.03, "groove").parts()
        [('tread', 0.0, 0.02), ('groove', 0.02, 0.03), ('tread', 0.03, 0.1)]
        """
        pieces: list[tuple[str, float]] = []
        begin, matched = 0.0, False
        for part, stop in zip(self.names, self.ends, strict=True):
            if begin - 1e-9 <= start and end < stop - 1e-9:
                matched = True
                pieces += [(part, start)] if start > begin + 1e-9 else []
                pieces.append((name, end))
            pieces.append((part, stop))
            begin = stop
        if not matched:
            raise InputError(f"'{name}' from {start:.4g} to {end:.4g} m does not lie within one part of it")
        return Division(tuple(part for part, _ in pieces), tuple(stop for _, stop in pieces))

    def parts(self) -> list[tuple[str, float, float]]:
        """(name, start, end) of each part; neighbours of the same name are joined."""
        parts: list[tuple[str, float, float]] = []
        start = 0.0
        for name, end in zip(self.names, self.ends, strict=True):
            if parts and parts[-1][0] == name:
                parts[-1] = (name, parts[-1][1], end)
            else:
                parts.append((name, start, end))
            start = end
        return parts


@dataclass(frozen=True)
class Layer:
    """One layer from crown to bead: its thickness along the meridian and its regions.

    >>> Layer("rubber", Profile((0.0,), (0.01,)), Division(("tread", "sidewall"), (0.05, 0.15))).name
    'rubber'
    """

    name: str
    thickness: Profile
    regions: Division


@dataclass(frozen=True)
class Piece:
    """Part of one layer between two stations, within one region."""

    layer: int
    start: float
    end: float
    region: str


@dataclass(frozen=True)
class Rating:
    """Rated load and pressure, nominal size, and bead wire. SI units.

    ``width`` and ``diameter`` are the nominal ones of the deflection law; ``bead_wire_area`` is per bundle.
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
    """Data of layers along a meridian that measures, outlines, checks and warnings read; a `Section` has them."""

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
    def inner_volume(self) -> float | None: ...
    @property
    def pattern(self) -> TreadPattern | None: ...
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
