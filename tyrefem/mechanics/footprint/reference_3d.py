"""The same small motions in three dimensions: 27-node hexahedra in (r, z, t), a reference for the harmonics."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.complementarity import contact_forces
from tyrefem.mechanics.footprint.elements import COMPONENTS, SectionElements
from tyrefem.mechanics.solid.body import Prestressed
from tyrefem.mechanics.solid.elements import INTORDER
from tyrefem.mechanics.solid.six_components import PAIRS

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True)
class PressedHexahedra:
    """Load, N, of the whole tyre, contact forces and displacements of `Hexahedra.at_deflection`."""

    load: float
    forces: Array
    angles: Array
    displacement: Array


@dataclass(frozen=True, eq=False)
class Hexahedra:
    """Half the wheel, t from 0 to pi, of a pre-stressed half section: hexahedra between ``angles``.

    The equations are those of `Harmonics` with d/dt in place of n, the dilatation projected over each element's section
    at each of its three angles; u_t = 0 at both ends. Flat road, upright.

    Raises
    ------
    InputError : a state supported by a rim's flange: only fixed boundaries are implemented here.
    """

    state: Prestressed
    angles: Array

    def __post_init__(self) -> None:
        if self.state.support is not None and self.state.support.nnz:
            raise InputError("hexahedra know fixed boundaries only, not a rim's flange", field="support")

    @functools.cached_property
    def basis(self) -> Any:
        """scikit-fem basis of triquadratic hexahedra in (r, z, t)."""
        import skfem

        flat, t = self.state.mesh, np.asarray(self.angles)
        points = np.vstack([np.tile(flat.p, len(t)), np.repeat(t, flat.p.shape[1])])
        n, layers = flat.p.shape[1], []
        for k in range(len(t) - 1):
            low, high = flat.t + k * n, flat.t + (k + 1) * n
            # skfem's corners: (0,0,0), (0,0,1), (0,1,0), (1,0,0), (0,1,1), (1,0,1), (1,1,0), (1,1,1).
            layers.append(np.stack([low[0], high[0], low[3], low[1], high[3], high[1], low[2], high[2]]))
        mesh = skfem.MeshHex(points, np.hstack(layers), sort_t=False)
        return skfem.Basis(mesh, skfem.ElementHex2(), intorder=INTORDER)

    def _of_section(self, field: Array) -> Array:
        """A field (..., e, q) at the section's Gauss points, at those of the hexahedra (..., layers, e, q')."""
        return np.concatenate([field[..., self._point]] * (len(self.angles) - 1), axis=-2)

    @functools.cached_property
    def _section(self) -> SectionElements:
        return SectionElements(self.state.mesh)

    @functools.cached_property
    def _point(self) -> Indices:
        """(27,) the section's Gauss point at each point of a hexahedron."""
        # skfem counts the local coordinates of hexahedra from the last corner.
        points, flat = 1 - np.asarray(self.basis.X), np.asarray(self._section.basis.X)
        return np.argmin(((points[:2, :, None] - flat[:, None, :]) ** 2).sum(axis=0), axis=1)

    def _projected(self, trace: Array) -> Array:
        """Dilatations (e, q, 81) projected on (1, xi, eta) of the section at each angle."""
        functions = self._of_section(np.moveaxis(self._section.linear_functions, -1, 0))
        weights = self._of_section(self._section.weights)
        projected, angle = np.zeros_like(trace), np.asarray(self.basis.X)[2]
        for at in np.unique(angle.round(9)):
            chosen = np.flatnonzero(np.abs(angle - at) < 1e-6)
            values = functions[..., chosen].transpose(1, 2, 0)
            moments = (values * weights[:, chosen, None]).transpose(0, 2, 1) @ trace[:, chosen]
            projected[:, chosen] = values @ moments
        return projected

    @functools.cached_property
    def strains(self) -> Array:
        """(n_elements, n_points, 6, 81) strain per degree of freedom."""
        h, value = self._gradients
        strains = np.zeros((*value.shape[:2], 6, 27, COMPONENTS))
        for row, (i, j) in enumerate(PAIRS):
            strains[..., row, :, :] = h[..., i, j, :, :] if i == j else h[..., i, j, :, :] + h[..., j, i, :, :]
        return strains.reshape(*value.shape[:2], 6, -1)

    @functools.cached_property
    def _gradients(self) -> tuple[Array, Array]:
        """(e, q, 3, 3, 27, 3) displacement gradient k, i per node and component, and shape functions (e, q, 27)."""
        basis = self.basis
        r = np.asarray(basis.global_coordinates())[0]
        value = np.stack([np.broadcast_to(np.asarray(f[0]), r.shape) for f in basis.basis], axis=-1)
        grad = np.stack([np.asarray(f[0].grad) for f in basis.basis], axis=-1)
        gradients = np.zeros((*r.shape, 3, 3, 27, COMPONENTS))
        for k in range(COMPONENTS):
            gradients[..., k, 0, :, k], gradients[..., k, 1, :, k] = grad[0], grad[1]
            gradients[..., k, 2, :, k] = grad[2] / r[..., None]
        gradients[..., 0, 2, :, 2] -= value / r[..., None]
        gradients[..., 2, 2, :, 0] += value / r[..., None]
        return gradients, value

    @functools.cached_property
    def dofs(self) -> Indices:
        """(n_elements, 81)."""
        nodes = np.asarray(self.basis.element_dofs).T.astype(np.int64)
        return (COMPONENTS * nodes[:, :, None] + np.arange(COMPONENTS)).reshape(len(nodes), -1)

    @functools.cached_property
    def stiffness(self) -> Any:
        """K as a sparse matrix, N/m; half a wheel of the meshed half section."""
        import scipy.sparse as sp

        strain, (h, _) = self.strains, self._gradients
        weights = np.asarray(self.basis.dx) * np.asarray(self.basis.global_coordinates())[0]
        c = np.moveaxis(self._of_section(self.state.tangent), (0, 1), (-2, -1))
        bulk, dilatation = self._of_section(self.state.bulk) * weights, self._projected(strain[..., :3, :].sum(axis=2))
        n_elements, size = self.dofs.shape
        local = dilatation.transpose(0, 2, 1) @ (bulk[..., None] * dilatation)
        s = self._of_section(self.state.stress)
        tensor = np.moveaxis(np.array([[s[0], s[3], s[4]], [s[3], s[1], s[5]], [s[4], s[5], s[2]]]), (0, 1), (-2, -1))
        flat = h.reshape(*weights.shape, 3, 3, size)
        for q in range(weights.shape[1]):
            b = strain[:, q]
            local += b.transpose(0, 2, 1) @ ((weights[:, q, None, None] * c[:, q]) @ b)
            turned = np.einsum("eij,ekjb->ekib", tensor[:, q] * weights[:, q, None, None], flat[:, q])
            local += flat[:, q].reshape(n_elements, 9, size).transpose(0, 2, 1) @ turned.reshape(n_elements, 9, size)
        rows, columns = np.repeat(self.dofs, size, axis=1).ravel(), np.tile(self.dofs, (1, size)).ravel()
        n = COMPONENTS * int(self.basis.N)
        stiffness = sp.coo_matrix((local.ravel(), (rows, columns)), shape=(n, n)).tocsc()
        return stiffness + self._follower(n) if self.state.pressure else stiffness

    def _follower(self, n: int) -> Any:
        """Stiffness of the following pressure: second variation of the enclosed volume."""
        import scipy.sparse as sp
        import skfem

        mesh, wall = self.basis.mesh, self._on("contained_air")
        facets = skfem.FacetBasis(mesh, skfem.ElementHex2(), facets=wall, intorder=INTORDER)
        r = np.asarray(facets.global_coordinates())[0]
        n_r, n_z, _ = np.asarray(facets.normals)
        value = np.stack([np.broadcast_to(np.asarray(f[0]), r.shape) for f in facets.basis], axis=-1)
        grad = np.stack([np.asarray(f[0].grad) for f in facets.basis], axis=-1)
        along = grad[0] * n_z[..., None] - grad[1] * n_r[..., None]
        nodes = np.asarray(facets.element_dofs).T
        local = np.zeros((len(nodes), 27, COMPONENTS, 27, COMPONENTS))
        weights = np.asarray(facets.dx)
        # v . (u_s x x_t + x_s x u_t), as in `follower`, with a = u_r,t - u_t, b = u_z,t, g = u_t,t + u_r.
        by = {
            "a": {0: grad[2], 2: -value},
            "b": {1: grad[2]},
            "g": {2: grad[2], 0: value},
        }
        terms = [(0, {1: -r[..., None] * along}, 1.0), (1, {0: r[..., None] * along}, 1.0)]
        terms += [(0, by["g"], n_r), (1, by["g"], n_z), (2, by["a"], -n_r), (2, by["b"], -n_z)]
        for to, parts, factor in terms:
            for of, function in parts.items():
                local[:, :, to, :, of] += np.einsum("fqa,fqb,fq->fab", value, function, factor * weights)
        square = local.reshape(len(nodes), 81, 81)
        square = (square + square.transpose(0, 2, 1)) / 2 * self.state.pressure
        dofs = (COMPONENTS * nodes[:, :, None] + np.arange(COMPONENTS)).reshape(len(nodes), -1)
        rows, columns = np.repeat(dofs, 81, axis=1).ravel(), np.tile(dofs, (1, 81)).ravel()
        return sp.coo_matrix((square.ravel(), (rows, columns)), shape=(n, n)).tocsc()

    def _on(self, name: str) -> Indices:
        """Facets of the hexahedra over a boundary of the section."""
        mesh, flat = self.basis.mesh, self.state.mesh
        n = flat.p.shape[1]
        section = np.sort(mesh.facets % n, axis=0)
        pairs = {tuple(sorted(pair)) for pair in flat.facets[:, flat.boundaries[name]].T.tolist()}
        # A facet over an edge has each of its two section nodes twice.
        return np.array([
            k for k, (a, b, c, d) in enumerate(section.T.tolist()) if a == b and c == d and (a, c) in pairs
        ])  # fmt: skip

    def nodes_on(self, name: str) -> Indices:
        """Nodes over a boundary of the section."""
        return np.unique(self.basis.get_dofs(facets=self._on(name)).flatten()).astype(np.int64)

    @functools.cached_property
    def factor(self) -> tuple[Indices, Any]:
        """Free degrees of freedom and the factorised stiffness."""
        from scipy.sparse.linalg import splu

        places = np.asarray(self.basis.doflocs)
        fixed = [COMPONENTS * self.nodes_on(name)[:, None] + np.arange(COMPONENTS) for name in self.state.fixed]
        held = [dofs.ravel() for dofs in fixed]
        if self.state.symmetric in self.state.mesh.boundaries:
            held.append(COMPONENTS * self.nodes_on(self.state.symmetric) + 1)
        ends = np.flatnonzero((places[2] < 1e-9) | (places[2] > np.pi - 1e-9))
        held.append(COMPONENTS * ends + 2)
        free = np.setdiff1d(np.arange(COMPONENTS * places.shape[1]), np.concatenate(held))
        matrix = self.stiffness[free][:, free].tocsc()
        options = {"SymmetricMode": True}
        return free, splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)

    def at_deflection(self, deflection: float) -> PressedHexahedra:
        """Frictionless contact with a flat road at a deflection, m."""
        r, _, t = places = np.asarray(self.basis.doflocs)
        tread = self.nodes_on(self.state.tread)
        reach = float(r[tread].max())
        limit = 1.4 * math.acos(1 - deflection / reach)
        tread = tread[t[tread] < limit]
        free, factor = self.factor
        loads = np.zeros((COMPONENTS * places.shape[1], len(tread)))
        loads[COMPONENTS * tread, np.arange(len(tread))] = np.cos(t[tread])
        loads[COMPONENTS * tread + 2, np.arange(len(tread))] = -np.sin(t[tread])
        displacements = np.zeros_like(loads)
        displacements[free] = factor.solve(np.ascontiguousarray(loads[free]))
        gaps = reach - deflection - r[tread] * np.cos(t[tread])
        forces, _ = contact_forces(loads.T @ displacements, gaps)
        return PressedHexahedra(4 * float(forces.sum()), forces, t[tread], -(displacements @ forces))

    def strain(self, displacement: Array) -> tuple[Array, Array]:
        """(3, e, q) places and (6, e, q) strains at the Gauss points."""
        strain = self.strains @ displacement[self.dofs][:, None, :, None]
        return np.asarray(self.basis.global_coordinates()), np.moveaxis(strain[..., 0], -1, 0)


def angles_near_contact(near: float = 0.35, fine: int = 8, coarse: int = 7) -> Array:
    """Angles from 0 to pi: ``fine`` equal steps up to ``near``, then ``coarse`` growing ones.

    >>> angles_near_contact()[[0, 8, 15]].round(3).tolist()
    [0.0, 0.35, 3.142]
    """
    tail = near + (np.pi - near) * np.linspace(0, 1, coarse + 1)[1:] ** 1.8
    return np.concatenate([np.linspace(0, near, fine + 1), tail])
