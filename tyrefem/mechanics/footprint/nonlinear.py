"""Forces of a large motion about the inflated state, by harmonic, and their derivative."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.footprint.elements import COMPONENTS, WheelAngles
from tyrefem.mechanics.footprint.harmonics import Harmonics, along_wall
from tyrefem.mechanics.solid.finite_law import FiniteLaw, StressResponse
from tyrefem.mechanics.solid.green_law import GreenLaw
from tyrefem.mechanics.solid.six_components import PAIRS

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Tangent:
    """Forces at a motion and their derivative there. Made by `NonlinearForces.at`."""

    outside: NonlinearForces
    forces: Array
    response: StressResponse
    wall: tuple[Array, Array]

    def product(self, change: Array) -> Array:
        """(highest + 1, n_dofs) change of the forces due to a change (highest + 1, n_dofs) of the motion."""
        round_wheel = self.outside.round.within(self.response.tangent.dtype)
        forces = round_wheel.forces(self.response.product(round_wheel.gradient(change)))
        return forces + self.outside.support_forces(change) + self.outside.wall_forces(change, self.wall)

    def energies(self, change: Array) -> Array:
        """(e, m) energy of a change (highest + 1, n_dofs) in every element at every angle, twice, J per radian."""
        gradient = self.outside.round.within(self.response.tangent.dtype).gradient(change)
        return np.asarray((gradient * self.response.product(gradient)).sum(axis=(1, 2)))

    def convex(self, flagged: Flags) -> Tangent:
        """The tangent without negative energies in some elements at some angles, flags (e, m)."""
        return replace(self, response=self.response.convex(flagged)) if flagged.any() else self


@dataclass(frozen=True, eq=False)
class NonlinearForces:
    """Internal forces in excess of those of the inflated state: int P : dH r dA, pressure p (x_s x x_t) on the wall.

    Parameters
    ----------
    harmonics : the linear problem about the state.
    highest : harmonics of the motion.
    law : stress; by default that of the state, or linear in Green's strain if the state has none.
    odd : motions odd about the lowest point (`WheelAngles`).
    """

    harmonics: Harmonics
    highest: int
    law: FiniteLaw | None = None
    odd: bool = False

    @functools.cached_property
    def round(self) -> WheelAngles:
        """Angles at which stress and pressure are evaluated."""
        return WheelAngles(self.harmonics.elements, self.highest, odd=self.odd)

    @functools.cached_property
    def _law(self) -> FiniteLaw:
        state = self.harmonics.state
        return self.law or state.law or GreenLaw(self.harmonics.elements, state.stress, state.tangent, state.bulk)

    @functools.cached_property
    def _inflated_forces(self) -> Array:
        """Forces of the inflated state: the reaction of the rim."""
        static = NonlinearForces(self.harmonics, 0, self.law)
        forces = np.zeros((self.highest + 1, self.harmonics.elements.n_dofs))
        forces[0] = static._total(forces[:1], None)[0][0]
        return forces

    def at(self, amplitudes: Array, precision: type = float) -> Tangent:
        """Forces of displacement amplitudes (highest + 1, n_dofs), N per radian, and their derivative.

        ``precision`` : of the derivative, ``numpy.float32`` for a search that need not be exact.
        """
        forces, response, (along, around) = self._total(amplitudes, precision)
        wall: tuple[Array, Array] = along.astype(precision), around.astype(precision)
        return Tangent(self, forces - self._inflated_forces, response, wall)

    def forces(self, amplitudes: Array) -> Array:
        """(highest + 1, n_dofs) forces without derivative, N per radian."""
        return np.asarray(self._total(amplitudes, None)[0] - self._inflated_forces)

    def __call__(self, amplitudes: Array) -> Array:
        """(highest + 1, n_dofs) forces, N per radian, minus the linear ones of `Harmonics`."""
        linear = np.stack([self.harmonics.stiffness(n) @ part for n, part in enumerate(amplitudes)])
        forces = self.forces(amplitudes) - linear
        forces[:, self.harmonics.held] = 0.0
        return np.asarray(forces)

    def _total(self, amplitudes: Array, tangent: type | None) -> tuple[Array, StressResponse, tuple[Array, Array]]:
        response = self._law.response(self.round.gradient(amplitudes), tangent)
        wall = self._vectors(amplitudes)
        if self.harmonics.state.pressure:
            _, _, _, (n_r, n_z), radii, _, _ = self._wall
            wall[0][..., 0] += n_z[..., None]
            wall[0][..., 1] -= n_r[..., None]
            wall[1][..., 2] += radii[..., None]
        forces = self.round.forces(response.stress) + self.support_forces(amplitudes)
        return forces + self._wall_loads(_cross(*wall)), response, wall

    def support_forces(self, change: Array) -> Array:
        """Forces of the body's support."""
        support = self.harmonics.state.support
        return np.zeros(()) if support is None else np.asarray((support @ np.asarray(change).T).T)

    def wall_forces(self, change: Array, wall: tuple[Array, Array]) -> Array:
        """Change of the pressure's forces: p (u_s x x_t + x_s x u_t), in the precision of x_s and x_t."""
        along, around = self._vectors(change, wall[0].dtype)
        return self._wall_loads(_cross(along, wall[1]) + _cross(wall[0], around))

    @functools.cached_property
    def _wall(self) -> tuple[NDArray[np.int64], Array, Array, Array, Array, Array, Any]:
        """Nodes (f, 9), values and slopes (f, q, 9), normals (2, f, q), radii and weights (f, q), sparse sums
        (n_nodes, 9 f)."""
        import scipy.sparse as sp

        elements = self.harmonics.elements
        dofs, values, along, normals, radii, weights = along_wall(
            elements.facet_basis(self.harmonics.state.pressurised)
        )
        nodes = dofs[:, ::COMPONENTS] // COMPONENTS
        place = (nodes.ravel(), np.arange(nodes.size))
        sums = sp.csr_matrix((np.ones(nodes.size), place), shape=(elements.n_nodes, nodes.size))
        return nodes, values, along, normals, radii, weights, sums

    def _vectors(self, amplitudes: Array, precision: type | np.dtype[Any] = float) -> tuple[Array, Array]:
        """(f, q, m, 3) u_s along the wall, and u_t round the wheel."""
        if not self.harmonics.state.pressure:
            return np.zeros((0, 0, 0, 3)), np.zeros((0, 0, 0, 3))
        nodes, values, along, *_ = self._wall
        values, along = values.astype(precision), along.astype(precision)
        used, inverse = np.unique(nodes, return_inverse=True)
        cut = np.asarray(amplitudes).reshape(self.highest + 1, -1, COMPONENTS)[:, used]
        value, slope = (np.moveaxis(part, 0, -1) for part in self.round.within(precision).at_nodes(cut))
        inverse = inverse.reshape(nodes.shape)
        shape = (*values.shape[:2], -1, 3)
        flat = value[inverse].reshape(len(nodes), 9, -1)
        s, here = (along @ flat).reshape(shape), (values @ flat).reshape(shape)
        v = (values @ slope[inverse].reshape(len(nodes), 9, -1)).reshape(shape)
        v[..., 0] -= here[..., 2]
        v[..., 2] += here[..., 0]
        return s, v

    def _wall_loads(self, vectors: Array) -> Array:
        """Forces of vectors (f, q, m, 3) per area of the parameters."""
        if not self.harmonics.state.pressure:
            return np.zeros(())
        _, values, _, _, _, weights, sums = self._wall
        f, q, m, _ = vectors.shape
        weighted = (self.harmonics.state.pressure * weights)[..., None, None].astype(vectors.dtype) * vectors
        local = values.transpose(0, 2, 1).astype(vectors.dtype) @ weighted.reshape(f, q, -1)
        value = (sums.astype(vectors.dtype) @ local.reshape(9 * f, -1)).reshape(-1, m, 3)
        return self.round.within(vectors.dtype).from_nodes(np.ascontiguousarray(np.moveaxis(value, -1, 0)))

    def second_strains(self, amplitudes: Array) -> Array:
        """(highest + 1, 6, e, q) amplitudes of H'H/2, the nonlinear part of Green's strain; shears doubled."""
        h = self.round.gradient(amplitudes)
        h = h.reshape(len(h), COMPONENTS, COMPONENTS, *h.shape[2:])
        (cos, _, sin), _ = self.round.waves
        rows = []
        for i, j in PAIRS:
            part = (0.5 if i == j else 1.0) * (h[:, :, i] * h[:, :, j]).sum(axis=1)
            odd = (i == 2) != (j == 2)
            rows.append(np.moveaxis(part @ (self.round.shares * (sin if odd else cos)), -1, 0))
        return np.stack(rows, axis=1)


def _cross(s: Array, v: Array) -> Array:
    """s x v in (r, z, t), which is left-handed: e_r x e_z = -e_t."""
    return np.stack([
        s[..., 2] * v[..., 1] - s[..., 1] * v[..., 2],
        s[..., 0] * v[..., 2] - s[..., 2] * v[..., 0],
        s[..., 1] * v[..., 0] - s[..., 0] * v[..., 1],
    ], axis=-1)  # fmt: skip
