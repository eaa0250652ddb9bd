"""What the linearisation leaves out: forces of second and third order in the motion, harmonic by harmonic."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.footprint.elements import COMPONENTS
from tyrefem.footprint.follower import along_wall
from tyrefem.footprint.harmonics import Harmonics

Array = NDArray[np.float64]
#: Gradient components (k, i) with exactly one index t vary as sin n t, the others as cos n t.
ODD = np.array([[False, False, True], [False, False, True], [True, True, False]])


@dataclass(frozen=True, eq=False)
class NonlinearForces:
    """Internal forces of Green's strain E = sym H + H'H/2 about the state, less the linear ones of `Harmonics`.

    S = s_0 + c : E + kappa P(tr E) 1, forces int (F S) : dH r dA; P projects on (1, xi, eta). The wall's pressure is
    exact: p (u_s x u_t) is what the following stiffness leaves out. Rubber and cords stay linear in E: large
    rotations, moderate strains.

    Parameters
    ----------
    harmonics : the linear problem.
    highest : harmonics of the motion.
    """

    harmonics: Harmonics
    highest: int

    @functools.cached_property
    def angles(self) -> Array:
        """(2 highest + 1,) from 0 to pi, so fine that products of harmonics do not fold back."""
        return np.linspace(0, np.pi, 2 * self.highest + 1)

    @functools.cached_property
    def _waves(self) -> tuple[Array, Array]:
        """cos n t and sin n t, (n_angles, highest + 1)."""
        phase = np.multiply.outer(self.angles, np.arange(self.highest + 1))
        return np.cos(phase), np.sin(phase)

    @functools.cached_property
    def _shares(self) -> Array:
        """(highest + 1, n_angles) weights with which a wave's amplitude is taken from values at the angles."""
        weights = np.full(len(self.angles), 1 / (len(self.angles) - 1))
        weights[[0, -1]] /= 2
        shares = np.tile(2 * weights, (self.highest + 1, 1))
        shares[0] /= 2
        return shares

    def gradients(self, amplitudes: Array) -> Array:
        """(highest + 1, 3, 3, e, q) amplitudes of H from those of the displacement (highest + 1, n_dofs)."""
        elements = self.harmonics.elements
        nodes = np.asarray(elements.basis.element_dofs).T
        u = np.asarray(amplitudes).reshape(len(amplitudes), -1, COMPONENTS)[:, nodes]
        n = np.arange(len(u))[:, None, None]
        found = np.zeros((len(u), 3, 3, *elements.radii.shape))
        for i in (0, 1):
            found[:, :, i] = np.moveaxis(elements.gradients[i] @ u, -1, 1)
        r, z, t = np.moveaxis((elements.values / elements.radii[..., None]) @ u, -1, 0)
        found[:, 0, 2], found[:, 1, 2], found[:, 2, 2] = -(n * r + t), -n * z, n * t + r
        return found

    def at_angles(self, amplitudes: Array) -> Array:
        """(n_angles, 3, 3, e, q) of gradient amplitudes."""
        cos, sin = self._waves
        found = np.empty((len(self.angles), *amplitudes.shape[1:]))
        for k, i in np.ndindex(3, 3):
            part = amplitudes[:, k, i].reshape(len(amplitudes), -1)
            found[:, k, i] = ((sin if ODD[k, i] else cos) @ part).reshape(len(self.angles), *amplitudes.shape[3:])
        return found

    def __call__(self, amplitudes: Array) -> Array:
        """(highest + 1, n_dofs) forces, N per radian, of displacement amplitudes."""
        elements, state = self.harmonics.elements, self.harmonics.state
        functions, weights = elements.linear_functions, elements.weights
        project = functions @ (functions * weights[..., None]).transpose(0, 2, 1)
        h = self.at_angles(self.gradients(amplitudes))
        second = np.einsum("mkieq,mkjeq->mijeq", h, h) / 2
        linear = (h + h.transpose(0, 2, 1, 3, 4)) / 2

        def stress(strain: Array) -> Array:
            voigt = np.stack([strain[:, 0, 0], strain[:, 1, 1], strain[:, 2, 2],
                              2 * strain[:, 0, 1], 2 * strain[:, 0, 2], 2 * strain[:, 1, 2]])  # fmt: skip
            s = np.einsum("ijeq,jmeq->imeq", state.tangent, voigt, optimize=True)
            s[:3] += state.bulk * np.einsum("eqp,mep->meq", project, voigt[:3].sum(axis=0), optimize=True)
            rows = [[s[0], s[3], s[4]], [s[3], s[1], s[5]], [s[4], s[5], s[2]]]
            return np.moveaxis(np.array(rows), 2, 0)

        of_second = stress(second)
        force = of_second + np.einsum("mkjeq,mjieq->mkieq", h, of_second + stress(linear))
        return self._of_stress(force * weights) + self._of_pressure(amplitudes)

    def _of_stress(self, stress: Array) -> Array:
        """Forces of a stress (n_angles, 3, 3, e, q) times r dA, against the variation of H."""
        elements, n = self.harmonics.elements, np.arange(self.highest + 1)[:, None, None]
        cos, sin = self._waves
        p = np.empty((self.highest + 1, *stress.shape[1:]))
        for k, i in np.ndindex(3, 3):
            wave = self._shares * (sin if ODD[k, i] else cos).T
            p[:, k, i] = (wave @ stress[:, k, i].reshape(len(self.angles), -1)).reshape(-1, *stress.shape[3:])
        local = np.zeros((self.highest + 1, len(elements.radii), 9, COMPONENTS))
        over_r = elements.values / elements.radii[..., None]
        turned = (-n * p[:, 0, 2] + p[:, 2, 2], -n * p[:, 1, 2], -p[:, 0, 2] + n * p[:, 2, 2])
        for k in range(COMPONENTS):
            against = [(elements.gradients[i], p[:, k, i]) for i in (0, 1)] + [(over_r, turned[k])]
            for values, part in against:
                local[..., k] += np.einsum("eqa,neq->nea", values, part, optimize=True)
        return self._summed(elements.dofs, local)

    def _summed(self, dofs: NDArray[np.int64], local: Array) -> Array:
        """(highest + 1, n_dofs) sums of local forces (highest + 1, parts, nodes, 3)."""
        found = np.zeros((self.harmonics.elements.n_dofs, len(local)))
        np.add.at(found, dofs.ravel(), local.reshape(len(local), -1).T)
        return found.T

    def second_strains(self, amplitudes: Array) -> Array:
        """(highest + 1, 6, e, q) amplitudes of H'H/2, what Green's strain adds to the linear one; shears doubled."""
        h = self.at_angles(self.gradients(amplitudes))
        second = np.einsum("mkieq,mkjeq->mijeq", h, h) / 2
        cos, sin = self._waves
        rows = []
        for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
            wave = self._shares * (sin if ODD[i, j] else cos).T
            part = (1 if i == j else 2) * second[:, i, j].reshape(len(second), -1)
            rows.append((wave @ part).reshape(-1, *second.shape[3:]))
        return np.stack(rows, axis=1)

    def _of_pressure(self, amplitudes: Array) -> Array:
        """p int v . (u_s x u_t) ds."""
        elements, state = self.harmonics.elements, self.harmonics.state
        if not state.pressure:
            return np.zeros((self.highest + 1, elements.n_dofs))
        dofs, values, along, _, _, weights = along_wall(elements.facet_basis(state.pressurised))
        u = np.asarray(amplitudes)[:, dofs].reshape(len(amplitudes), len(dofs), -1, COMPONENTS)
        (cos, sin), n = self._waves, np.arange(self.highest + 1)[:, None, None]
        r, z, t = np.moveaxis(np.einsum("fqa,nfak->nfqk", values, u), -1, 0)
        slopes = np.moveaxis(np.einsum("fqa,nfak->nfqk", along, u), -1, 0)

        def wave(part: Array, odd: bool) -> Array:
            return np.tensordot(sin if odd else cos, part, axes=1)

        s = [wave(slopes[0], False), wave(slopes[1], False), wave(slopes[2], True)]
        v = [wave(-(n * r + t), True), wave(-n * z, True), wave(n * t + r, False)]
        # (r, z, t) is left-handed: e_r x e_z = -e_t.
        cross = (s[2] * v[1] - s[1] * v[2], s[0] * v[2] - s[2] * v[0], s[1] * v[0] - s[0] * v[1])
        local = np.zeros(u.shape)
        for k in range(COMPONENTS):
            shares = self._shares * (sin if k == 2 else cos).T
            part = np.tensordot(shares, cross[k] * weights, axes=1)
            local[..., k] = state.pressure * np.einsum("fqa,nfq->nfa", values, part)
        return self._summed(dofs, local)
