"""The tread of a tyre near another one: only the difference of their short waves is computed, at a few harmonics."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.footprint.compliance import TreadCompliance, solved_harmonics
from tyrefem.mechanics.footprint.contact import Pressing
from tyrefem.mechanics.footprint.footprint import Footprint
from tyrefem.mechanics.footprint.harmonics import Harmonics

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
class UnitMotion:
    """A tyre in one harmonic under unit loads on its tread: displacements ``moved`` (n_free, k), m per N per radian, of
    the degrees of freedom in an ``order``, and those of the tread, ``compliance`` (k, k)."""

    order: Indices
    moved: Array
    compliance: Array

    @classmethod
    def of(cls, tread: TreadCompliance, n: int, like: Harmonics) -> UnitMotion:
        """From one factorisation of a tread's harmonic; ``like``: a tyre with the same mesh, whose order serves."""
        dofs = tread.dofs.ravel()
        factor = tread.harmonics.factor_with_last(n, dofs, like)
        order, size = factor[0], dofs.size
        loads = np.zeros((len(order), size))
        loads[-size:] = np.eye(size)
        return cls(order, factor[1].solve(loads), tread.harmonics.compliance_of(n, factor, size))


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
        """(harmonics - above, c m) loads on the tread, N per radian."""
        loads = self.near.load_harmonics[self.above + 1 :]
        return loads.reshape(len(loads), -1)

    @property
    def motion(self) -> Array:
        """(harmonics - above, n_dofs) amplitudes, m."""
        return self.near.amplitudes[self.above + 1 :]

    @functools.cached_property
    def few(self) -> dict[int, UnitMotion]:
        """The tyre of the footprint under unit loads, at `few_harmonics`."""
        return {n: self.unit(self.tread, n) for n in few_harmonics(self.near.harmonics, self.above)}

    @functools.cached_property
    def by_few(self) -> Array:
        """(harmonics - above, n_dofs) amplitudes, m, as interpolated from `few_harmonics`."""
        return self.responses(self.few, self.forces)

    def unit(self, tread: TreadCompliance, n: int) -> UnitMotion:
        """A tread with the mesh of the footprint's under unit loads."""
        return UnitMotion.of(tread, n, self.tread.harmonics)

    def responses(self, few: Mapping[int, UnitMotion], forces: Array) -> Array:
        """(harmonics - above, n_dofs) amplitudes, m, under forces on the tread (harmonics - above, c m), interpolated
        from a tyre under unit loads at ``few`` harmonics."""
        motion = np.zeros((len(forces), self.tread.harmonics.elements.n_dofs))
        for unit, weights in zip(few.values(), few_weights(self.near.harmonics, self.above).T, strict=True):
            motion[:, unit.order] += (weights[:, None] * forces) @ unit.moved.T
        return motion


@dataclass(frozen=True, eq=False)
class NearbyTread(TreadCompliance):
    """`TreadCompliance` of a tyre near another one with the same mesh.

    Above the harmonics of its large motion, G_n = G_n0 + sum_k w_k(n) (G_k - G_k0) with a few harmonics k
    (`few_harmonics`): the difference is small and smooth in n. Motions likewise, each under its forces.

    ``units`` : the tyre under unit loads by harmonic; footprints of one tyre share it.
    """

    waves: ShortWaves | None = None
    units: dict[int, UnitMotion] = field(default_factory=dict, repr=False)

    def up_to(self, highest: int, above: int = -1) -> Array:
        """(highest - above, c, m, c, m) compliance of all harmonics above ``above``."""
        if not self._serves(highest, above):
            return super().up_to(highest, above)
        assert self.waves is not None
        waves, shape = self.waves, (*self.dofs.shape, *self.dofs.shape)
        total = waves.tread.up_to(highest, above).copy()
        for n, weights in zip(few_harmonics(highest, above), few_weights(highest, above).T, strict=True):
            change = self._unit(n).compliance - waves.few[n].compliance
            total += np.multiply.outer(weights, change.reshape(shape))
        return total

    def responses(self, loads: Array, above: int = -1) -> Array:
        """(n - above - 1, n_dofs) amplitudes, m, of the harmonics above ``above`` under loads (n, n_dofs), N per
        radian."""
        on_tread = np.zeros(loads.shape[1], dtype=bool)
        on_tread[self.dofs] = True
        if not self._serves(len(loads) - 1, above) or loads[above + 1 :, ~on_tread].any():
            return super().responses(loads, above)
        waves = self.waves
        assert waves is not None
        few = {n: self._unit(n) for n in few_harmonics(waves.near.harmonics, above)}
        return waves.motion + waves.responses(few, loads[above + 1 :, self.dofs.ravel()]) - waves.by_few

    def _serves(self, highest: int, above: int) -> bool:
        """Whether these are the short waves of the nearby tyre, and more than `FEW`."""
        if self.waves is None or highest - above <= FEW:
            return False
        return (highest, above) == (self.waves.near.harmonics, self.waves.above)

    def _unit(self, n: int) -> UnitMotion:
        assert self.waves is not None
        if n not in self.units:
            self.units[n] = self.waves.unit(self, n)
        return self.units[n]


@dataclass(frozen=True, eq=False)
class NearbyPressing(Pressing):
    """A tyre and its road, near another one in contact: see `NearbyTread`.

    ``like`` : a nearby tyre in the same state, which shares its stiffness and its motions under unit loads.
    """

    waves: ShortWaves | None = None
    like: NearbyPressing | None = None

    @functools.cached_property
    def harmonics(self) -> Harmonics:
        """Stiffness of every harmonic."""
        return Harmonics(self.state) if self.like is None else self.like.harmonics

    @functools.cached_property
    def tread(self) -> TreadCompliance:
        """Compliance of the tread."""
        return NearbyTread(self.harmonics, self.waves, {} if self.like is None else self.like.units)

    @property
    def units(self) -> dict[int, UnitMotion]:
        """The tyre under unit loads, by harmonic."""
        assert isinstance(self.tread, NearbyTread)
        return self.tread.units
