"""One mesh topology for sections of different shape: the same elements and names, other places of the nodes.

The grid of a reference section is carried over: a station keeps its share of the way between two marks or kinks of the
section, a node its share of its layer's thickness.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import PickledFields
from tyrefem.cache import Cache
from tyrefem.errors import InputError
from tyrefem.geometry.meshing.mapped import Counts, grid_points, knots, make_grid, mesh_on, rows_of, target_size
from tyrefem.geometry.meshing.mesh import TyreMesh, polygon_areas
from tyrefem.geometry.section import Section

Array = NDArray[np.float64]
#: Name of a station along the meridian, e.g. ("regions", 1, 0): the end of the first region of the second layer.
Label = tuple[Any, ...]
#: m: stations that are closer are the same.
SAME = 1e-9
#: Zone -> (region, start, end) along the meridian, m.
Zones = Mapping[str, tuple[str, float, float]]


class OtherTopologyError(InputError):
    """A section whose grid lines follow each other in another order, or that has other parts."""


def labelled(section: Section) -> dict[Label, float]:
    """Every mark and kink of a section -> its station, m: marks first."""
    stations: dict[Label, float] = {("shoulder",): section.line.shoulder_s}
    stations |= {("boundary", i): end for i, end in enumerate(section.outer.ends[:-1])}
    for k, layer in enumerate(section.layers):
        stations |= {("region", k, i): end for i, end in enumerate(layer.regions.ends[:-1])}
    stations |= {("line", i): s for i, s in enumerate(section.line.breaks)}
    for k, layer in enumerate(section.layers):
        stations |= {("thickness", k, i): s for i, s in enumerate(layer.thickness.s)}
    return stations


def knot_labels(section: Section, size: float) -> tuple[Label, ...]:
    """Labels of the grid lines between crown and bead at a size, m."""
    stations = labelled(section)
    return tuple(
        next(label for label, s in stations.items() if abs(s - knot) < SAME) for knot in knots(section, size)[1:-1]
    )


def stations_of(section: Section, labels: Sequence[Label]) -> Array:
    """Stations of labels, with crown and bead, m.

    Raises
    ------
    OtherTopologyError : a label is missing, the stations do not rise, or a mark lies between them.
    """
    stations = labelled(section)
    try:
        inner = [stations[label] for label in labels]
    except KeyError as error:
        raise OtherTopologyError(
            f"the section has no {error.args[0][0]} {error.args[0][1:]}", field="section"
        ) from None
    at = np.array([0.0, *inner, section.line.length])
    if (np.diff(at) < SAME).any():
        raise OtherTopologyError("its marks and kinks follow each other in another order", field="section")
    if any(np.abs(at - mark).min() > SAME for mark in section.marks):
        raise OtherTopologyError(
            "two of its marks lie on each other in one shape and apart in another", field="section"
        )
    return at


def common_counts(reference: Section, sections: Sequence[Section], size: float, through: int) -> Counts:
    """Rows and gaps of the reference section's grid that are enough for all sections.

    Raises
    ------
    OtherTopologyError : a section has other marks than the reference, or in another order.
    """
    reference, labels = reference.as_half(), knot_labels(reference.as_half(), size)
    halves = [reference, *(section.as_half() for section in sections)]
    for half in halves:
        if _parts(half) != _parts(reference):
            raise OtherTopologyError("its layers have other regions", field="section")
    layers = range(len(reference.layers))
    rows = tuple(max(rows_of(half, index, size, through) for half in halves) for index in layers)
    gaps = np.zeros(len(labels) + 1, dtype=int)
    for half in halves:
        local_size = target_size(half, size, rows)
        for number, (a, b) in enumerate(pairwise(stations_of(half, labels))):
            density = 1 / local_size(np.linspace(a, b, 400))
            needed = (b - a) * float((density[1:] + density[:-1]).mean() / 2)
            gaps[number] = max(gaps[number], int(np.ceil(needed - 1e-6)), 1)
    return Counts(rows, tuple(int(gap) for gap in gaps))


def _parts(section: Section) -> tuple[Any, ...]:
    return (*(layer.regions.names for layer in section.layers), section.outer.names, section.wrap, section.half)


@dataclass(frozen=True, eq=False)
class Topology(PickledFields):
    """The mesh of a reference section, and where its nodes lie in another section.

    Parameters
    ----------
    reference : the section, half or full. size, through : of its mesh. counts : rows and gaps, at least.
    """

    reference: Section
    size: float
    through: int
    counts: Counts

    @functools.cached_property
    def labels(self) -> tuple[Label, ...]:
        """Labels of the grid lines between crown and bead."""
        return knot_labels(self.reference.as_half(), self.size)

    @functools.cached_property
    def _grid(self) -> Any:
        return make_grid(self.reference.as_half(), self.size, self.through, self.counts)

    @functools.cached_property
    def mesh(self) -> TyreMesh:
        """The mesh of the reference section."""
        return TyreMesh(mesh_on(self.reference, self._grid, "quad"), self.reference, "mapped", self.size, "quad")

    @functools.cached_property
    def _shares(self) -> tuple[NDArray[np.intp], Array, NDArray[np.intp], Array]:
        """Span and share of every column; layer of every line of nodes, and its share of the layer there."""
        grid, half = self._grid, self.reference.as_half()
        at = stations_of(half, self.labels)
        span = np.clip(np.searchsorted(at, grid.s, side="right") - 1, 0, len(at) - 2)
        share = (grid.s - at[span]) / np.diff(at)[span]
        faces = half.interfaces(grid.s)
        layer = np.concatenate([grid.layer[:1], grid.layer])
        within = (grid.y - faces[layer]) / (faces[layer + 1] - faces[layer])
        return span, share, layer, within

    @functools.cached_property
    def nodes(self) -> tuple[NDArray[np.intp], NDArray[np.intp], Array]:
        """Line, column and side (1 or -1) of every node of the mesh."""
        from scipy.spatial import cKDTree

        points = grid_points(self.reference.as_half(), self._grid.s, self._grid.y).reshape(-1, 2)
        p = self.mesh.mesh.p.T
        _, number = cKDTree(points).query(np.column_stack([p[:, 0], np.abs(p[:, 1])]))
        side = np.where(p[:, 1] < 0, -1.0, 1.0)
        line, column = np.divmod(number, len(self._grid.s))
        return line, column, side

    def grid(self, section: Section) -> tuple[Array, Array]:
        """Stations (n_columns,) and heights above the meridian (n_lines, n_columns) in another section, m."""
        grid: tuple[Array, Array] = self._grids.get(section, lambda: self._grid_of(section))
        return grid

    @functools.cached_property
    def _grids(self) -> Cache[tuple[Array, Array]]:
        return Cache(size=64)

    def _grid_of(self, section: Section) -> tuple[Array, Array]:
        span, share, layer, within = self._shares
        at = stations_of(section, self.labels)
        s = at[span] + share * np.diff(at)[span]
        faces = section.interfaces(s)
        return s, faces[layer] + within * (faces[layer + 1] - faces[layer])

    def mesh_of(self, section: Section, zones: Zones) -> TyreMesh:
        """The mesh of another section with zones; the same elements as in the reference section.

        Raises
        ------
        OtherTopologyError : the section has other marks or zones, or an element would fold over.
        """
        zoned = self.zoned(tuple(zones), tuple(zone[0] for zone in zones.values()), self._ends(section, zones))
        return replace(zoned, mesh=replace(zoned.mesh, doflocs=self.points(section)), section=section)

    def points(self, section: Section) -> Array:
        """(2, n_nodes) places of the nodes in another section, m.

        Raises
        ------
        OtherTopologyError : the section has other marks, or an element would fold over.
        """
        if _parts(section) != _parts(self.reference):
            raise OtherTopologyError("its layers have other regions", field="section")
        s, y = self.grid(section)
        line, column, side = self.nodes
        p = grid_points(section if section.half else section.as_half(), s, y)[line, column].T
        p[1] *= side
        if not polygon_areas(p.T[self.mesh.mesh.t]).min() > 0:
            raise OtherTopologyError("elements of the common mesh would fold over", field="section")
        return np.ascontiguousarray(p)

    def _ends(self, section: Section, zones: Zones) -> tuple[tuple[int, int], ...]:
        """Numbers of the grid lines at which zones start and end."""
        at = stations_of(section, self.labels)
        ends = []
        for name, (_, start, end) in zones.items():
            first, last = (int(np.abs(at - min(s, at[-1])).argmin()) for s in (start, end))
            if abs(at[first] - start) > SAME or abs(at[last] - min(end, at[-1])) > SAME:
                raise OtherTopologyError(f"the strain zone '{name}' ends between two grid lines", field="section")
            ends.append((first, last))
        return tuple(ends)

    def zoned(self, names: tuple[str, ...], regions: tuple[str, ...], ends: tuple[tuple[int, int], ...]) -> TyreMesh:
        """The reference mesh with zones between numbered grid lines."""
        key = (names, regions, ends)
        if key not in self._zoned:
            at = stations_of(self.reference, self.labels)
            stations = [(at[first], at[last] if last < len(at) - 1 else np.inf) for first, last in ends]
            self._zoned[key] = self.mesh.with_zones(
                {name: (region, *pair) for name, region, pair in zip(names, regions, stations, strict=True)}
            )
        return self._zoned[key]

    @functools.cached_property
    def _zoned(self) -> dict[Any, TyreMesh]:
        return {}

    @functools.cached_property
    def elements(self) -> NDArray[np.int64]:
        """(2, n_rows, n_columns - 1) element of every grid cell of the sides z >= 0 and z < 0; -1: none there."""
        line, column, side = self.nodes
        t = self.mesh.mesh.t
        number = np.full((2, len(self._grid.y) - 1, len(self._grid.s) - 1), -1)
        below = (side[t] < 0).any(axis=0).astype(int)
        number[below, line[t].min(axis=0), column[t].min(axis=0)] = np.arange(t.shape[1])
        return number
