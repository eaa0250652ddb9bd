"""The carcass line under a belt that carries a share of the pressure.

A belt of crossed cords adds a hoop tension N_theta to the radial plies, and with it a share g of the pressure p:

    N_theta sin phi / r = g(s) p,    N_phi kappa_phi = (1 - g) p,    2 pi r N_phi sin phi = pi p (r^2 - r_m^2),
    d phi/ds = -(1 - g) 2 r sin phi / (r^2 - r_m^2),    dr/ds = -cos phi,    dz/ds = sin phi,

s from the mid plane on, the other symbols as in `tyrefem.sizes.membrane`. At the belt's edge cords end and carry
nothing; their tension rises from there: g = g_0 (1 - (s/s_b)^n), s_b the edge. With n = 2 it is a parabola (Frank's
share of the belt, from memory). With g = 0 beyond the edge the membrane goes on without a jump of its curvature.
"""

from __future__ import annotations

from dataclasses import dataclass

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
    >>> s, r, z, phi = free.run()
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

    def run(self) -> tuple[Array, Array, Array, Array]:
        """s, r, z and phi from the mid plane to the edge."""

        def slopes(s: float, place: Array) -> Array:
            r, _, phi = place
            turn = -(1 - self.share_at(s)) * 2 * r * np.sin(phi) / (r**2 - self.widest**2)
            return np.array([-np.cos(phi), np.sin(phi), turn])

        s = np.linspace(0.0, self.edge, STEPS + 1)
        step = s[1]
        places = np.empty((STEPS + 1, 3))
        places[0] = self.crown, 0.0, np.pi / 2
        for k in range(STEPS):
            place = places[k]
            first = slopes(s[k], place)
            second = slopes(s[k] + step / 2, place + step / 2 * first)
            third = slopes(s[k] + step / 2, place + step / 2 * second)
            fourth = slopes(s[k + 1], place + step * third)
            places[k + 1] = place + step / 6 * (first + 2 * second + 2 * third + fourth)
        return s, places[:, 0], places[:, 1], places[:, 2]
