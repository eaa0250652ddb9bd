"""A whole wheel of equal hexahedra in three dimensions: a reference for rolling by harmonics."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.elements import COMPONENTS
from tyrefem.mechanics.footprint.reference_3d import Hexahedra
from tyrefem.mechanics.solid.body import Prestressed

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class WheelOfHexahedra:
    """27-node hexahedra of a full section, ``sectors`` of them round the wheel, in axes that turn with the rubber.

    Nodes lie on 2 ``sectors`` levels of equal angle: even levels are corners, odd ones middles of the elements. All
    sectors are alike, so a discrete Fourier transform over them makes the stiffness of the wheel block diagonal. It is
    exact for these elements: no harmonic is left out.

    Raises
    ------
    InputError : a half section; fewer than three sectors.
    """

    state: Prestressed
    sectors: int

    def __post_init__(self) -> None:
        if self.state.symmetric in (self.state.mesh.boundaries or {}):
            raise InputError("a wheel of hexahedra needs a full section")
        if self.sectors < 3:
            raise InputError(f"a wheel needs three sectors or more, not {self.sectors}", field="sectors")

    @property
    def level(self) -> float:
        """Angle from level to level, rad."""
        return float(np.pi / self.sectors)

    @functools.cached_property
    def sector(self) -> Hexahedra:
        """A single sector."""
        return Hexahedra(self.state, np.array([0.0, 2 * self.level]))

    @functools.cached_property
    def _levels(self) -> tuple[Indices, Indices, Indices]:
        """Nodes of the sector at its first corner, middle, and second corner, each in the same order."""
        r, z, t = np.asarray(self.sector.basis.doflocs)
        levels = []
        for k in range(3):
            members = np.flatnonzero(np.abs(t - k * self.level) < 1e-9)
            levels.append(members[np.lexsort((r[members].round(9), z[members].round(9)))])
        return levels[0], levels[1], levels[2]

    @functools.cached_property
    def tread(self) -> Indices:
        """Places of the tread's nodes among the nodes of a level, from small to large z."""
        first = self._levels[0]
        on_tread = np.isin(first, self.sector.nodes_on(self.state.tread))
        return np.flatnonzero(on_tread)

    @functools.cached_property
    def places(self) -> Array:
        """(2, m) places (r, z) of the tread's nodes on a level, m."""
        return np.asarray(self.sector.basis.doflocs)[:2, self._levels[0][self.tread]]

    def _amplitudes(self, wave: int) -> Complex:
        """(6 m, 6 m) displacements of the tread's nodes of a sector (corner, then middle) under unit forces on them,
        where all sectors are loaded with the phase 2 pi ``wave``/sectors from each to the next."""
        first, middle, last = self._levels
        count, size = len(first), COMPONENTS * len(first)

        def dofs(nodes: Indices) -> Indices:
            return (COMPONENTS * nodes[:, None] + np.arange(COMPONENTS)).ravel()

        order = np.concatenate([dofs(first), dofs(middle), dofs(last)])
        matrix = self._stiffness[np.ix_(order, order)]
        phase = np.exp(2j * np.pi * wave / self.sectors)
        whole = matrix[: 2 * size, : 2 * size].astype(complex)
        whole[:, :size] += phase * matrix[: 2 * size, 2 * size :]
        whole[:size] += np.conj(phase) * matrix[2 * size :, : 2 * size]
        whole[:size, :size] += matrix[2 * size :, 2 * size :]
        fixed = np.concatenate([self.sector.nodes_on(name) for name in self.state.fixed])
        held = np.concatenate([dofs(np.flatnonzero(np.isin(part, fixed)) + k * count)
                               for k, part in enumerate((first, middle))])  # fmt: skip
        free = np.setdiff1d(np.arange(2 * size), held)
        loaded = np.concatenate([dofs(self.tread), size + dofs(self.tread)])
        units = (free[:, None] == loaded[None, :]).astype(complex)
        solved = np.linalg.solve(whole[np.ix_(free, free)], units)
        return np.asarray(units.T @ solved)

    @functools.cached_property
    def _stiffness(self) -> Array:
        return np.asarray(self.sector.stiffness.toarray())

    @functools.cached_property
    def influence(self) -> Array:
        """(2, 2 sectors, m, 3, m, 3) displacement along (r, z, t), m/N: of a node ``d`` levels in front of a loaded one
        (negative d count from the end), which lies on a corner (first index 0) or a middle (1)."""
        waves = np.arange(self.sectors)
        half = [self._amplitudes(int(wave)) for wave in range(self.sectors // 2 + 1)]
        # Waves that run the other way are the conjugates.
        amplitudes = np.stack([half[k] if k < len(half) else half[self.sectors - k].conj() for k in waves])
        across = COMPONENTS * len(self.tread)
        by_sector = np.fft.ifft(amplitudes, axis=0).real.reshape(self.sectors, 2, across, 2, across)
        influence = np.empty((2, 2 * self.sectors, across, across))
        for of in range(2):
            for to in range(2):
                levels = (2 * np.arange(self.sectors) + to - of) % (2 * self.sectors)
                influence[of, levels] = by_sector[:, to, :, of]
        m = len(self.tread)
        return influence.reshape(2, 2 * self.sectors, m, COMPONENTS, m, COMPONENTS)

    def compliance(self, first: int, count: int) -> Array:
        """(count, m, 3, count, m, 3) displacement per force, m/N, of ``count`` levels from the level ``first`` on."""
        m = len(self.tread)
        compliance = np.empty((count, m, COMPONENTS, count, m, COMPONENTS))
        for of in range(count):
            rows = (np.arange(count) - of) % (2 * self.sectors)
            compliance[:, :, :, of] = self.influence[(first + of) % 2, rows]
        return compliance
