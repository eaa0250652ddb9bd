"""One way in: a section and a size give a mesh, whichever mesher makes it."""

from __future__ import annotations

import math

from tyrefem.errors import InputError, nearest
from tyrefem.estimate import check_memory, matrices, smallest
from tyrefem.meshing.expected import expected_nodes
from tyrefem.meshing.tyre_mesh import TyreMesh
from tyrefem.section.section import Section

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
    size : largest edge along the meridian [m]; every other size of the mesh is in proportion.
    cell : ``"quad"`` or ``"tri"``; by default quadrilaterals when mapped, triangles from gmsh.
    through : fewest elements through every layer.

    Raises
    ------
    InputError : unknown mesher or cell, a size out of range or too coarse for the section; more nodes than linear
        elements on them have memory for.
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
    if size > section.line.length / 4:
        raise InputError(
            f"{size:g} m is too coarse: at most a quarter of the meridian, {section.line.length / 4:.3g} m",
            field="size",
        )
    _check_memory(section, mesher, size, int(through))
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


def _check_memory(section: Section, mesher: str, size: float, through: int) -> None:
    """A size in the wrong unit is found before it fills the memory."""

    def needed(size: float) -> float:
        return matrices(expected_nodes(section, size, mesher=mesher, through=through))

    def fits(free: float) -> str:
        coarser = smallest(lambda one: needed(one) <= free, size, section.line.length / 4)
        return f"{coarser * 1e3:g} mm or more would fit" if coarser else "fewer elements through every layer would fit"

    nodes = expected_nodes(section, size, mesher=mesher, through=through)
    try:
        check_memory(matrices(nodes), f"{size * 1e3:g} mm makes {nodes:,.0f} nodes", fits)
    except InputError as error:
        raise error.within(field="size") from None
