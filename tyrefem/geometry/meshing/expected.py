"""Expected number of nodes of a mesh, without meshing."""

from __future__ import annotations

import functools

import numpy as np

from tyrefem.geometry.meshing.mapped import ASPECT, grid_lines
from tyrefem.geometry.section import Section

#: Nodes of gmsh's triangles: over area / size^2 away from thin layers; in thin layers over n^2/t times the length.
#: Estimates are 0.7 to 1.2 times gmsh's numbers (four shipped sections, 8 to 1 mm).
PER_AREA, THIN = 2.0, 2.5
#: Nodes of quadratic elements over their corners; slightly more than the actual ratio.
QUADRATIC = 4
#: Above this number of nodes, by area alone, lines are not counted.
COUNTED = 4e6


@functools.lru_cache(maxsize=64)
def expected_nodes(section: Section, size: float, *, mesher: str = "mapped", through: int = 1) -> float:
    """Number of element corners: exact lines for the structured mesh, within a factor of two for gmsh.

    gmsh's elements are as long as wide: a layer of thickness t with n elements through it needs n^2/t elements per
    length of the meridian.

    >>> from tyrefem.geometry.meshing import build
    >>> from tyrefem.geometry import load
    >>> tyre = load("nasa-22x5.5-8pr")
    >>> int(expected_nodes(tyre, 3e-3, through=3)), build(tyre, size=3e-3).n_nodes
    (1206, 1206)
    """
    by_area = PER_AREA * section.area() / size / size
    s = np.linspace(0.0, section.line.length, 200)
    thin = 0.0
    for layer in section.layers:
        thickness = np.asarray(layer.thickness(s))
        narrow = (thickness > 0) & (thickness < through * size)
        thin += float(np.where(narrow, 1 / np.where(narrow, thickness, 1.0), 0.0).mean())
    thin *= section.line.length * float(through) ** 2 * (1 if section.half else 2)
    if mesher == "mapped" and by_area + thin / ASPECT < COUNTED:
        columns, rows = grid_lines(section.as_half(), size, through)
        return float(columns * rows) if section.half else float((2 * columns - 1) * rows)
    return by_area + (thin / ASPECT if mesher == "mapped" else THIN * thin)
