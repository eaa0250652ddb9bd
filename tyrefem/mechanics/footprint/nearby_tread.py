"""The tread of a tyre near another one: only the difference of their short waves is computed, at a few harmonics."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.footprint.compliance import TreadCompliance, solved_harmonics
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.footprint import Footprint

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
#: Number of harmonics at which the difference of two tyres is computed.
FEW = 5


def few_harmonics(highest: int, above: int) -> tuple[int, ...]:
    """`FEW` of the solved harmonics above ``above``, denser at both ends as Chebyshev's points.

    >>> few_harmonics(120, 24)
    (27, 34, 60, 105, 132)
    """
    solved = [n for n in solved_harmonics(highest) if n > above]
    share = (1 - np.cos(np.pi * np.arange(FEW) / (FEW - 1))) / 2
    return tuple(sorted({solved[round(float(at) * (len(solved) - 1))] for at in share}))


def few_weights(highest: int, above: int) -> Array:
    """(highest - above, few) weights of `few_harmonics` for all harmonics above ``above``: Lagrange's polynomial in
    log(1 + n).

    >>> (few_weights(120, 24)[[2, 9]].round(3) + 0.0).tolist()
    [[1.0, 0.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0, 0.0]]
    """
    x, wanted = np.log1p(few_harmonics(highest, above)), np.log1p(np.arange(above + 1, highest + 1))
    weights = np.ones((len(wanted), len(x)))
    for k, at in enumerate(x):
        for other in np.delete(x, k):
            weights[:, k] *= (wanted - other) / (at - other)
    return weights


@dataclass(frozen=True, eq=False)
class ShortWaves:
    """The harmonics of a footprint above those of its large motion, from which those of nearby tyres start.

    Parameters
    ----------
    near : the footprint, in large motion.
    """

    near: Footprint

    @property
    def above(self) -> int:
        """Highest harmonic of the large motion."""
        assert self.near.balanced is not None
        return len(self.near.balanced) - 1

    @property
    def tread(self) -> TreadCompliance:
        """The tread of the footprint."""
        return self.near.grid.tread

    @functools.cached_property
    def forces(self) -> Array:
        """(harmonics - above, n_dofs) loads, N per radian."""
        loads = self.near.load_harmonics[self.above + 1 :]
        everywhere = np.zeros((len(loads), self.tread.harmonics.elements.n_dofs))
        everywhere[:, self.tread.dofs.ravel()] = loads.reshape(len(loads), -1)
        return everywhere

    @property
    def motion(self) -> Array:
        """(harmonics - above, n_dofs) amplitudes, m."""
        return self.near.amplitudes[self.above + 1 :]

    @functools.cached_property
    def by_few(self) -> Array:
        """(harmonics - above, n_dofs) amplitudes, m, as interpolated from `few_harmonics`."""
        factors = {n: self.factor(self.tread, n) for n in few_harmonics(self.near.harmonics, self.above)}
        return self.responses(factors, self.forces)

    def factor(self, tread: TreadCompliance, n: int) -> tuple[Indices, Any]:
        """`Harmonics.factor_with_last` of a tread with the mesh of the footprint's."""
        return tread.harmonics.factor_with_last(n, tread.dofs.ravel(), self.tread.harmonics)

    def responses(self, factors: dict[int, tuple[Indices, Any]], forces: Array) -> Array:
        """(harmonics - above, n_dofs) amplitudes, m, under forces, interpolated from `few_harmonics`, whose ``factors``
        are given."""
        motion = np.zeros_like(forces)
        for n, weights in zip(factors, few_weights(self.near.harmonics, self.above).T, strict=True):
            order, factor = factors[n]
            motion[:, order] += weights[:, None] * factor.solve(np.ascontiguousarray(forces[:, order].T)).T
        return motion


@dataclass(frozen=True, eq=False)
class NearbyTread(TreadCompliance):
    """`TreadCompliance` of a tyre near another one with the same mesh.

    Above the harmonics of its large motion, G_n = G_n0 + sum_k w_k(n) (G_k - G_k0) with a few harmonics k
    (`few_harmonics`): the difference is small and smooth in n. Motions likewise, each under its forces.
    """

    waves: ShortWaves | None = None
    _factors: dict[int, tuple[Indices, Any]] = field(default_factory=dict, init=False, repr=False)

    def up_to(self, highest: int, above: int = -1) -> Array:
        """(highest - above, c, m, c, m) compliance of all harmonics above ``above``."""
        if not self._serves(highest, above):
            return super().up_to(highest, above)
        assert self.waves is not None
        near = self.waves.tread
        total = near.up_to(highest, above)
        for n, weights in zip(few_harmonics(highest, above), few_weights(highest, above).T, strict=True):
            total += np.multiply.outer(weights, self.solved(n) - near.solved(n))
        return total

    def solved(self, n: int) -> Array:
        """(c, m, c, m) compliance of a solved harmonic, with a cache."""
        if self.waves is None or n not in few_harmonics(self.waves.near.harmonics, self.waves.above):
            return super().solved(n)
        shape, size = (*self.dofs.shape, *self.dofs.shape), self.dofs.size
        return self._solved.get(n, lambda: self.harmonics.compliance_of(n, self._factor(n), size).reshape(shape))

    def responses(self, loads: Array, above: int = -1) -> Array:
        """(n - above - 1, n_dofs) amplitudes, m, of the harmonics above ``above`` under loads (n, n_dofs), N per
        radian."""
        if not self._serves(len(loads) - 1, above):
            return super().responses(loads, above)
        waves = self.waves
        assert waves is not None
        factors = {n: self._factor(n) for n in few_harmonics(waves.near.harmonics, above)}
        motion = waves.motion + waves.responses(factors, loads[above + 1 :]) - waves.by_few
        self._factors.clear()
        return motion

    def _serves(self, highest: int, above: int) -> bool:
        return self.waves is not None and (highest, above) == (self.waves.near.harmonics, self.waves.above)

    def _factor(self, n: int) -> tuple[Indices, Any]:
        assert self.waves is not None
        if n not in self._factors:
            self._factors[n] = self.waves.factor(self, n)
        return self._factors[n]


@dataclass(frozen=True, eq=False)
class NearbyPressing(Pressing):
    """A tyre and its road, near another one in contact: see `NearbyTread`."""

    waves: ShortWaves | None = None

    @functools.cached_property
    def tread(self) -> TreadCompliance:
        """Compliance of the tread."""
        return NearbyTread(self.harmonics, self.waves)
