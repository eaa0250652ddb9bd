"""A mesh of a section: a scikit-fem mesh with names, its section and mesher.

`build` makes a mesh from a section and a size with any mesher.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief, PickledFields
from tyrefem.errors import InputError, nearest
from tyrefem.estimates.work import check_memory, matrices, smallest
from tyrefem.geometry.meshing.expected import expected_nodes
from tyrefem.geometry.section import Section

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PlyDirection:
    """Unit vector along the meridian at points (2, n): the direction of the plies; in the section's region `wrap` the
    plies turn."""

    section: Section

    def __call__(self, x: Array) -> Array:
        return np.ascontiguousarray(np.moveaxis(self.section.ply_direction(np.asarray(x).T), -1, 0))


@dataclass(frozen=True, eq=False)
class TyreMesh(Brief, PickledFields):
    """A mesh of a section in (r, z) [m].

    Parameters
    ----------
    mesh : scikit-fem ``MeshQuad`` or ``MeshTri``; ``mesh.subdomains`` are the section's regions,
        ``mesh.boundaries`` its boundaries.
    section : the meshed section.
    mesher : ``"mapped"``, ``"gmsh"`` or ``"file"``.
    size : target for the largest edge along the meridian [m].
    cell : ``"quad"`` or ``"tri"``.
    """

    mesh: Any
    section: Section
    mesher: str
    size: float
    cell: str

    def _title(self) -> str:
        return f"of {self.section.name}"

    def _facts(self) -> Mapping[str, Any]:
        kind = {"quad": "quadrilaterals", "tri": "triangles"}.get(self.cell, self.cell)
        return {
            "made by": f"{self.mesher}, edges of {self.size * 1e3:.3g} mm at most along the meridian",
            "size": f"{self.n_nodes} nodes, {self.n_elements} {kind}",
            "part": f"{'half' if self.section.half else 'whole'} section",
            "regions": self.mesh.subdomains or {},
            "boundaries": self.mesh.boundaries or {},
            **self.quality,
        }

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return int(self.mesh.p.shape[1])

    @property
    def n_elements(self) -> int:
        """Number of elements."""
        return int(self.mesh.t.shape[1])

    @cached_property
    def _corners(self) -> Array:
        """Corner points of the elements, (n_corners, n_elements, 2)."""
        return np.asarray(self.mesh.p.T[self.mesh.t])

    @cached_property
    def element_areas(self) -> Array:
        """Signed area of every element [m2]."""
        return polygon_areas(self._corners)

    @cached_property
    def _stations(self) -> Array:
        """|s| of the elements' corners, (n_corners, n_elements) [m]."""
        return np.asarray(np.abs(self.section.locate(self.mesh.p.T)[0])[self.mesh.t])

    def area(self, region: str) -> float:
        """Area of a region of the mesh [m2]."""
        return float(self.element_areas[self.mesh.subdomains[region]].sum())

    def volume(self, region: str) -> float:
        """Volume of the ring of a region of the mesh, exact for its straight-sided elements [m3]."""
        corners = self._corners[:, self.mesh.subdomains[region]]
        total = 0.0
        for k in range(1, len(corners) - 1):
            triangle = corners[[0, k, k + 1]]
            total += float((polygon_areas(triangle) * triangle[..., 0].mean(axis=0)).sum())
        return 2 * np.pi * total

    def ring_points(self, region: str) -> tuple[Array, Array]:
        """Quadrature of third order over the ring of a region: points (2, n) in (r, z), m, and weights (n,), m3.

        The weights are those of the whole tyre: a half section counts twice.
        """
        import skfem

        element = skfem.ElementQuad1() if isinstance(self.mesh, skfem.MeshQuad) else skfem.ElementTriP1()
        basis = skfem.Basis(self.mesh, element, elements=self.mesh.subdomains[region], intorder=3)
        points = np.asarray(basis.global_coordinates()).reshape(2, -1)
        sides = 2 if self.section.half else 1
        return points, np.asarray(basis.dx).ravel() * points[0] * 2 * np.pi * sides

    def elements_between(self, start: float, end: float, region: str | None = None) -> NDArray[np.int64]:
        """Elements between two stations ``start < |s| < end`` of the meridian, of one region or of all.

        Raises
        ------
        InputError : a station inside elements; stations of ``section.breaks`` are always between elements.
        """
        s = self._stations
        middle = (s.mean(axis=0) > start) & (s.mean(axis=0) < end)
        inside = (s > start - 1e-6) & (s < end + 1e-6)
        outside = (s < start + 1e-6) | (s > end - 1e-6)
        if not np.where(middle, inside, outside).all():
            cut = [at for at in (start, end) if ((s.min(axis=0) < at - 1e-6) & (s.max(axis=0) > at + 1e-6)).any()]
            named = " and ".join(f"{at * 1e3:.6g} mm" for at in cut or (start, end))
            raise InputError(f"the mesh has no line at s = {named}; elements would be cut")
        chosen = np.flatnonzero(middle)
        return chosen if region is None else np.intersect1d(chosen, self.mesh.subdomains[region])

    def with_zones(self, zones: Mapping[str, tuple[str, float, float]]) -> TyreMesh:
        """The same mesh with further subdomains: name -> (region, start, end) along the meridian.

        >>> from tyrefem.geometry import load
        >>> from tyrefem.geometry.meshing import build
        >>> tyre = build(load("nasa-22x5.5-8pr"), size=4e-3)
        >>> shoulder = tyre.section.line.shoulder_s
        >>> zoned = tyre.with_zones({"under the tread": ("carcass", 0.0, shoulder)})
        >>> len(zoned.mesh.subdomains["under the tread"]) < len(zoned.mesh.subdomains["carcass"])
        True
        """
        zone_elements = {
            name: self.elements_between(start, end, region) for name, (region, start, end) in zones.items()
        }
        return replace(self, mesh=self.mesh.with_subdomains(zone_elements))

    @cached_property
    def along_meridian(self) -> PlyDirection:
        """The direction of the plies, always the same function."""
        return PlyDirection(self.section)

    @property
    def _sides(self) -> Array:
        """Vectors from every corner of the elements to the next, (n_corners, n_elements, 2) [m]."""
        return np.roll(self._corners, -1, axis=0) - self._corners

    @property
    def corner_sines(self) -> Array:
        """Sine of the angle at every corner, (n_corners, n_elements): not positive where an element is not convex, NaN
        where a side has no length."""
        sides = self._sides
        before, lengths = np.roll(sides, 1, axis=0), np.linalg.norm(sides, axis=-1)
        cross = before[..., 0] * sides[..., 1] - before[..., 1] * sides[..., 0]
        with np.errstate(invalid="ignore"):
            sines = cross / (lengths * np.roll(lengths, 1, axis=0))
        return np.asarray(sines * np.sign(self.element_areas))

    @cached_property
    def quality(self) -> dict[str, float]:
        """Smallest scaled Jacobian (1: right angles) and largest edge ratio over the elements."""
        lengths = np.linalg.norm(self._sides, axis=-1)
        return {
            "scaled_jacobian": float(self.corner_sines.min()),
            "edge_ratio": float((lengths.max(axis=0) / lengths.min(axis=0)).max()),
        }

    def summary(self) -> dict[str, Any]:
        """Counts, sizes and quality, for reports."""
        return {
            "mesher": self.mesher,
            "cell": self.cell,
            "size_m": self.size,
            "nodes": self.n_nodes,
            "elements": self.n_elements,
            "half": self.section.half,
            **self.quality,
        }


def polygon_areas(corners: Array) -> Array:
    """Signed areas of polygons with corners (n_corners, n, 2), anticlockwise positive."""
    after = np.roll(corners, -1, axis=0)
    cross = corners[..., 0] * after[..., 1] - corners[..., 1] * after[..., 0]
    return np.asarray(cross.sum(axis=0) / 2)


MESHERS = ("mapped", "gmsh")
CELLS = {"mapped": ("quad", "tri"), "gmsh": ("tri", "quad")}


def build(
    section: Section,
    *,
    mesher: str = "mapped",
    size: float = 2e-3,
    cell: str | None = None,
    through: int = 3,
) -> TyreMesh:
    """Mesh of a section with named regions and boundaries.

    Parameters
    ----------
    section : half or full; the mesh of a full section is its half and the mirror image.
    mesher : ``"mapped"`` (structured) or ``"gmsh"`` (unstructured, needs the ``gmsh`` extra).
    size : largest edge along the meridian [m]; all other sizes of the mesh are proportional to it.
    cell : ``"quad"`` or ``"tri"``; by default quadrilaterals when mapped, triangles from gmsh.
    through : fewest elements through every layer.

    Raises
    ------
    InputError : unknown mesher or cell; a size out of range or too coarse for the section; more nodes than memory for
        linear elements.
    MissingLibraryError : gmsh cannot be loaded.

    >>> from tyrefem.geometry import load
    >>> tyre = build(load("nasa-22x5.5-8pr"), size=4e-3)
    >>> sorted(tyre.mesh.subdomains), tyre.cell
    (['bead', 'carcass', 'sidewall', 'tread'], 'quad')
    >>> bool(abs(tyre.area("tread") / tyre.section.area("tread") - 1) < 1e-2)
    True
    """
    if not isinstance(section, Section):
        raise InputError(f"must be a section, as tyrefem.geometry.load gives it, not {section!r:.60}", field="section")
    if mesher not in MESHERS:
        raise InputError(f"no mesher '{mesher}'{nearest(mesher, MESHERS)}", field="mesher")
    cell = cell or CELLS[mesher][0]
    if cell not in CELLS[mesher]:
        raise InputError(f"no cell '{cell}'{nearest(cell, CELLS[mesher])}", field="cell")
    if not isinstance(size, Real) or not (math.isfinite(size) and size > 0):
        raise InputError(f"must be a positive length, not {size!r:.60}", field="size")
    if not isinstance(through, Real) or not math.isfinite(through) or through < 1 or through != int(through):
        raise InputError(f"must be a whole number, 1 or more, not {through!r}", field="through")
    if size > section.line.length / 4:
        raise InputError(
            f"{size:g} m is too coarse: at most a quarter of the meridian, {section.line.length / 4:.3g} m",
            field="size",
        )
    _check_memory(section, mesher, size, int(through))
    if mesher == "mapped":
        from tyrefem.geometry.meshing.mapped import mapped_mesh

        mesh = mapped_mesh(section, size, cell, int(through))
    else:
        from tyrefem.geometry.meshing.gmsh import gmsh_mesh

        mesh = gmsh_mesh(section, size, cell, int(through))
    tyre = TyreMesh(mesh, section, mesher, size, cell)
    if not tyre.quality["scaled_jacobian"] > 0:
        raise InputError(f"elements of {size:g} m fold over in this section; choose a smaller size", field="size")
    return tyre


def _check_memory(section: Section, mesher: str, size: float, through: int) -> None:
    """Raise an error for a mesh that exceeds the memory, e.g. because of a wrong unit."""

    def needed(size: float) -> float:
        return matrices(expected_nodes(section, size, mesher=mesher, through=through))

    def fits(free: float) -> str:
        coarser = smallest(lambda coarser_size: needed(coarser_size) <= free, size, section.line.length / 4)
        return f"{coarser * 1e3:g} mm or more would fit" if coarser else "fewer elements through every layer would fit"

    nodes = expected_nodes(section, size, mesher=mesher, through=through)
    try:
        check_memory(matrices(nodes), f"{size * 1e3:g} mm makes {nodes:,.0f} nodes", fits)
    except InputError as error:
        raise error.within(field="size") from None
