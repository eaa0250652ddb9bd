"""The wall of a tyre between its inner and outer surface, for gradients through the thickness."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.geometry import Section

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


def inside_mesh(section: Section, size: float, s: Array, depth: Array) -> Array:
    """(r, z) of positions (s, depth), moved into a mesh of straight-sided elements of a size (m): at most a sagitta."""
    return np.asarray(section.place(*section.clamp(s, depth, size**2 / 0.1)))


@functools.lru_cache(maxsize=32)
def wall_of(section: Section, size: float) -> Wall:
    """The wall of a section on a mesh of a size (m): a full section has the stations of a half on both its sides.

    The 32 latest are kept.
    """
    side = np.linspace(0.0, section.line.length, STATIONS)[:-1]
    s = side if section.half else np.concatenate([-side[:0:-1], side])
    thickness = section.rubber_thickness(s)
    inner, outer = (inside_mesh(section, size, s, depth) for depth in (np.zeros_like(s), thickness))
    return Wall(s, thickness, inner, outer)
