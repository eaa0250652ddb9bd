"""The points where the tread may touch the road, and how the harmonics that large motion leaves out move them."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import Content
from tyrefem.mechanics.footprint.complementarity import contact_forces
from tyrefem.mechanics.footprint.elements import COMPONENTS
from tyrefem.mechanics.footprint.grid import ContactGrid
from tyrefem.mechanics.footprint.taut_tyre import TautTyre

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Touching:
    """The points of possible contact, along their directions into the road.

    Parameters
    ----------
    tyre : the tyre that leads the search.
    grid : the points; its harmonics above ``highest`` move linearly (`ContactGrid.blocks_above`).
    direction : (c, k) into the road. highest : highest harmonic of the large motion.
    alike : the points with nearly these directions (on a drum): their compliance is used.
    """

    tyre: TautTyre
    grid: ContactGrid
    direction: Array
    highest: int
    alike: Touching | None = None

    @functools.cached_property
    def rows(self) -> Array:
        """(k, highest + 1, 3, m) displacement of a point into the road per amplitude of the tread's nodes."""
        c, k = self.direction.shape
        m = len(self.grid.tread.nodes)
        angle, node = np.arange(k) // m, np.arange(k) % m
        rows = np.zeros((k, self.highest + 1, COMPONENTS, m))
        shapes = self.grid.shapes[:, : self.highest + 1]
        for of, component in zip(range(c), self.grid.tread.components, strict=True):
            rows[np.arange(k), :, component, node] = (self.direction[of] * shapes[of][:, angle]).T
        return rows

    @functools.cached_property
    def loads(self) -> Array:
        """(k, highest + 1, 3, m) N per radian on the tread's amplitudes per unit force into the road."""
        return self.rows * self.grid.shares[: self.highest + 1, None, None]

    @functools.cached_property
    def tail(self) -> Array:
        """(k, k) C, displacement of a point per force at another in the harmonics above ``highest``, m/N."""
        blocks = self.grid.blocks_above(self.highest)
        c, k = self.direction.shape
        tail = np.zeros((k, k))
        for to in range(c):
            for of in range(c):
                tail += self.direction[to][:, None] * blocks[to, :, of] * self.direction[of]
        return tail

    def turned(self, direction: Array) -> Touching:
        """The same points along nearly the same directions."""
        return Touching(self.tyre, self.grid, direction, self.highest, self.alike or self)

    @functools.cached_property
    def compliance(self) -> Array:
        """(k, k) displacement of a point per force at another in small motions, all harmonics, m/N: it predicts the
        contact set."""
        if self.alike is not None:
            return self.alike.compliance
        places = Content.of(self.direction), self.highest, self.grid.harmonics
        return self.tyre.compliances.get(places, lambda: self.tyre.compliance(self.loads, self.rows)) + self.tail

    def into(self, motion: Array) -> Array:
        """(k,) displacement into the road, m, for amplitudes (highest + 1, n_dofs)."""
        at_tread = motion[:, self.tyre.tread].reshape(-1)
        return np.asarray(self.rows.reshape(len(self.rows), -1) @ at_tread)

    def closed(self, gaps: Array, forces: Array, start: Flags) -> Flags:
        """(k,) contact set for gaps, m, under forces, N, with the compliance of small motions."""
        free = gaps - self.compliance @ forces
        return contact_forces(self.compliance, free, start if start.any() else None)[1]
