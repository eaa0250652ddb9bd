"""The wall of a tyre between its inner and outer surface, for gradients through the thickness."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import Cache, fingerprint
from tyrefem.geometry.meshing import TyreMesh
from tyrefem.geometry.meshing.sagitta import kept_inside

Array = NDArray[np.float64]
#: Number of stations from the crown to the bead; the end of the bead is left out.
STATIONS = 41


@dataclass(frozen=True, eq=False)
class Wall:
    """Stations s (k,) m along the meridian, thickness (k,) m, and both surfaces there (k, 2) in (r, z), m.

    In a groove the wall ends at its bottom.
    """

    s: Array
    thickness: Array
    inner: Array
    outer: Array


_WALLS: Cache[Wall] = Cache(size=32)


def wall_of(tyre: TyreMesh) -> Wall:
    """The wall of a meshed section, its surfaces at the mesh's straight edges; equal meshes share it.

    A full section has the stations of a half on both its sides.
    """
    return _WALLS.get((tyre.section, fingerprint(tyre.mesh.p, tyre.mesh.t)), lambda: _wall(tyre))


def _wall(tyre: TyreMesh) -> Wall:
    section = tyre.section
    side = np.linspace(0.0, section.line.length, STATIONS)[:-1]
    s = side if section.half else np.concatenate([-side[:0:-1], side])
    thickness = section.rubber_thickness(s)
    surfaces = section.place(np.concatenate([s, s]), np.concatenate([np.zeros_like(s), thickness]))
    inner, outer = np.split(kept_inside(tyre, surfaces), 2)
    return Wall(s, thickness, inner, outer)
