"""Displacement of the points of the whole tread, by the angle between them, under unit forces in three directions."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.brief import Brief
from tyrefem.cache import Cache
from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.compliance import TreadCompliance, interpolation, solved_harmonics
from tyrefem.mechanics.footprint.elements import COMPONENTS, SectionElements
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.rolling.lossy_harmonics import LossyHarmonics

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
#: Change of the components (r, z, t) of a motion that is mirrored in the mid plane.
MIRROR = np.array([1.0, -1.0, 1.0])
#: Waves of the components (r, z, t): with u = Re(phase U e^(i n t)) the same K_n serves cosines and sines.
PHASE = np.array([1.0, 1.0, -1.0j])
#: Nodes nearer to the mid plane than this, m, are on it.
ON_PLANE = 1e-9


@dataclass(frozen=True, eq=False)
class AntisymmetricHarmonics(Harmonics):
    """Motions of a half section that are antisymmetric about its mid plane (u_r = u_t = 0 there).

    ``mirrored``: the harmonics of the symmetric motions; the matrices are the same.
    """

    mirrored: Harmonics | None = None

    @functools.cached_property
    def elements(self) -> SectionElements:
        """Shape functions and strains."""
        return SectionElements(self.state.mesh) if self.mirrored is None else self.mirrored.elements

    @functools.cached_property
    def matrices(self) -> tuple[Any, Any, Any]:
        """A, B and C, N/m per radian."""
        return Harmonics(self.state).matrices if self.mirrored is None else self.mirrored.matrices

    @functools.cached_property
    def held(self) -> Indices:
        """Fixed degrees of freedom: all at fixed boundaries, u_r and u_t on the mid plane."""
        elements, state = self.elements, self.state
        middle = COMPONENTS * elements.boundary_nodes(state.symmetric)
        dofs = [middle, middle + 2]
        for name in state.fixed:
            nodes = elements.boundary_nodes(name)
            dofs.append((COMPONENTS * nodes[:, None] + np.arange(COMPONENTS)).ravel())
        return np.unique(np.concatenate(dofs))


@dataclass(frozen=True, eq=False)
class LossyAntisymmetricHarmonics(AntisymmetricHarmonics, LossyHarmonics):
    """Antisymmetric motions with loss."""


@dataclass(frozen=True, eq=False)
class TreadInfluence(Brief):
    """Displacements (r, z, t) of the m points of the whole tread under unit forces on them.

    A half section gives both sides: a force on one side is half a symmetric and half an antisymmetric pair, so

    u on the same side = (G_s + G_a) F/2,   u on the other = mirror (G_s - G_a) F/2,   mirror (r, z, t) = (r, -z, t).

    Parameters
    ----------
    tread : nodes and harmonics of the section.
    """

    tread: TreadCompliance
    _solved: Cache[Array] = field(default_factory=lambda: Cache(size=128), init=False, repr=False)
    _kernels: dict[int, Array] = field(default_factory=dict, init=False, repr=False)

    @property
    def lossy(self) -> bool:
        """True if the stiffness is complex: the tyre has loss."""
        return isinstance(self.tread.harmonics, LossyHarmonics)

    @functools.cached_property
    def antisymmetric(self) -> AntisymmetricHarmonics:
        """The antisymmetric motions of a half section."""
        symmetric = self.tread.harmonics
        if isinstance(symmetric, LossyHarmonics):
            loss = (symmetric.angular_speed, symmetric.tangents, symmetric.dissipating)
            return LossyAntisymmetricHarmonics(symmetric.state, *loss, mirrored=symmetric)
        return AntisymmetricHarmonics(symmetric.state, mirrored=symmetric)

    @functools.cached_property
    def mirrored(self) -> Indices:
        """Indices of the tread's nodes that have a mirror image; empty for a full section."""
        if not self.tread.half:
            return np.zeros(0, dtype=np.int64)
        return np.flatnonzero(np.abs(self.tread.places[1]) > ON_PLANE)

    @functools.cached_property
    def source(self) -> tuple[Indices, Array]:
        """(m,) the tread's node of each point, from small to large z, and its side, -1 or 1."""
        count = len(self.tread.nodes)
        nodes = np.concatenate([self.mirrored[::-1], np.arange(count)])
        sides = np.concatenate([-np.ones(len(self.mirrored)), np.ones(count)])
        return nodes, sides

    @functools.cached_property
    def places(self) -> Array:
        """(2, m) points in (r, z), m."""
        nodes, sides = self.source
        r, z = self.tread.places[:, nodes]
        return np.stack([r, sides * z])

    @functools.cached_property
    def lengths(self) -> Array:
        """(m,) tributary length of each point on the outline, m; both sides of a point on the mid plane."""
        return self._whole(self.tread.widths[0])

    @functools.cached_property
    def axial_widths(self) -> Array:
        """(m,) axial projection of `lengths`, m."""
        return self._whole(self.tread.widths[1])

    def _whole(self, widths: Array) -> Array:
        nodes, _ = self.source
        both = 2.0 if self.tread.half else 1.0
        return np.asarray((widths * np.where(np.abs(self.tread.places[1]) <= ON_PLANE, both, 1.0))[nodes])

    @functools.cached_property
    def grooves(self) -> Array:
        """(n, 2) axial intervals without tread, m."""
        grooves = self.tread.grooves
        return np.concatenate([grooves, -grooves[:, ::-1]]) if self.tread.half else grooves

    def solved(self, n: int) -> Array:
        """(3, m, 3, m) displacement per force amplitude of harmonic n, m per N per radian, with a cache."""

        def compute() -> Array:
            if not self.tread.half:
                return self._of(self.tread.harmonics, n)
            symmetric, antisymmetric = self._families(n)
            nodes, sides = self.source
            same, other = (symmetric + antisymmetric) / 2, (symmetric - antisymmetric) / 2
            turned = np.where(sides[None, :] < 0, MIRROR[:, None], 1.0)
            alike = (sides[:, None] == sides[None, :])[None, :, None, :]
            every = np.arange(COMPONENTS)
            at = np.ix_(every, nodes, every, nodes)
            full = np.where(alike, same[at], other[at])
            return np.asarray(full * turned[:, :, None, None] * turned[None, None])

        return self._solved.get(n, compute)

    def _of(self, harmonics: Harmonics, n: int) -> Array:
        """(3, m, 3, m) compliance of the section's tread nodes; zero at components that are held."""
        dofs = (COMPONENTS * self.tread.nodes + np.arange(COMPONENTS)[:, None]).ravel()
        free = np.flatnonzero(~np.isin(dofs, harmonics.held))
        at_free = harmonics.compliance(n, dofs[free])
        compliance = np.zeros((len(dofs), len(dofs)), dtype=at_free.dtype)
        compliance[np.ix_(free, free)] = at_free
        shape = (COMPONENTS, len(self.tread.nodes))
        return compliance.reshape(*shape, *shape)

    def _families(self, n: int) -> tuple[Array, Array]:
        """`_of` symmetric and of antisymmetric motions, by a single factorisation.

        Both hold other components on the mid plane, which is left free.
        """
        dofs = (COMPONENTS * self.tread.nodes + np.arange(COMPONENTS)[:, None]).ravel()
        symmetric, other = self.tread.harmonics.held, self.antisymmetric.held
        middle = np.setdiff1d(np.setxor1d(symmetric, other), dofs)
        dofs = np.setdiff1d(dofs, np.intersect1d(symmetric, other), assume_unique=True)
        last = np.concatenate([dofs, middle])
        condensed = self.tread.harmonics.condensed(n, last)
        return self._freed(condensed, last, symmetric, n), self._freed(condensed, last, other, n)

    def _freed(self, condensed: Array, last: Indices, held: Indices, n: int) -> Array:
        """(3, m, 3, m) compliance of the tread of a ``condensed`` stiffness of the dofs ``last``, some of them held."""
        from scipy.linalg import LinAlgError, cho_factor, cho_solve

        free = np.flatnonzero(~np.isin(last, held))
        stiffness = condensed[np.ix_(free, free)]
        if np.iscomplexobj(stiffness):
            inverse = np.linalg.inv(stiffness)
        else:
            try:
                inverse = cho_solve(cho_factor(stiffness), np.eye(len(free)))
            except LinAlgError:
                raise InputError(f"the state is not stable: harmonic {n:g} has negative stiffness") from None
        nodes = np.full(self.tread.harmonics.elements.n_dofs, -1)
        wanted = COMPONENTS * self.tread.nodes + np.arange(COMPONENTS)[:, None]
        nodes[wanted.ravel()] = np.arange(wanted.size)
        at = nodes[last[free]]
        on_tread = np.flatnonzero(at >= 0)
        compliance = np.zeros((wanted.size, wanted.size), dtype=inverse.dtype)
        compliance[np.ix_(at[on_tread], at[on_tread])] = inverse[np.ix_(on_tread, on_tread)]
        return compliance.reshape(*wanted.shape, *wanted.shape)

    def kernel(self, harmonics: int, n_angles: int) -> Array:
        """(2 n_angles - 1, 3, m, 3, m) displacement of a point per force on another, d angles behind it, m/N.

        d runs from -(n_angles - 1); angles are D = pi/harmonics apart. Forces and displacements are those of hats as
        in `footprint.grid`: sum over n of sinc^4(n D/2) Re(phase_a G_ab/phase_b e^(i n d D)), over pi or, n = 0, 2 pi.
        """
        known = len(self._kernels.get(harmonics, ())) // 2 + 1
        if harmonics not in self._kernels or known < n_angles:
            self._kernels[harmonics] = self._sums(harmonics, n_angles)
            known = n_angles
        return self._kernels[harmonics][known - n_angles : known + n_angles - 1]

    def _sums(self, harmonics: int, n_angles: int) -> Array:
        step, n = np.pi / harmonics, np.arange(harmonics + 1)
        shares = np.sinc(n * step / (2 * np.pi)) ** 4 / np.where(n == 0, 2 * np.pi, np.pi)
        apart = np.arange(1 - n_angles, n_angles)
        waves = (shares * np.exp(1j * step * np.multiply.outer(apart, n))) @ interpolation(harmonics)
        points = len(self.places[0])
        kernel = np.zeros((len(apart), COMPONENTS, points, COMPONENTS, points))
        turn = PHASE[:, None] / PHASE[None, :]
        stacked = np.stack([self.solved(order) for order in solved_harmonics(harmonics)])
        for a in range(COMPONENTS):
            for b in range(COMPONENTS):
                wave = waves * turn[a, b]
                block = stacked[:, a, :, b].reshape(len(stacked), -1)
                sums = (wave @ block).real if np.iscomplexobj(block) else wave.real @ block
                kernel[:, a, :, b] = sums.reshape(-1, points, points)
        return kernel
