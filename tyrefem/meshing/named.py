"""Put names on a mesh: regions by element, boundaries by the two nodes of a facet; and mirror a half."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


def named_mesh(points: Array, elements: Indices, regions: Mapping[str, Indices], edges: Mapping[str, Indices]) -> Any:
    """scikit-fem mesh from points (n, 2), elements (n, 3 or 4), element indices per region, node pairs per boundary.

    Elements that run clockwise are turned round; nodes that no element uses are dropped.

    Raises
    ------
    ValueError : a node pair is not a facet of the mesh.
    """
    import skfem

    used, renumbered = np.unique(elements, return_inverse=True)
    new_number = np.full(len(points), -1, dtype=np.int64)
    new_number[used] = np.arange(len(used))
    points, elements = points[used], renumbered.reshape(elements.shape)
    corners = points[elements]
    after = np.roll(corners, -1, axis=1)
    clockwise = (corners[..., 0] * after[..., 1] - corners[..., 1] * after[..., 0]).sum(axis=1) < 0
    elements = np.where(clockwise[:, None], elements[:, ::-1], elements)
    kind = skfem.MeshTri if elements.shape[1] == 3 else skfem.MeshQuad
    mesh = kind(np.ascontiguousarray(points.T), np.ascontiguousarray(elements.T), sort_t=False)
    return mesh.with_subdomains({name: np.sort(np.unique(found)) for name, found in regions.items()}).with_boundaries(
        {name: find_facets(mesh, new_number[pairs]) for name, pairs in edges.items()}
    )


def bare_edges(elements: Indices, named: Iterable[Indices]) -> Indices:
    """Node pairs (n, 2) that belong to one element (n, 3 or 4) only and to none of the named boundaries."""
    pairs = np.sort(np.stack([elements, np.roll(elements, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    single, counts = np.unique(pairs, axis=0, return_counts=True)
    known = {(int(a), int(b)) for group in named for a, b in np.sort(group, axis=1)}
    return np.array([pair for pair in single[counts == 1] if (int(pair[0]), int(pair[1])) not in known]).reshape(-1, 2)


def find_facets(mesh: Any, pairs: Indices) -> Indices:
    """Facet indices of node pairs (n, 2).

    Raises
    ------
    ValueError : a pair is not a facet of the mesh.
    """
    n = int(mesh.p.shape[1])
    key = np.sort(mesh.facets, axis=0)
    key = key[0].astype(np.int64) * n + key[1]
    wanted = np.sort(np.asarray(pairs, dtype=np.int64), axis=1)
    wanted = wanted[:, 0] * n + wanted[:, 1]
    order = np.argsort(key)
    place = np.searchsorted(key[order], wanted)
    if (place >= len(key)).any() or (key[order][place] != wanted).any():
        raise ValueError("a named edge is not a facet of the mesh")
    return np.unique(order[place])


def facet_nodes(mesh: Any, name: str) -> Indices:
    """Node pairs (n, 2) of a named boundary."""
    return np.asarray(mesh.facets[:, mesh.boundaries[name]].T, dtype=np.int64)


def mirrored(mesh: Any, symmetry: str = "symmetry") -> Any:
    """The whole from the half z >= 0: its mirror image joined at the nodes with z = 0, same names."""
    points, elements = mesh.p.T, np.asarray(mesh.t.T, dtype=np.int64)
    n = len(points)
    on_plane = np.zeros(n, dtype=bool)
    on_plane[facet_nodes(mesh, symmetry).ravel()] = True
    image = np.where(on_plane, np.arange(n), n - 1 + np.cumsum(~on_plane))
    all_points = np.concatenate([points, points[~on_plane] * [1.0, -1.0]])
    regions = {name: np.concatenate([found, found + len(elements)]) for name, found in mesh.subdomains.items()}
    edges = {}
    for name in mesh.boundaries:
        if name != symmetry:
            pairs = facet_nodes(mesh, name)
            edges[name] = np.concatenate([pairs, image[pairs]])
    return named_mesh(all_points, np.concatenate([elements, image[elements]]), regions, edges)
