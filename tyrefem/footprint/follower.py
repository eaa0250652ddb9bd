"""Pressure that follows the wall: its load and its stiffness, harmonic by harmonic."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.footprint.elements import COMPONENTS, SectionElements

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


def along_wall(facets: Any) -> tuple[Indices, Array, Array, Array, Array, Array]:
    """Dofs (f, 27), values and tangential derivatives (f, q, 9), normals (2, f, q), radii and weights (f, q)."""
    nodes = np.asarray(facets.element_dofs, dtype=np.int64).T
    dofs = (COMPONENTS * nodes[:, :, None] + np.arange(COMPONENTS)).reshape(len(nodes), -1)
    radii, weights = np.asarray(facets.global_coordinates())[0], np.asarray(facets.dx)
    values = np.stack([np.broadcast_to(np.asarray(f[0]), radii.shape) for f in facets.basis], axis=-1)
    normals = np.asarray(facets.normals)
    by_r, by_z = np.stack([np.asarray(f[0].grad) for f in facets.basis], axis=-1)
    along = by_r * normals[1][..., None] - by_z * normals[0][..., None]
    return dofs, values, along, normals, radii, weights


def pressure_load(elements: SectionElements, boundary: str) -> Array:
    """(n_dofs,) load per radian of unit pressure on a boundary, n = 0: - int n . v r ds, m2."""
    dofs, values, _, normals, radii, weights = along_wall(elements.facet_basis(boundary))
    local = np.zeros((*values.shape[::2], COMPONENTS))
    for component in (0, 1):
        local[..., component] = -np.einsum("fqa,fq->fa", values, normals[component] * radii * weights)
    load = np.zeros(elements.n_dofs)
    np.add.at(load, dofs, local.reshape(dofs.shape))
    return load


def follower_stiffness(elements: SectionElements, boundary: str) -> tuple[Indices, Array, Array]:
    """Stiffness of unit pressure on a boundary: dofs (f, 27), P_0 and P_1 (f, 27, 27), m; P_n = P_0 + n P_1.

    With x(s, t) on the wall, the force p (x_s x x_t) changes by p (u_s x x_t + x_s x u_t):

    v P_n u = int v_r (n_r (n u_t + u_r) - r u_z') + v_z (n_z (n u_t + u_r) + r u_r')
              + v_t (n_r (n u_r + u_t) + n_z n u_z) ds,

    ' along the wall, (n_r, n_z) outwards of the body; made symmetric, which alters nothing where the wall closes on
    itself, ends on a held edge or on the mid plane.
    """
    dofs, values, along, (n_r, n_z), radii, weights = along_wall(elements.facet_basis(boundary))
    n_faces, nodes = values.shape[::2]
    constant, linear = np.zeros((2, n_faces, nodes, COMPONENTS, nodes, COMPONENTS))
    by_r = np.einsum("fqa,fqb,fq->fab", values, values, n_r * weights)
    by_z = np.einsum("fqa,fqb,fq->fab", values, values, n_z * weights)
    slope = np.einsum("fqa,fqb,fq->fab", values, along, radii * weights)
    constant[:, :, 0, :, 0] = by_r
    constant[:, :, 0, :, 1] = -slope
    constant[:, :, 1, :, 0] = by_z + slope
    constant[:, :, 2, :, 2] = by_r
    linear[:, :, 0, :, 2] = by_r
    linear[:, :, 1, :, 2] = by_z
    linear[:, :, 2, :, 0] = by_r
    linear[:, :, 2, :, 1] = by_z

    def symmetric(matrix: Array) -> Array:
        square = matrix.reshape(n_faces, nodes * COMPONENTS, nodes * COMPONENTS)
        return np.asarray((square + square.transpose(0, 2, 1)) / 2)

    return dofs, symmetric(constant), symmetric(linear)
