"""Nine-node rings in a Fourier harmonic: strains and projected dilatation.

Values and gradients of a motion at angles of the wheel, and forces of harmonics from stresses at these angles.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.solid.elements import Rings

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
        strain = constant.reshape(flat) @ local[:, :, None] + n * (linear.reshape(flat) @ local[:, :, None])
        return np.moveaxis(strain.reshape(shape), -1, 0)

    def projected_dilatation(self, n: float, displacement: Array) -> Array:
        """(n_elements, n_points) projected dilatation of harmonic ``n``."""
        constant, linear = self.dilatations
        local = np.asarray(displacement)[self.dofs][:, :, None]
        return np.asarray((constant @ local + n * (linear @ local))[..., 0])


#: Steps of the angle from 0 to pi per harmonic.
PER_HARMONIC = 1.5


@dataclass(frozen=True, eq=False)
class WheelAngles:
    """Angles from 0 to pi for harmonics (u_r cos n t, u_z cos n t, u_t sin n t) up to ``highest``.

    The number of angles is 3/2 ``highest`` + 1: products of two harmonics are not aliased to lower ones.
    ``precision``: of values, gradients and forces. ``odd``: (u_r sin n t, u_z sin n t, -u_t cos n t), odd about the
    lowest point.
    """

    elements: SectionElements
    highest: int
    precision: type = float
    odd: bool = False

    @functools.cached_property
    def _single(self) -> WheelAngles:
        return replace(self, precision=np.float32)

    def within(self, precision: type | np.dtype[Any]) -> WheelAngles:
        """These angles in double or single precision."""
        return self if np.dtype(precision) == np.dtype(self.precision) else self._single

    @functools.cached_property
    def angles(self) -> Array:
        """(m,) rad."""
        return np.linspace(0, np.pi, int(np.ceil(PER_HARMONIC * max(self.highest, 1))) + 1)

    @functools.cached_property
    def waves(self) -> tuple[Array, Array]:
        """(3, m, highest + 1) of r, z, t, and their derivatives by the angle."""
        n = np.arange(self.highest + 1)
        phase = np.multiply.outer(self.angles, n)
        cos, sin = np.cos(phase), np.sin(phase)
        if self.odd:
            value, slope = np.stack([sin, sin, -cos]), np.stack([n * cos, n * cos, n * sin])
        else:
            value, slope = np.stack([cos, cos, sin]), np.stack([-n * sin, -n * sin, n * cos])
        return value.astype(self.precision), slope.astype(self.precision)

    @functools.cached_property
    def shares(self) -> Array:
        """(m, highest + 1) weights for a wave's amplitude as a sum of values at the angles."""
        weights = np.full(len(self.angles), 1 / (len(self.angles) - 1))
        weights[[0, -1]] /= 2
        shares = np.tile(2 * weights[:, None], (1, self.highest + 1))
        shares[:, 0] /= 2
        return shares.astype(self.precision)

    @functools.cached_property
    def to_amplitudes(self) -> tuple[Array, Array]:
        """(3, m, highest + 1) weights for the amplitudes of values at the angles, and of their derivatives."""
        value, slope = self.waves
        return value * self.shares, slope * self.shares

    def at_nodes(self, amplitudes: Array) -> tuple[Array, Array]:
        """(3, n_nodes, m) displacement and its derivative by the angle, of amplitudes (highest + 1, n_dofs)."""
        u: Array = np.asarray(amplitudes, self.precision).reshape(self.highest + 1, -1, COMPONENTS).transpose(2, 1, 0)
        value, slope = (np.ascontiguousarray(u) @ waves.transpose(0, 2, 1) for waves in self.waves)
        return value, slope

    def values(self, amplitudes: Array) -> Array:
        """(3, n_nodes, m) displacement of amplitudes (highest + 1, n_dofs)."""
        u: Array = np.asarray(amplitudes, self.precision).reshape(self.highest + 1, -1, COMPONENTS).transpose(2, 1, 0)
        return np.asarray(np.ascontiguousarray(u) @ self.waves[0].transpose(0, 2, 1))

    def from_nodes(self, value: Array, slope: Array | None = None) -> Array:
        """(highest + 1, n_dofs) forces on the amplitudes from forces on `at_nodes`; its adjoint."""
        forces = value @ self.to_amplitudes[0]
        if slope is not None:
            forces += slope @ self.to_amplitudes[1]
        return np.ascontiguousarray(forces.transpose(2, 1, 0)).reshape(self.highest + 1, -1)

    @functools.cached_property
    def _derivatives(self) -> tuple[Array, Array]:
        """Shape functions differentiated by r and z (e, 2 q, 9); divided by r (e, q, 9)."""
        over_r = self.elements.values / self.elements.radii[..., None]
        by = np.concatenate(list(self.elements.gradients), axis=1)
        return by.astype(self.precision), over_r.astype(self.precision)

    @functools.cached_property
    def _sums(self) -> Any:
        """Sparse (n_nodes, 9 e): sum over the elements at a node."""
        import scipy.sparse as sp

        nodes = self.elements.element_nodes.ravel()
        place = (nodes, np.arange(len(nodes)))
        ones: Array = np.ones(len(nodes), self.precision)
        return sp.csr_matrix((ones, place), shape=(self.elements.n_nodes, len(nodes)))

    def mean_at_nodes(self, values: Array) -> Array:
        """(n_nodes, k) mean over the elements at each node of values (e, k)."""
        import scipy.sparse as sp

        nodes = self.elements.element_nodes
        place = (nodes.ravel(), np.repeat(np.arange(len(nodes)), nodes.shape[1]))
        belongs = sp.csr_matrix((np.ones(nodes.size, self.precision), place), shape=(self.elements.n_nodes, len(nodes)))
        return np.asarray((belongs @ values) / belongs.sum(axis=1))

    def gradient(self, amplitudes: Array) -> Array:
        """(e, 9, q, m) displacement gradient H, component 3 k + i of (r, z, t)."""
        value, slope = self.at_nodes(amplitudes)
        nodes, (by, over_r) = self.elements.element_nodes, self._derivatives
        slope[0] -= value[2]
        slope[2] += value[0]
        e, m, q = len(nodes), len(self.angles), over_r.shape[1]
        gradient = np.empty((e, COMPONENTS, COMPONENTS * q, m), self.precision)
        for k in range(COMPONENTS):
            np.matmul(by, value[k][nodes], out=gradient[:, k, : 2 * q])
            np.matmul(over_r, slope[k][nodes], out=gradient[:, k, 2 * q :])
        return gradient.reshape(e, 9, q, m)

    def forces(self, stress: Array) -> Array:
        """(highest + 1, n_dofs) forces, N per radian, of a stress (e, 9, q, m) times r dA; adjoint to `gradient`."""
        e, _, q, m = stress.shape
        p, (by, over_r) = stress.reshape(e, COMPONENTS, COMPONENTS * q, m), self._derivatives
        value: Array = np.empty((COMPONENTS, self.elements.n_nodes, m), self.precision)
        slope = np.empty_like(value)
        by, over_r = by.transpose(0, 2, 1), over_r.transpose(0, 2, 1)
        for k in range(COMPONENTS):
            value[k] = self._sums @ (by @ p[:, k, : 2 * q]).reshape(9 * e, m)
            slope[k] = self._sums @ (over_r @ p[:, k, 2 * q :]).reshape(9 * e, m)
        value[0] += slope[2]
        value[2] -= slope[0]
        return self.from_nodes(value, slope)
