"""Nine-node rings in a Fourier harmonic: strains and projected dilatation."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.solid.elements import Rings

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
#: Nodes of an element, displacement components (r, z, t) of a node.
NODES, COMPONENTS = 9, 3


@dataclass(frozen=True, eq=False)
class SectionElements(Rings):
    """Nine-node rings, and their strains in the harmonic

    u = (u_r cos n t, u_z cos n t, u_t sin n t):  e_n = e_0 + n e_1,

    e_rr = u_r,r; e_zz = u_z,z; e_tt = (u_r + n u_t)/r; g_rz = u_r,z + u_z,r (all cos n t);
    g_rt = u_t,r - u_t/r - n u_r/r; g_zt = u_t,z - n u_z/r (both sin n t).

    Degree of freedom 3 i + c is component c of (r, z, t) at node i.

    >>> import skfem
    >>> elements = SectionElements(skfem.MeshQuad.init_tensor([1.0, 1.1], [0.0, 0.1]))
    >>> elements.n_dofs, elements.radii.shape
    (27, (1, 9))
    """

    @property
    def n_dofs(self) -> int:
        """Degrees of freedom of a harmonic."""
        return COMPONENTS * self.n_nodes

    @functools.cached_property
    def dofs(self) -> Indices:
        """(n_elements, 27) degrees of freedom of an element, in the order 3 a + c."""
        nodes = self.element_nodes
        return (COMPONENTS * nodes[:, :, None] + np.arange(COMPONENTS)).reshape(len(nodes), -1)

    @functools.cached_property
    def strains(self) -> tuple[Array, Array]:
        """(e_0, e_1), each (n_elements, n_points, 6, 27): order rr, zz, tt, rz, rt, zt."""
        by_r, by_z = self.gradients
        over_r = self.values / self.radii[..., None]
        constant, linear = np.zeros((2, *self.radii.shape, 6, NODES, COMPONENTS))
        constant[..., 0, :, 0] = by_r
        constant[..., 1, :, 1] = by_z
        constant[..., 2, :, 0] = over_r
        constant[..., 3, :, 0], constant[..., 3, :, 1] = by_z, by_r
        constant[..., 4, :, 2] = by_r - over_r
        constant[..., 5, :, 2] = by_z
        linear[..., 2, :, 2] = over_r
        linear[..., 4, :, 0] = -over_r
        linear[..., 5, :, 1] = -over_r
        shape = (*self.radii.shape, 6, NODES * COMPONENTS)
        return constant.reshape(shape), linear.reshape(shape)

    @functools.cached_property
    def dilatations(self) -> tuple[Array, Array]:
        """(d_0, d_1), each (n_elements, n_points, 27): div u projected on (1, xi, eta), d_n = d_0 + n d_1."""
        functions = self.linear_functions

        def projected(strain: Array) -> Array:
            trace = strain[..., :3, :].sum(axis=-2)
            moments = (functions * self.weights[..., None]).transpose(0, 2, 1) @ trace
            return np.asarray(functions @ moments)

        constant, linear = self.strains
        return projected(constant), projected(linear)

    def strain(self, n: float, displacement: Array) -> Array:
        """(6, n_elements, n_points) strain amplitudes of harmonic ``n`` for amplitudes (n_dofs,) in m."""
        constant, linear = self.strains
        local = np.asarray(displacement)[self.dofs]
        shape = (*self.radii.shape, 6)
        flat = (len(local), -1, local.shape[1])
        found = constant.reshape(flat) @ local[:, :, None] + n * (linear.reshape(flat) @ local[:, :, None])
        return np.moveaxis(found.reshape(shape), -1, 0)

    def projected_dilatation(self, n: float, displacement: Array) -> Array:
        """(n_elements, n_points) projected dilatation of harmonic ``n``."""
        constant, linear = self.dilatations
        local = np.asarray(displacement)[self.dofs][:, :, None]
        return np.asarray((constant @ local + n * (linear @ local))[..., 0])
