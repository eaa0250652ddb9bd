"""A motion's values and gradients at angles round the wheel, and forces back to harmonics."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.footprint.elements import COMPONENTS, SectionElements

Array = NDArray[np.float64]
#: Steps of the angle from 0 to pi per harmonic.
PER_HARMONIC = 1.5


@dataclass(frozen=True, eq=False)
class WheelAngles:
    """Angles from 0 to pi for harmonics (u_r cos n t, u_z cos n t, u_t sin n t) up to ``highest``.

    3/2 ``highest`` + 1 of them: products of two harmonics do not fold back on those that are kept.
    """

    elements: SectionElements
    highest: int

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
        return np.stack([cos, cos, sin]), np.stack([-n * sin, -n * sin, n * cos])

    @functools.cached_property
    def shares(self) -> Array:
        """(m, highest + 1) weights with which a wave's amplitude is taken from values at the angles."""
        weights = np.full(len(self.angles), 1 / (len(self.angles) - 1))
        weights[[0, -1]] /= 2
        shares = np.tile(2 * weights[:, None], (1, self.highest + 1))
        shares[:, 0] /= 2
        return shares

    @functools.cached_property
    def _back(self) -> tuple[Array, Array]:
        value, slope = self.waves
        return value * self.shares, slope * self.shares

    def at_nodes(self, amplitudes: Array) -> tuple[Array, Array]:
        """(n_nodes, m, 3) displacement and its derivative by the angle, of amplitudes (highest + 1, n_dofs)."""
        u = np.asarray(amplitudes).reshape(self.highest + 1, -1, COMPONENTS)
        found = []
        for waves in self.waves:
            here = np.empty((u.shape[1], len(self.angles), COMPONENTS))
            for c in range(COMPONENTS):
                here[..., c] = u[..., c].T @ waves[c].T
            found.append(here)
        return found[0], found[1]

    def from_nodes(self, value: Array, slope: Array) -> Array:
        """(highest + 1, n_dofs) forces against the amplitudes, of forces against `at_nodes`; adjoint to it."""
        found = np.empty((self.highest + 1, len(value), COMPONENTS))
        for c in range(COMPONENTS):
            found[..., c] = (value[..., c] @ self._back[0][c] + slope[..., c] @ self._back[1][c]).T
        return found.reshape(self.highest + 1, -1)

    @functools.cached_property
    def _by(self) -> tuple[Array, Array]:
        """Values by r, z and over r: (e, 3 q, 9), and over r alone (e, q, 9)."""
        over_r = self.elements.values / self.elements.radii[..., None]
        return np.concatenate([*self.elements.gradients, over_r], axis=1), over_r

    @functools.cached_property
    def _sums(self) -> Any:
        """Sparse (n_nodes, 9 e): sum over the elements at a node."""
        import scipy.sparse as sp

        nodes = self.elements.element_nodes.ravel()
        place = (nodes, np.arange(len(nodes)))
        return sp.csr_matrix((np.ones(len(nodes)), place), shape=(self.elements.n_nodes, len(nodes)))

    def gradient(self, amplitudes: Array) -> Array:
        """(e, q, m, 9) displacement gradient H, component 3 k + i of (r, z, t)."""
        value, slope = self.at_nodes(amplitudes)
        nodes, (by, over_r) = self.elements.element_nodes, self._by
        e, m = len(nodes), len(self.angles)
        parts = (by @ value[nodes].reshape(e, 9, -1)).reshape(e, 3, -1, m, 3)
        turned = (over_r @ slope[nodes].reshape(e, 9, -1)).reshape(e, -1, m, 3)
        found = np.empty((*turned.shape, 3))
        found[..., 0], found[..., 1], found[..., 2] = parts[:, 0], parts[:, 1], turned
        found[..., 0, 2] -= parts[:, 2, ..., 2]
        found[..., 2, 2] += parts[:, 2, ..., 0]
        return found.reshape(*turned.shape[:3], 9)

    def forces(self, stress: Array) -> Array:
        """(highest + 1, n_dofs) forces, N per radian, of a stress (e, q, m, 9) times r dA; adjoint to `gradient`."""
        e, q, m, _ = stress.shape
        p, (by, over_r) = stress.reshape(e, q, m, 3, 3), self._by
        parts = np.zeros((e, 3, q, m, 3))
        parts[:, 0], parts[:, 1] = p[..., 0], p[..., 1]
        parts[:, 2, ..., 0], parts[:, 2, ..., 2] = p[..., 2, 2], -p[..., 0, 2]
        value = by.transpose(0, 2, 1) @ parts.reshape(e, 3 * q, -1)
        slope = over_r.transpose(0, 2, 1) @ np.ascontiguousarray(p[..., 2]).reshape(e, q, -1)
        value, slope = (self._sums @ part.reshape(9 * e, -1) for part in (value, slope))
        return self.from_nodes(value.reshape(-1, m, 3), slope.reshape(-1, m, 3))
