"""The cross-section of a tyre: a meridian, layers along it, named regions and boundaries."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.brief import Brief, PickledFields, counted
from tyrefem.errors import InputError, InputWarning, nearest
from tyrefem.geometry import measures, outlines
from tyrefem.geometry.checks import check_possible
from tyrefem.geometry.layer import Division, Layer, Piece, Rating
from tyrefem.geometry.layup import Layup, Wrap
from tyrefem.geometry.meridian import Line
from tyrefem.geometry.plausible import warnings_of
from tyrefem.geometry.tread_pattern import TreadPattern

Array = NDArray[np.float64]
#: Name of the material cut out of the outermost layer: no region, not meshed.
GROOVE = "groove"


@dataclass(frozen=True)
class Section(Brief, PickledFields):
    """An axisymmetric cross-section in (r, z) [m], r from the wheel's axis, z from the mid plane.

    A position is (s, depth): ``s`` along the meridian from the crown, negative on the other side; ``depth`` from the
    inner surface along the meridian's normal. With y the distance from the meridian and kappa its curvature, an area
    element is (1 + kappa y) ds dy.

    Parameters
    ----------
    name : of the section.
    line : the meridian.
    layers : from the inside to the outside.
    reference : position of the meridian: mid-thickness of the layer of this name, or of all layers (``"total"``), or
        the ``"inner"`` or ``"outer"`` face.
    outer : boundaries along the outer face; the end face at the bead belongs to the last one.
    rating : rated load and pressure, bead wire; None where unknown.
    nominal_width : w of the designation, for the shoulder of two arcs [m]; formulas take the rating's width.
    inner_volume : measured air volume of the whole tyre [m3]; None: from the geometry.
    flange_radius : of the rim's flange [m]; None where unknown. flange_centre : (r, z) of its rounding's centre [m].
    groove_boundary : boundary of the walls and bottoms of grooves, the parts of the outermost layer named `GROOVE`.
    half : only z >= 0, with the boundary ``symmetry`` at the mid plane.
    wrap : region in which plies run around the bead, across the layers; None: no such region.
    pattern : transverse grooves and sipes of the outermost layer at the road; None: it has none.
    as_built : the layers before wear, which place the meridian; None: ``layers``.

    Raises
    ------
    InputError : the layers cannot be laid along this line (folding, crossing, below the axis).

    >>> from tyrefem.geometry import load
    >>> section = load("nasa-22x5.5-8pr")
    >>> section.regions
    ('carcass', 'bead', 'tread', 'sidewall')
    >>> point = section.place(0.05, 0.004)
    >>> s, depth = section.locate(point)
    >>> round(float(s), 9), round(float(depth), 9), str(section.region_at(s, depth))
    (0.05, 0.004, 'carcass')
    >>> section.as_full().volume("tread") / section.volume("tread")
    2.0
    """

    name: str
    line: Line
    layers: tuple[Layer, ...]
    reference: str
    outer: Division
    rating: Rating | None
    nominal_width: float
    inner_volume: float | None = None
    half: bool = True
    as_built: tuple[Layer, ...] | None = None
    flange_radius: float | None = None
    flange_centre: tuple[float, float] | None = None
    groove_boundary: str = "outside_air"
    wrap: str | None = None
    pattern: TreadPattern | None = None

    def __post_init__(self) -> None:
        _ = self._layup
        check_possible(self)

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        """Hash of all fields; caches use sections as keys."""
        return hash(tuple(getattr(self, field.name) for field in fields(self)))

    def _facts(self) -> Mapping[str, Any]:
        wear = "" if self.as_built is None else ", worn"
        return {
            "part": f"{'half' if self.half else 'whole'}, {counted(len(self.layers), 'layer')}{wear}",
            "regions": self.regions,
            "boundaries": self.boundaries,
            "diameter": f"{self.outer_diameter * 1e3:.1f} mm, width {self.overall_width * 1e3:.1f} mm",
            "meridian": f"{self.line.length * 1e3:.1f} mm from crown to bead",
            "rating": "unknown"
            if self.rating is None
            else f"{self.rating.load:.6g} N at {self.rating.pressure / 1e3:.4g} kPa",
        }

    # Names

    @cached_property
    def _layup(self) -> Layup:
        return Layup(self.layers, self.reference, self.as_built)

    @property
    def regions(self) -> tuple[str, ...]:
        """Names of the regions, from the inside to the outside."""
        return tuple(dict.fromkeys(piece.region for piece in self.pieces))

    @property
    def boundaries(self) -> tuple[str, ...]:
        """Names of the boundaries."""
        names = ("contained_air", *dict.fromkeys(self.outer.names))
        return (*names, "symmetry") if self.half else names

    @cached_property
    def pieces(self) -> tuple[Piece, ...]:
        """Parts of layers between stations on the side z >= 0, each within one region."""
        return tuple(
            Piece(index, start, end, name)
            for index, layer in enumerate(self.layers)
            for name, start, end in layer.regions.parts()
            if name != GROOVE
        )

    @property
    def crown(self) -> str:
        """The region of the outermost layer at the crown."""
        return next(name for name in self.layers[-1].regions.names if name != GROOVE)

    @property
    def patterned(self) -> str | None:
        """The region that `pattern` cuts: `crown`."""
        return None if self.pattern is None else self.crown

    @cached_property
    def grooves(self) -> tuple[tuple[float, float], ...]:
        """(start, end) of every circumferential groove of the side z >= 0 along the meridian [m]."""
        return tuple((start, end) for name, start, end in self.layers[-1].regions.parts() if name == GROOVE)

    def in_groove(self, s: ArrayLike) -> NDArray[np.bool_]:
        """True for stations inside a groove; its walls are not inside."""
        x = np.abs(np.asarray(s, dtype=float))
        inside = np.zeros(x.shape, dtype=bool)
        for start, end in self.grooves:
            # A groove at the mid plane has no wall there.
            inside |= ((x > start + 1e-9) | (start <= 1e-9)) & (x < end - 1e-9)
        return inside

    @cached_property
    def breaks(self) -> tuple[float, ...]:
        """Stations at which elements and integrals must end: a name changes, or the geometry has a kink [m]."""
        stations = {0.0, self.line.length, self.line.shoulder_s, *self.line.breaks, *self.outer.ends}
        for layer in self.layers:
            stations.update(layer.regions.ends, layer.thickness.s)
        merged: list[float] = []
        for s in sorted(s for s in stations if 0 <= s <= self.line.length):
            if not merged or s - merged[-1] > 1e-9:
                merged.append(s)
        return tuple(merged)

    @cached_property
    def marks(self) -> tuple[float, ...]:
        """Stations where a region or a boundary changes its name, and the shoulder [m]."""
        ends = {self.line.shoulder_s, *self.outer.ends[:-1]}
        for layer in self.layers:
            ends.update(layer.regions.ends[:-1])
        return tuple(s for s in self.breaks if any(abs(s - end) < 1e-9 for end in ends))

    @cached_property
    def warnings(self) -> tuple[InputWarning, ...]:
        """Unlikely values: tables beyond the meridian, kinks, ratings of another tyre."""
        return warnings_of(self)

    @cached_property
    def wrapping(self) -> Wrap | None:
        """Direction of the plies in the region `wrap`; None: no such region."""
        return None if self.wrap is None else Wrap(self, self.wrap)

    def require_region(self, name: str) -> None:
        """Raise `InputError` if ``name`` is not a region."""
        if name not in self.regions:
            raise InputError(f"section '{self.name}' has no region '{name}'{nearest(name, self.regions)}")

    # Places

    def _stations(self, s: ArrayLike) -> Array:
        """Stations in the section's coordinates: |s| for a half section."""
        s = np.asarray(s, dtype=float)
        return np.abs(s) if self.half else s

    def interfaces(self, s: ArrayLike) -> Array:
        """Distance from the meridian to the inner face and to each layer's outer face: (n_layers + 1, ...) [m]."""
        return self._layup.faces(s)

    def interface_slopes(self, s: ArrayLike) -> Array:
        """d/ds of `interfaces`, same shape."""
        return self._layup.slopes(s)

    def thickness(self, name: str, s: ArrayLike) -> Array:
        """Thickness of a layer at ``s``, or of a region (zero where it is absent) [m]. Layer names take precedence."""
        s = self._stations(s)
        for layer in self.layers:
            if layer.name == name:
                return layer.thickness(s)
        self.require_region(name)
        parts = [np.where(layer.regions.at(s) == name, layer.thickness(s), 0.0) for layer in self.layers]
        return np.asarray(np.sum(parts, axis=0))

    def total_thickness(self, s: ArrayLike) -> Array:
        """Thickness of all layers at ``s`` [m]."""
        faces = self.interfaces(self._stations(s))
        return np.asarray(faces[-1] - faces[0])

    def rubber_thickness(self, s: ArrayLike) -> Array:
        """Thickness at stations ``s``, in a groove up to its bottom [m]."""
        faces = self.interfaces(self._stations(s))
        return np.asarray(np.where(self.in_groove(s), faces[-2], faces[-1]) - faces[0])

    def place(self, s: ArrayLike, depth: ArrayLike) -> Array:
        """(r, z) of positions ``s``, ``depth`` from the inner surface, shape (..., 2) [m]."""
        s, depth = np.broadcast_arrays(self._stations(s), np.asarray(depth, dtype=float))
        y = self.interfaces(s)[0] + depth
        return np.asarray(self.line.position(s) + y[..., None] * self.line.normal(s))

    def locate(self, points: ArrayLike) -> tuple[Array, Array]:
        """(s, depth) of points (..., 2), the inverse of `place`; also for points slightly outside.

        A half section mirrors points with z < 0, so ``s`` is never negative there.
        """
        s, y = self.line.nearest(points)
        s = self._stations(s)
        return s, y - self.interfaces(s)[0]

    def ply_direction(self, points: ArrayLike) -> Array:
        """Unit vectors (..., 2) in (r, z) along a radial ply at points (..., 2): along the meridian; in the region
        `wrap` around the bead."""
        s, y = self.line.nearest(points)
        normal = self.line.normal(s)
        along = np.stack([-normal[..., 1], normal[..., 0]], axis=-1)
        if self.wrapping is None:
            return along
        forward, outward = self.wrapping.direction(s, y)
        return np.asarray(forward[..., None] * along + outward[..., None] * normal)

    def clamp(self, s: ArrayLike, depth: ArrayLike, margin: float = 0.0) -> tuple[Array, Array]:
        """The nearest (s, depth) inside the rubber, at least ``margin`` [m] from its surface."""
        end = self.line.length - margin
        inside = np.clip(np.asarray(s, dtype=float), -end, end)
        total = self.rubber_thickness(inside)
        low = np.minimum(margin, total / 2)
        return inside, np.clip(np.asarray(depth, dtype=float), low, total - low)

    def midline_offset(self, place: ArrayLike, depth: ArrayLike | None = None) -> Array:
        """Signed distance from the carcass midline, outwards positive [m].

        ``midline_offset(s, depth)``, or ``midline_offset(points)`` with points (..., 2). The carcass is the layer
        with the region ``carcass``; without one, the distance is from the meridian.
        """
        s, depth = self.locate(place) if depth is None else (self._stations(place), np.asarray(depth, dtype=float))
        faces = self.interfaces(s)
        return np.asarray(faces[0] + depth - self.carcass_offset(s))

    def carcass_offset(self, s: ArrayLike) -> Array:
        """Distance of the carcass midline from the meridian, outwards positive [m]; zero if the line is the midline."""
        s = self._stations(s)
        index = self._layup.carcass
        if index is None:
            return np.zeros_like(s)
        faces = self.interfaces(s)
        return np.asarray((faces[index] + faces[index + 1]) / 2)

    def region_at(self, s: ArrayLike, depth: ArrayLike) -> NDArray[np.str_]:
        """The region at (s, depth), same shape; beyond a surface that of the nearest layer; `GROOVE` in a groove."""
        s, depth = np.broadcast_arrays(self._stations(s), np.asarray(depth, dtype=float))
        faces = self.interfaces(s)
        index = sum(
            (np.asarray(depth > faces[k] - faces[0]).astype(int) for k in range(1, len(self.layers))),
            start=np.zeros(s.shape, dtype=int),
        )
        return np.asarray(np.choose(index, [layer.regions.at(s) for layer in self.layers]))

    def contains(self, points: ArrayLike, tolerance: float = 1e-9) -> NDArray[np.bool_]:
        """True for points (..., 2) in the section or on its surface."""
        points = np.asarray(points, dtype=float)
        s, depth = self.locate(points)
        inside = (np.abs(s) <= self.line.length + tolerance) & (depth >= -tolerance)
        inside &= depth <= self.rubber_thickness(self._stations(s)) + tolerance
        return inside & (points[..., 1] >= -tolerance) if self.half else inside

    # Shape

    def outline(self, region: str, spacing: float = 5e-4) -> list[Array]:
        """Closed polygons (n, 2) of a region, anticlockwise in (r, z), the first point repeated at the end."""
        self.require_region(region)
        return outlines.region_outlines(self, region, spacing)

    def boundary_line(self, name: str, spacing: float = 5e-4) -> list[Array]:
        """Open polylines (n, 2) of a boundary; the last of the outer face includes the end face at the bead."""
        if name not in self.boundaries:
            raise InputError(f"section '{self.name}' has no boundary '{name}'{nearest(name, self.boundaries)}")
        return outlines.boundary_lines(self, name, spacing)

    def area(self, region: str | None = None) -> float:
        """Area of a region or of the section [m2]; for a half section, of that half."""
        return measures.area(self, region)

    def volume(self, region: str | None = None) -> float:
        """Volume of the ring of a region or of the section: the integral of 2 pi r dA [m3]."""
        return measures.volume(self, region)

    def inner_surface_area(self) -> float:
        """Area of the inner surface of revolution [m2]; for a half section, of that half."""
        return measures.inner_surface_area(self)

    def gas_volume(self) -> float:
        """Volume of air inside the tyre, closed by a cylinder from bead to bead [m3]; for a half section, half of it.

        A measured ``inner_volume`` replaces the computed one.
        """
        if self.inner_volume is not None:
            return self.inner_volume / 2 if self.half else self.inner_volume
        return self._gas_volume

    @cached_property
    def _gas_volume(self) -> float:
        return measures.gas_volume(self)

    @cached_property
    def overall_width(self) -> float:
        """Largest width of the whole tyre [m]."""
        return measures.overall_width(self)

    @cached_property
    def outer_diameter(self) -> float:
        """Diameter over the crown [m]."""
        return 2 * float(self.line.position(0.0)[0] + self.interfaces(0.0)[-1])

    @property
    def built_layers(self) -> tuple[Layer, ...]:
        """The layers before wear."""
        return self.layers if self.as_built is None else self.as_built

    def worn(self, region: str, fraction: float) -> Section:
        """The section with a fraction of a region's thickness removed from its outside; all other parts keep their
        place.

        Between two stations of the layer's table the thickness changes gradually to that of the neighbouring region.

        Raises
        ------
        InputError : no such region, or it is not in the outermost layer.

        >>> from tyrefem.geometry import load
        >>> new = load("nasa-22x5.5-8pr")
        >>> old = new.worn("tread", 0.5)
        >>> float(old.thickness("tread", 0.0) / new.thickness("tread", 0.0))
        0.5
        >>> bool((old.place(0.01, 0.004) == new.place(0.01, 0.004)).all())
        True
        """
        self.require_region(region)
        *inner, outer = self.layers
        if region not in outer.regions.names:
            raise InputError(f"region '{region}' is not on the outside of section '{self.name}' and cannot wear")
        profile = outer.thickness
        uncut = list(outer.regions.names)
        for place in reversed(range(len(uncut) - 1)):
            # A groove lies within one region, which goes on behind it.
            uncut[place] = uncut[place + 1] if uncut[place] == GROOVE else uncut[place]
        names = Division(tuple(uncut), outer.regions.ends).at(profile.s)
        left = np.where(names == region, 1.0 - fraction, 1.0)
        thinner = replace(profile, values=tuple((np.asarray(profile.values) * left).tolist()))
        layers = (*inner, replace(outer, thickness=thinner))
        return replace(self, layers=layers, as_built=self.built_layers)

    def as_full(self) -> Section:
        """The whole section, from bead to bead."""
        return replace(self, half=False)

    def as_half(self) -> Section:
        """The half z >= 0."""
        return replace(self, half=True)

    def summary(self) -> dict[str, Any]:
        """Main dimensions, SI; areas and volumes of a half section are those of that half."""
        return measures.summary(self)
