"""Rotations of the material round the wheel: small motions of the inflated tyre turned with the deformed tyre."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.footprint.elements import COMPONENTS, WheelAngles

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
#: Iterations of the polar decomposition: quadratic, from gradients far below 1 it needs five.
POLAR = 5


def rotation(deformation: Array) -> Array:
    """Rotation R of F = R U, (3, 3, ...), by Newton's iteration R <- (R + R^-T)/2 (Higham 1986).

    >>> turned = rotation(np.array([[0.0, -2.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))
    >>> turned.round(6).tolist()
    [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """
    turned = np.array(deformation)
    for _ in range(POLAR):
        cofactor = np.empty_like(turned)
        for i in range(3):
            for j in range(3):
                a, b, c, d = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
                cofactor[i, j] = turned[a, c] * turned[b, d] - turned[a, d] * turned[b, c]
        turned = (turned + cofactor / (turned[0] * cofactor[0]).sum(axis=0)) / 2
    return turned


@dataclass(frozen=True, eq=False)
class Rotations:
    """Mean rotation R(t) of the elements at every node and angle; fields of harmonics turned by it.

    Turning cuts harmonics above the highest. `backward` is the transpose of `forward` in the work of forces on motions.

    Parameters
    ----------
    round : angles. matrices : (3, 3, n_nodes, m) R. held : fixed degrees of freedom, kept at zero.
    """

    round: WheelAngles
    matrices: Array
    held: Indices

    @classmethod
    def of(cls, round_wheel: WheelAngles, amplitudes: Array, held: Indices) -> Rotations:
        """The rotations of a motion (highest + 1, n_dofs); a node on the mid plane turns in its plane."""
        mean = round_wheel.gradient(amplitudes).mean(axis=2)
        at_nodes = round_wheel.mean_at_nodes(mean.reshape(len(mean), -1)).reshape(-1, 9, mean.shape[2])
        f = np.ascontiguousarray(at_nodes.transpose(1, 0, 2)).reshape(3, 3, len(at_nodes), -1)
        for i in range(COMPONENTS):
            f[i, i] += 1
        on_plane = np.setdiff1d(held[held % COMPONENTS == 1], held[held % COMPONENTS == 0] + 1) // COMPONENTS
        f[1, :, on_plane] = f[:, 1, on_plane] = 0.0
        f[1, 1, on_plane] = 1.0
        return cls(round_wheel, rotation(f), held)

    def forward(self, motion: Array) -> Array:
        """R u (highest + 1, n_dofs)."""
        return self._turned(motion, self.matrices)

    def backward(self, forces: Array) -> Array:
        """R' f (highest + 1, n_dofs)."""
        return self._turned(forces, self.matrices.swapaxes(0, 1))

    def _turned(self, field: Array, matrices: Array) -> Array:
        value = self.round.values(field)
        turned = np.empty_like(value)
        for k in range(COMPONENTS):
            turned[k] = matrices[k, 0] * value[0] + matrices[k, 1] * value[1] + matrices[k, 2] * value[2]
        field = self.round.from_nodes(turned)
        field[:, self.held] = 0.0
        return field

    def backward_at(self, forces: Array, nodes: Indices) -> Array:
        """R' f for forces (k, highest + 1, 3, n) on some nodes (n,)."""
        back, waves, amplitudes = self.matrices[:, :, nodes], self.round.waves[0], self.round.to_amplitudes[0]
        value = [forces[:, :, c].transpose(0, 2, 1) @ waves[c].T for c in range(COMPONENTS)]
        turned = np.empty_like(forces)
        for k in range(COMPONENTS):
            part = back[0, k] * value[0] + back[1, k] * value[1] + back[2, k] * value[2]
            turned[:, :, k] = (part @ amplitudes[k]).transpose(0, 2, 1)
        return turned
