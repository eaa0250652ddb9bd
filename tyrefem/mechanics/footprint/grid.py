"""The grid of possible contact, nodes times angles, and the compliance between its points."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.mechanics.footprint.compliance import TreadCompliance
from tyrefem.mechanics.footprint.elements import COMPONENTS

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ContactGrid(Brief):
    """Tread nodes at angles j D, j = 0 .. n_angles - 1, D = pi / harmonics; the other side is the mirror image.

    Pressure is linear between angles: a force at j is a hat of half width D with the amplitude
    sinc^2(n D/2) cos(n j D) in harmonic n. Displacements and gaps are averages with the same hat. The compliance is
    therefore symmetric and positive definite for any number of angles up to ``harmonics`` + 1.
    """

    tread: TreadCompliance
    harmonics: int
    n_angles: int
    _blocks: dict[int, Array] = field(default_factory=dict, init=False, repr=False)

    @property
    def step(self) -> float:
        """D, rad."""
        return float(np.pi / self.harmonics)

    @functools.cached_property
    def angles(self) -> Array:
        """(n_angles,), rad."""
        return np.asarray(self.step * np.arange(self.n_angles), dtype=float)

    @functools.cached_property
    def sides(self) -> Array:
        """(n_angles,) number of times that an angle occurs on the wheel: once at 0, else twice."""
        sides: Array = np.full(self.n_angles, 2.0)
        sides[0] = 1.0
        return sides

    @functools.cached_property
    def shapes(self) -> Array:
        """(c, harmonics + 1, n_angles) amplitude of a hat in each harmonic: cosine for r and z, sine for t."""
        n = np.arange(self.harmonics + 1)[:, None]
        smooth = np.sinc(n * self.step / (2 * np.pi)) ** 2
        even, odd = smooth * np.cos(n * self.angles), smooth * np.sin(n * self.angles)
        return np.stack([odd if is_odd else even for is_odd in self._odd])

    @functools.cached_property
    def shares(self) -> Array:
        """(harmonics + 1,) 1/pi, half of it for n = 0: normalisation to unit work on the whole wheel."""
        shares = np.full(self.harmonics + 1, 1 / np.pi)
        shares[0] /= 2
        return shares

    @property
    def blocks(self) -> Array:
        """(c, k, c, k) displacement along c of point k = (angle, node) per force at another point; both sides."""
        return self.blocks_above(-1)

    def blocks_above(self, lowest: int) -> Array:
        """`blocks` of the harmonics above ``lowest``, with a cache; zero if there are none."""
        if lowest not in self._blocks:
            self._blocks.clear()
            self._blocks[lowest] = self._sums(lowest)
        return self._blocks[lowest]

    def _sums(self, lowest: int) -> Array:
        """Sums over n of waves at two angles: half of a wave at their difference and half of one at their sum."""
        compliance = self.tread.up_to(self.harmonics, lowest)
        _, c, m, _, _ = compliance.shape
        n = np.arange(lowest + 1, self.harmonics + 1)
        weights = self.shares[lowest + 1 :] * np.sinc(n * self.step / (2 * np.pi)) ** 4 / 2
        phase = np.multiply.outer(self.step * np.arange(2 * self.n_angles - 1), n)
        even, odd = np.cos(phase) * weights, np.sin(phase) * weights
        at = np.arange(self.n_angles)
        apart, together = np.abs(at[:, None] - at), at[:, None] + at
        ahead = np.sign(at - at[:, None])[..., None, None]
        blocks = np.empty((c, self.n_angles, m, c, self.n_angles, m))
        for to, is_odd in enumerate(self._odd):
            for of, of_odd in enumerate(self._odd):
                waves = (odd if is_odd != of_odd else even) @ compliance[:, to, :, of].reshape(len(n), m * m)
                waves = waves.reshape(-1, m, m)
                if is_odd == of_odd:
                    sums = waves[apart] + (-waves[together] if is_odd else waves[together])
                else:
                    sums = waves[together] + (ahead if of_odd else -ahead) * waves[apart]
                blocks[to, :, :, of] = sums.transpose(0, 2, 1, 3)
        return blocks.reshape(c, self.n_angles * m, c, self.n_angles * m)

    @property
    def _odd(self) -> list[bool]:
        """Whether a component's waves are odd about the lowest point."""
        return [component == 2 for component in self.tread.components]

    def load_harmonics(self, forces: Array) -> Array:
        """(harmonics + 1, c, m) load amplitudes, N per radian, of forces (c, k) on the tread."""
        at = np.asarray(forces).reshape(len(forces), self.n_angles, -1)
        return np.asarray(np.einsum("cnj,cjm->ncm", self.shapes, at) * self.shares[:, None, None])

    def displacements(self, amplitudes: Array) -> Array:
        """(c, k) displacements, m, averaged with the hats, of amplitudes (n, n_dofs) of the first n harmonics."""
        at = np.asarray(amplitudes)[:, self.tread.dofs]
        return np.einsum("cnj,ncm->cjm", self.shapes[:, : len(at)], at).reshape(len(self.shapes), -1)

    def axial(self, amplitudes: Array) -> Array:
        """(k,) displacements along the axis, m, averaged with the hats, of amplitudes (n, n_dofs) of the first n
        harmonics; also of a half section, on which nothing loads them."""
        at = np.asarray(amplitudes)[:, COMPONENTS * self.tread.nodes + 1]
        return np.asarray(self.shapes[0, : len(at)].T @ at).ravel()

    def places(self, displacement: Array, shift: float) -> Array:
        """(3, k) points (x, y, z), m, at the angles plus ``shift``, with displacements (c, k) added."""
        r, z = self.tread.places
        angle = np.repeat(self.angles + shift, len(r))
        displacements = np.zeros((3, len(angle)))
        displacements[list(self.tread.components)] = displacement
        radius = np.tile(r, self.n_angles) + displacements[0]
        sin, cos = np.sin(angle), np.cos(angle)
        axial = np.tile(z, self.n_angles) + displacements[1]
        return np.stack([radius * sin + displacements[2] * cos, radius * cos - displacements[2] * sin, axial])

    def along(self, normals: Array) -> Array:
        """(c, k) components along (r, t, z) of directions (3, k) in (x, y, z)."""
        x, y, z = normals
        angle = np.repeat(self.angles, len(self.tread.nodes))
        sin, cos = np.sin(angle), np.cos(angle)
        turned = {0: x * sin + y * cos, 2: x * cos - y * sin, 1: z}
        return np.stack([turned[c] for c in self.tread.components])

    @functools.cached_property
    def areas(self) -> Array:
        """(k,) tributary tread area of a point on one side, m2."""
        lengths, _ = self.tread.widths
        return np.tile(lengths * self.tread.places[0] * self.step, self.n_angles)
