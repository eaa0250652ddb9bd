"""Plane stiffness of bias plies with inextensible cords (Clark & Dodge 1980, appendix C)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class BiasPlies:
    """Cords at ``crown_angle`` (rad, to the circumference) at radius ``crown_radius`` (m), in rubber of shear
    modulus ``shear_modulus`` (Pa).

    cos(alpha) = (r / r_0) cos(alpha_0)   (the lift law)
    E_phi = 4 G (1 - tan^2 a + tan^4 a),  E_theta = 4 G (1 - cot^2 a + cot^4 a)          (C3, C4)

    ``poisson_term`` is c_a = 1 - nu_pt nu_tp (eq 7a): 0 for inextensible cords, 0.75 to 1 isotropic.
    """

    shear_modulus: float
    crown_angle: float
    crown_radius: float
    poisson_term: float

    def angle(self, radius: Array) -> Array:
        """Cord angle to the circumference, rad, at radii from the axis, m."""
        cosine = np.asarray(radius) / self.crown_radius * np.cos(self.crown_angle)
        if np.any(cosine >= 1.0):
            largest = float(np.max(radius))
            raise InputError(
                f"the cords cannot reach r = {largest * 1e3:.1f} mm: with {np.degrees(self.crown_angle):.1f} deg at "
                f"the crown (r = {self.crown_radius * 1e3:.1f} mm) the lift law has no angle there",
                field="section.cord_angle",
            )
        return np.asarray(np.arccos(cosine))

    def meridional(self, radius: Array) -> Array:
        """E_phi, Pa."""
        t2 = np.tan(self.angle(radius)) ** 2
        return np.asarray(4 * self.shear_modulus * (1 - t2 + t2 * t2))

    def circumferential(self, radius: Array) -> Array:
        """E_theta, Pa."""
        c2 = np.tan(self.angle(radius)) ** -2
        return np.asarray(4 * self.shear_modulus * (1 - c2 + c2 * c2))

    def poisson(self, radius: Array) -> Array:
        """nu_theta_phi = sqrt((1 - c_a) E_theta / E_phi), which reciprocity (c_b = 0) requires."""
        ratio = self.circumferential(radius) / self.meridional(radius)
        return np.asarray(np.sqrt((1 - self.poisson_term) * ratio))

    def cot2(self, radius: Array) -> Array:
        """cot^2 of the cord angle."""
        return np.asarray(np.tan(self.angle(radius)) ** -2)
