"""The wall of a tyre from its inner to its outer surface: where a gradient through it is taken."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.geometry import Section

Array = NDArray[np.float64]
#: Stations along the meridian; both ends are left out.
STATIONS = 41


@dataclass(frozen=True, eq=False)
class Wall:
    """Stations s (k,) m along the meridian, thickness (k,) m, and both surfaces there (k, 2) in (r, z), m.

    Across a groove the wall ends at its bottom.
    """

    s: Array
    thickness: Array
    inner: Array
    outer: Array


def inside(section: Section, size: float, s: Array, depth: Array) -> Array:
    """(r, z) of places moved by the sag of straight-sided elements of a size (m) at most: in the mesh."""
    return np.asarray(section.place(*section.clamp(s, depth, size**2 / 0.1)))


@functools.lru_cache(maxsize=32)
def wall_of(section: Section, size: float) -> Wall:
    """The wall of a section on a mesh of a size (m); remembered for the 32 latest."""
    lowest = 0.0 if section.half else -section.line.length
    s = np.linspace(lowest, section.line.length, STATIONS)[1:-1]
    thickness = section.rubber_thickness(s)
    surfaces = [section.place(s, depth) for depth in (np.zeros_like(s), thickness)]
    inner, outer = (inside(section, size, *section.locate(surface)) for surface in surfaces)
    return Wall(s, thickness, inner, outer)
