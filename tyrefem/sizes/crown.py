"""The carcass line under a belt that carries a share of the pressure.

A belt of crossed cords adds a hoop tension N_theta to the radial plies, and with it a share g of the pressure p:

    N_theta sin phi / r = g(s) p,    N_phi kappa_phi = (1 - g) p,    2 pi r N_phi sin phi = pi p (r^2 - r_m^2),
    d phi/ds = -(1 - g) 2 r sin phi / (r^2 - r_m^2),    dr/ds = -cos phi,    dz/ds = sin phi,

s from the mid plane on, the other symbols as in `tyrefem.sizes.membrane`. At the belt's edge cords end and carry
nothing; their tension rises from there: g = g_0 (1 - (s/s_b)^n), s_b the edge. With n = 2 it is a parabola (Frank's
share of the belt, from memory). With g = 0 beyond the edge the membrane goes on without a jump of its curvature.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
#: Steps of the integration (Runge-Kutta, fourth order).
STEPS = 60


@dataclass(frozen=True)
class BeltedCrown:
    """The line from the mid plane to the belt's edge.

    Parameters
    ----------
    crown : radius of the line at the mid plane, m. widest : r_m, m. edge : s_b, m. share : g_0. power : n.

    >>> free = BeltedCrown(0.3, 0.25, 0.05, 0.0, 2.0)
    >>> s, r, z, phi = free.line
    >>> bool(abs((r[-1] ** 2 - 0.25**2) / (0.3**2 - 0.25**2) - np.sin(phi[-1])) < 1e-9)
    True
    """

    crown: float
    widest: float
    edge: float
    share: float
    power: float

    @property
    def radius(self) -> float:
        """Radius of curvature at the mid plane, m."""
        return (self.crown**2 - self.widest**2) / (2 * self.crown * (1 - self.share))

    def share_at(self, s: float) -> float:
        """g at a place of the line, m from the mid plane."""
        return self.share * (1 - min(s / self.edge, 1.0) ** self.power)

    @cached_property
    def line(self) -> tuple[Array, Array, Array, Array]:
        """s, r, z and phi from the mid plane to the edge; nan where there is no such line.

        In plain numbers: a size is drawn by hundreds of these lines, and arrays of three take five times as long.
        """
        rows = [(0.0, self.crown, 0.0, math.pi / 2)]
        try:
            for k in range(STEPS):
                rows.append(self._next(k, *rows[-1]))
        except (ArithmeticError, ValueError):
            rows = [(math.nan,) * 4] * (STEPS + 1)
        s_r_z_phi = np.array(rows).T
        return s_r_z_phi[0], s_r_z_phi[1], s_r_z_phi[2], s_r_z_phi[3]

    def _next(self, k: int, s: float, r: float, z: float, phi: float) -> tuple[float, float, float, float]:
        """s, r, z and phi after step ``k``."""
        step, half = self.edge / STEPS, self.edge / STEPS / 2
        r1, z1, phi1 = self._slopes(s, r, phi)
        r2, z2, phi2 = self._slopes(s + half, r + half * r1, phi + half * phi1)
        r3, z3, phi3 = self._slopes(s + half, r + half * r2, phi + half * phi2)
        r4, z4, phi4 = self._slopes(s + step, r + step * r3, phi + step * phi3)
        r += step / 6 * (r1 + 2 * r2 + 2 * r3 + r4)
        z += step / 6 * (z1 + 2 * z2 + 2 * z3 + z4)
        phi += step / 6 * (phi1 + 2 * phi2 + 2 * phi3 + phi4)
        return self.edge * (k + 1) / STEPS, r, z, phi

    def _slopes(self, s: float, r: float, phi: float) -> tuple[float, float, float]:
        """dr/ds, dz/ds and dphi/ds."""
        sine = math.sin(phi)
        return -math.cos(phi), sine, -(1 - self.share_at(s)) * 2 * r * sine / (r * r - self.widest**2)
