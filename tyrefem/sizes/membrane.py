r"""Meridians of an inflated membrane of cords in equilibrium.

A shell of revolution under pressure p, with the angle phi between its normal and the wheel's axis plane measured so
that sin phi = 1 where the tangent is axial (crown) and 0 where it is radial (widest place), satisfies

    N_phi kappa_phi + N_theta kappa_theta = p,    kappa_phi = d(sin phi)/dr,    kappa_theta = sin phi / r.

Axial balance of the part between r and the widest place r_m, where the membrane pulls radially only:

    2 pi r N_phi sin phi = pi p (r^2 - r_m^2).

Cords at +-alpha to the circumference carry N_theta / N_phi = cot^2 alpha. With the lift law cos alpha = k r (a green
tyre is shaped over its drum, every cord crossing every parallel), dividing the first equation by the second,

    d ln(sin phi)/dr = 2 r/(r^2 - r_m^2) - cot^2(alpha)/r,   and since  d ln(sin alpha)/dr = -cot^2(alpha)/r,

    sin phi = (r^2 - r_m^2) sin alpha / A,    sin alpha = sqrt(1 - k^2 r^2),

A a constant (Hofferberth 1956; Purdy 1963, Mathematics underlying the design of pneumatic tires). A radial ply has k
= 0: sin phi = (r^2 - r_m^2)/(r_c^2 - r_m^2) with A = r_c^2 - r_m^2. Then r N_phi = p A/(2 sin alpha).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)


@dataclass(frozen=True)
class Membrane:
    """sin phi = (r^2 - r_m^2) sqrt(1 - k^2 r^2) / A.

    Parameters
    ----------
    widest : r_m, m. constant : A, m2. lift : k = cos(alpha)/r, 1/m; 0 for radial cords.

    >>> ply = Membrane(0.25, 0.3**2 - 0.25**2)
    >>> round(float(ply.sine(0.3)), 12), round(float(ply.residual(0.27)), 12)
    (1.0, 0.0)
    """

    widest: float
    constant: float
    lift: float = 0.0

    def sine(self, r: ArrayLike) -> Array:
        """sin phi at radii."""
        r = np.asarray(r, dtype=float)
        return np.asarray((r**2 - self.widest**2) * self._sine_of_cords(r) / self.constant)

    def curvature(self, r: ArrayLike) -> Array:
        """kappa_phi = d(sin phi)/dr, 1/m."""
        r = np.asarray(r, dtype=float)
        cords = self._sine_of_cords(r)
        return np.asarray((2 * r * cords - (r**2 - self.widest**2) * self.lift**2 * r / cords) / self.constant)

    def tension(self, r: ArrayLike) -> Array:
        """N_phi/p, m."""
        r = np.asarray(r, dtype=float)
        return np.asarray(self.constant / (2 * r * self._sine_of_cords(r)))

    def residual(self, r: ArrayLike) -> Array:
        """(N_phi kappa_phi + N_theta kappa_theta)/p - 1."""
        r = np.asarray(r, dtype=float)
        cotangent2 = (self.lift * r) ** 2 / (1 - (self.lift * r) ** 2)
        return np.asarray(self.tension(r) * (self.curvature(r) + cotangent2 * self.sine(r) / r) - 1)

    def radius(self, phi: ArrayLike) -> Array:
        """r where the angle is phi: radial plies in closed form, bias plies by Newton steps between bounds; an angle
        that no radius has gives the bound.

        sin phi rises up to the radius where 2 sin^2(alpha) = k^2 (r^2 - r_m^2).
        """
        sine = np.sin(np.asarray(phi, dtype=float))
        r = np.sqrt(np.maximum(self.widest**2 + self.constant * sine, 0.01 * self.widest**2))
        if not self.lift:
            return np.asarray(r)
        low = np.full_like(r, 0.1 * self.widest)
        high = np.full_like(r, np.sqrt((2 / self.lift**2 + self.widest**2) / 3))
        below, above = sine <= self.sine(low), sine >= self.sine(high)
        r = np.where(below, low, np.where(above, high, np.clip(r, low, high)))
        reached = below | above
        with np.errstate(all="ignore"):
            for _ in range(80):
                error = np.where(reached, 0.0, self.sine(r) - sine)
                low, high = np.where(error < 0, r, low), np.where(error > 0, r, high)
                newton = r - error / self.curvature(r)
                inside = (newton >= low) & (newton <= high)
                step = np.where(error == 0, 0.0, np.where(inside, newton, (low + high) / 2) - r)
                r = r + step
                if np.abs(step).max(initial=0.0) < 1e-15:
                    break
        return np.asarray(r)

    def run(self, first: float, last: float, count: int) -> tuple[Array, Array, Array, Array]:
        """phi, r, and z and arc length from the first place on, at ``count`` angles from ``first`` down to ``last``.

        z = int sin phi / kappa dphi and s = int dphi / kappa by Gauss quadrature; nothing is singular, also where the
        tangent is axial or radial.
        """
        phi = np.linspace(first, last, count)
        width = (first - last) / (count - 1)
        between = phi[:-1, None] - width * (1 + _NODES) / 2
        curvature = self.curvature(self.radius(between))
        z = (np.sin(between) / curvature) @ _WEIGHTS * width / 2
        s = (1 / curvature) @ _WEIGHTS * width / 2
        return phi, self.radius(phi), np.concatenate([[0.0], np.cumsum(z)]), np.concatenate([[0.0], np.cumsum(s)])

    def _sine_of_cords(self, r: Array) -> Array:
        return np.asarray(np.sqrt(np.maximum(1 - (self.lift * r) ** 2, 1e-12)))
