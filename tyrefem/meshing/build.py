"""One way in: a section and a size give a mesh, whichever mesher makes it."""

from __future__ import annotations

import math

from tyrefem.errors import InputError, nearest
from tyrefem.meshing.tyre_mesh import TyreMesh
from tyrefem.section.section import Section

MESHERS = ("mapped", "gmsh")
CELLS = {"mapped": ("quad", "tri"), "gmsh": ("tri", "quad")}
#: Most elements a mesh may have: a size given in the wrong unit is found before it fills the memory.
MOST_ELEMENTS = 2_000_000


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
    size : largest edge along the meridian [m]; every other size of the mesh is in proportion.
    cell : ``"quad"`` or ``"tri"``; by default quadrilaterals when mapped, triangles from gmsh.
    through : fewest elements through every layer.

    Raises
    ------
    InputError : unknown mesher or cell, a size out of range or too coarse for the section.
    MissingLibraryError : gmsh is asked for and cannot be loaded.

    >>> from tyrefem.section import load
    >>> tyre = build(load("nasa-22x5.5-8pr"), size=4e-3)
    >>> sorted(tyre.mesh.subdomains), tyre.cell
    (['bead', 'carcass', 'sidewall', 'tread'], 'quad')
    >>> bool(abs(tyre.area("tread") / tyre.section.area("tread") - 1) < 1e-2)
    True
    """
    if mesher not in MESHERS:
        raise InputError(f"no mesher '{mesher}'{nearest(mesher, MESHERS)}", field="mesher")
    cell = cell or CELLS[mesher][0]
    if cell not in CELLS[mesher]:
        raise InputError(f"no cell '{cell}'{nearest(cell, CELLS[mesher])}", field="cell")
    if not (math.isfinite(size) and size > 0):
        raise InputError(f"must be a positive length, not {size!r}", field="size")
    if through < 1 or through != int(through):
        raise InputError(f"must be a whole number, 1 or more, not {through!r}", field="through")
    if 12 * section.area() / size**2 > MOST_ELEMENTS:
        raise InputError(f"{size:g} m would make more than {MOST_ELEMENTS:,} elements", field="size")
    if size > section.line.length / 4:
        raise InputError(
            f"{size:g} m is too coarse: at most a quarter of the meridian, {section.line.length / 4:.3g} m",
            field="size",
        )
    if mesher == "mapped":
        from tyrefem.meshing.mapped import mapped_mesh

        mesh = mapped_mesh(section, size, cell, int(through))
    else:
        from tyrefem.meshing.gmsh import gmsh_mesh

        mesh = gmsh_mesh(section, size, cell, int(through))
    tyre = TyreMesh(mesh, section, mesher, size, cell)
    if not tyre.quality["scaled_jacobian"] > 0:
        raise InputError(f"elements of {size:g} m fold over in this section; choose a smaller size", field="size")
    return tyre
