"""Points between a section's curved outline and the straight edges of its mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.cache import Cache, Content
from tyrefem.errors import InputError
from tyrefem.geometry.meshing.mesh import TyreMesh

Array = NDArray[np.float64]
#: Tolerances, m: of coordinates that a person rounds, and of a sagitta due to rounding.
ROUNDED = 1e-6
#: Number of points of an edge at which the outline is evaluated.
ALONG = np.linspace(0.0, 1.0, 65)
#: Number of points evaluated together.
TOGETHER = 2000
#: Nodes of the edges at the boundary, (n, 2), by the nodes of the elements: all shapes of a section have the same ones.
_OUTER: Cache[NDArray[np.int64]] = Cache(size=8)


def snapped(tyre: TyreMesh, points: ArrayLike) -> Array:
    """Points (n, 2) outside a mesh, moved to the nearest point of its edge.

    A point belongs to the mesh if it is within the section's outline and its distance from the nearest edge is at most
    that edge's sagitta, about h^2/(8 R) for an edge of length h on an outline of radius R.

    Raises
    ------
    InputError : a point is further outside; the message has its distance and the sagitta of the nearest edge.

    >>> from tyrefem.geometry import load
    >>> from tyrefem.geometry.meshing import build
    >>> tyre = build(load("nasa-22x5.5-8pr"), size=8e-3)
    >>> on_outline = tyre.section.place([0.004], tyre.section.rubber_thickness([0.004]))
    >>> bool(np.linalg.norm(snapped(tyre, on_outline) - on_outline) < 1e-4)
    True
    """
    places = np.asarray(points, dtype=float).reshape(-1, 2)
    return np.concatenate(
        [_moved_to_edge(tyre, places[first : first + TOGETHER]) for first in range(0, len(places), TOGETHER)]
        or [places]
    )


def nearest_places(tyre: TyreMesh, points: ArrayLike) -> Array:
    """Points (n, 2) outside a mesh, moved to the nearest point of its edge, however far it is.

    For points of another mesh of the section: on a hollow side its straight edges lie outside the section.
    """
    places = np.asarray(points, dtype=float).reshape(-1, 2)
    parts = (places[first : first + TOGETHER] for first in range(0, len(places), TOGETHER))
    return np.concatenate([_nearest(_edges(tyre), part)[0] for part in parts] or [places])


def kept_inside(tyre: TyreMesh, points: ArrayLike) -> Array:
    """Points (n, 2), those outside the mesh moved to the nearest point of its edge: of a section's surface, a sagitta.

    >>> from tyrefem.geometry import load
    >>> from tyrefem.geometry.meshing import build
    >>> tyre = build(load("nasa-22x5.5-8pr"), size=8e-3)
    >>> points = tyre.section.place([0.03, 0.03], tyre.section.rubber_thickness([0.03]) - [0.0, 1e-4])
    >>> moved = np.linalg.norm(kept_inside(tyre, points) - points, axis=1)
    >>> bool(1e-5 < moved[0] < 1e-4), float(moved[1])
    (True, 0.0)
    """
    places = np.array(points, dtype=float).reshape(-1, 2)
    ends = _edges(tyre)
    for first in range(0, len(places), TOGETHER):
        part = places[first : first + TOGETHER]
        outside = ~_enclosed(ends, part)
        part[outside] = _nearest(ends, part[outside])[0]
    return places


def _enclosed(ends: Array, points: Array) -> NDArray[np.bool_]:
    """Whether closed edges with these ends hold the points (n, 2): a ray along z meets them an odd number of times."""
    (r_1, z_1), (r_2, z_2) = ends[:, 0].T, ends[:, 1].T
    r, z = points[:, :1], points[:, 1:]
    beside = (r_1 > r) != (r_2 > r)
    run = np.where(r_2 == r_1, 1.0, r_2 - r_1)
    return np.asarray((beside & (z < z_1 + (r - r_1) / run * (z_2 - z_1))).sum(axis=1) % 2 == 1)


def _edges(tyre: TyreMesh) -> Array:
    """Ends of the edges at the mesh's boundary, (n, 2, 2)."""
    mesh = tyre.mesh
    outer = _OUTER.get(Content.of(mesh.t), lambda: np.asarray(mesh.facets[:, mesh.boundary_facets()].T))
    return np.asarray(mesh.p.T[outer])


def _nearest(ends: Array, points: Array) -> tuple[Array, Array, NDArray[np.intp]]:
    """The nearest place on edges with these ends of every point, its distance, and the number of its edge."""
    (r, z), (along_r, along_z) = ends[:, 0].T, (ends[:, 1] - ends[:, 0]).T
    from_r, from_z = points[:, :1] - r, points[:, 1:] - z
    part = np.clip((from_r * along_r + from_z * along_z) / (along_r**2 + along_z**2), 0.0, 1.0)
    distances = np.sqrt((from_r - part * along_r) ** 2 + (from_z - part * along_z) ** 2)
    edge, each = distances.argmin(axis=1), np.arange(len(points))
    nearest = ends[edge, 0] + part[each, edge, None] * (ends[edge, 1] - ends[edge, 0])
    return np.asarray(nearest), np.asarray(distances[each, edge]), edge


def _moved_to_edge(tyre: TyreMesh, points: Array) -> Array:
    ends = _edges(tyre)
    nearest, distances, edge = _nearest(ends, points)
    allowed = np.where(tyre.section.contains(points, ROUNDED), sagitta(tyre, ends[edge]), 0.0)
    wrong = np.flatnonzero(distances > allowed + ROUNDED)
    if wrong.size:
        worst = wrong[0]
        (r, z), away, left = points[worst], distances[worst], allowed[worst]
        outline = f", and the straight edge there leaves out {left:.2g} m of the section" if left else ""
        raise InputError(f"point ({r:.6g}, {z:.6g}) m lies {away:.3g} m outside the mesh{outline}", field="points")
    return nearest


def sagitta(tyre: TyreMesh, ends: Array) -> Array:
    """(n,) largest distance of the section's outline from straight edges with these ends (n, 2, 2), m."""
    section = tyre.section
    s, depth = section.locate(ends)
    share = depth / section.rubber_thickness(s)
    stations = s[:, :1] + (s[:, 1:] - s[:, :1]) * ALONG
    depths = (share[:, :1] + (share[:, 1:] - share[:, :1]) * ALONG) * section.rubber_thickness(stations)
    outline = section.place(stations, depths)
    first, chord = outline[:, :1], outline[:, -1:] - outline[:, :1]
    away = outline - first
    across = away[..., 0] * chord[..., 1] - away[..., 1] * chord[..., 0]
    lengths = np.linalg.norm(chord[:, 0], axis=1)
    return np.asarray(np.abs(across).max(axis=1) / np.where(lengths > 0, lengths, 1.0))
