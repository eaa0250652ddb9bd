"""Layers of cords in rubber: direction, stretch, tension, stress and tangent."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.solid.voigt import components, outer

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CordLayer:
    """Cords of a region at the points of its elements, half at +angle and half at -angle to the circumference:

    W = v_c E/2 (lambda - 1)^2, lambda = |F d|, averaged over d = (sin a m, +-cos a), m along the meridian  [J/m3].

    Parameters
    ----------
    angle : (...) a, rad, before inflation.
    meridian : (2, ...) unit vector (r, z) along the meridian.
    stiffness : (...) v_c E in tension, Pa: the cords' share of the volume times their modulus.
    compression : v_c E in compression over that in tension.
    cord_stiffness : E A of one cord, N; None where only ``stiffness`` is known.

    >>> layer = CordLayer(np.array(0.0), np.array([0.0, 1.0]), np.array(1e9), cord_stiffness=1e4)
    >>> stretched = np.diag([1.0, 1.0, 1.01])
    >>> round(float(layer.stretch(stretched)), 3), round(float(layer.tension(stretched)))
    (1.01, 100)
    """

    angle: Array
    meridian: Array
    stiffness: Array
    compression: float = 1.0
    cord_stiffness: float | None = None

    @property
    def directions(self) -> tuple[Array, Array]:
        """(3, ...) unit vectors (r, z, theta) of the two halves, before inflation."""
        along, around = np.sin(self.angle) * self.meridian, np.cos(self.angle)[None]
        return np.concatenate([along, around]), np.concatenate([along, -around])

    def stretch(self, deformation: Array) -> Array:
        """lambda of the cords (the same at +angle and -angle where there is no twist)."""
        return np.asarray(np.linalg.norm(self._carried(deformation)[0], axis=0))

    def tension(self, deformation: Array) -> Array:
        """Tension of a cord, N: E A (lambda - 1), less in compression.

        Raises
        ------
        InputError : the cords' own stiffness is not known.
        """
        if self.cord_stiffness is None:
            raise InputError("the tension of one cord needs its modulus and diameter; its layer gives only their sum")
        stretch = self.stretch(deformation)
        return np.asarray(self.cord_stiffness * self._acting(stretch) * (stretch - 1))

    def stress_in_layer(self, deformation: Array) -> Array:
        """Pa along the cords per undeformed section of the layer: v_c E (lambda - 1)."""
        stretch = self.stretch(deformation)
        return np.asarray(self.stiffness * self._acting(stretch) * (stretch - 1))

    def energy(self, deformation: Array) -> Array:
        """W, J/m3."""
        stretches = [np.linalg.norm(a, axis=0) for a in self._carried(deformation)]
        return np.asarray(sum(self.stiffness * self._acting(x) / 4 * (x - 1) ** 2 for x in stretches))

    def stress(self, deformation: Array) -> Array:
        """Kirchhoff stress: mean of v_c E (lambda - 1)/lambda a a, a = F d; Pa, (6, ...)."""
        total: Array = np.zeros(())
        for carried in self._carried(deformation):
            x = np.linalg.norm(carried, axis=0)
            dyad = components(carried[:, None] * carried[None])
            total = total + self.stiffness * self._acting(x) * (x - 1) / x / 2 * dyad
        return total

    def tangent(self, deformation: Array) -> Array:
        """Spatial tangent J c: mean of v_c E/lambda^3 a a a a; Pa, (6, 6, ...)."""
        total: Array = np.zeros(())
        for carried in self._carried(deformation):
            x = np.linalg.norm(carried, axis=0)
            dyad = components(carried[:, None] * carried[None])
            total = total + self.stiffness * self._acting(x) / x**3 / 2 * outer(dyad, dyad)
        return total

    def _carried(self, deformation: Array) -> tuple[Array, Array]:
        one, other = (np.einsum("ij...,j...->i...", deformation, d) for d in self.directions)
        return one, other

    def _acting(self, stretch: Array) -> Array:
        return np.where(stretch >= 1, 1.0, self.compression)


def lifted_angle(angle: float, radius: float, at: Array) -> Array:
    """Cord angle, rad, at radii ``at`` by the lift law cos a / r = constant, ``angle`` at ``radius``.

    Raises
    ------
    InputError : a radius that the cords cannot reach.

    >>> bool(np.isclose(np.degrees(lifted_angle(np.radians(35), 0.26, np.array(0.26))), 35))
    True
    """
    cosine = np.asarray(at) / radius * np.cos(angle)
    if np.any(cosine >= 1):
        raise InputError(
            f"with {np.degrees(angle):.4g} deg at r = {radius * 1e3:.4g} mm the lift law has no cord angle at "
            f"r = {float(np.max(at)) * 1e3:.4g} mm",
            field="cords.angle",
        )
    return np.asarray(np.arccos(cosine))


def lifted_ends(angle: float, radius: float, at: Array) -> Array:
    """Cords per metre across them over that at ``radius``: as many cross every parallel, e r sin a = constant."""
    here = lifted_angle(angle, radius, at)
    return np.asarray(radius * np.sin(angle) / (np.asarray(at) * np.sin(here)))
