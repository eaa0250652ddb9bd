"""Layers of cords in rubber: direction, stretch, tension, stress and tangent."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.mechanics.solid.six_components import components, outer

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CordLayer:
    """Cords of a region at the points of its elements, half at +angle and half at -angle to the circumference:

    W' = v_c E (lambda - 1), lambda = |F d|, averaged over d = (sin a m, +-cos a), m along the meridian  [J/m3].

    In compression W' = - C x/(1 + C x/Y), x = 1 - lambda, C = v_c E_c: it approaches Y. A layer whose cords do not
    resist bending is unstable, at any wavelength, once the compression along its cords reaches the shear modulus of
    the rubber (Rosen 1965, Mechanics of composite strengthening: the shear mode of microbuckling).

    Parameters
    ----------
    angle : (...) a, rad, before inflation.
    meridian : (2, ...) unit vector (r, z) along the meridian.
    stiffness : (...) v_c E in tension, Pa: the cords' share of the volume times their modulus.
    compression : v_c E in compression over that in tension, C / (v_c E).
    limit : Y, Pa, largest compression along the cords.
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
    limit: float = np.inf

    @property
    def directions(self) -> tuple[Array, Array]:
        """(3, ...) unit vectors (r, z, theta) of the two halves, before inflation."""
        along, around = np.sin(self.angle) * self.meridian, np.cos(self.angle)[None]
        return np.concatenate([along, around]), np.concatenate([along, -around])

    def stretch(self, deformation: Array) -> Array:
        """lambda of the cords (the same at +angle and -angle where there is no twist)."""
        return np.asarray(np.linalg.norm(self._deformed_directions(deformation)[0], axis=0))

    def tension(self, deformation: Array) -> Array:
        """Tension of a cord, N: E A (lambda - 1), less in compression.

        Raises
        ------
        InputError : the stiffness of one cord is not known.
        """
        if self.cord_stiffness is None:
            raise InputError("the tension of one cord needs its modulus and diameter; its layer gives only their sum")
        return np.asarray(self.cord_stiffness / self.stiffness * self.stress_in_layer(deformation))

    def stress_in_layer(self, deformation: Array) -> Array:
        """W', Pa along the cords per undeformed section of the layer: v_c E (lambda - 1) in tension."""
        return self._law(self.stretch(deformation))[1]

    def slope(self, stretch: Array) -> Array:
        """W' at stretches (..., n) of the cords at the layer's points (...), Pa."""
        return np.asarray(replace(self, stiffness=self.stiffness[..., None])._law(np.asarray(stretch))[1])

    def energy(self, deformation: Array) -> Array:
        """W, J/m3."""
        stretches = [np.linalg.norm(a, axis=0) for a in self._deformed_directions(deformation)]
        return np.asarray(sum(self._law(x)[0] / 2 for x in stretches))

    def stress(self, deformation: Array) -> Array:
        """Kirchhoff stress: mean of W'/lambda a a, a = F d; Pa, (6, ...)."""
        total: Array = np.zeros(())
        for carried in self._deformed_directions(deformation):
            x = np.linalg.norm(carried, axis=0)
            dyad = components(carried[:, None] * carried[None])
            total = total + self._law(x)[1] / x / 2 * dyad
        return total

    def tangent(self, deformation: Array) -> Array:
        """Spatial tangent J c: mean of (W'' - W'/lambda)/lambda^2 a a a a; Pa, (6, 6, ...)."""
        total: Array = np.zeros(())
        for carried in self._deformed_directions(deformation):
            x = np.linalg.norm(carried, axis=0)
            dyad = components(carried[:, None] * carried[None])
            _, slope, curvature = self._law(x)
            total = total + (curvature - slope / x) / x**2 / 2 * outer(dyad, dyad)
        return total

    def slopes(self, stretch: Array) -> tuple[Array, Array]:
        """W' and W'' of cords all in one direction, Pa."""
        strain = np.asarray(stretch - 1)
        curvature = np.where(strain >= 0, 1.0, self.compression) * self.stiffness
        slope = curvature * strain
        if np.isfinite(self.limit):
            part = np.where(strain < 0, -slope / self.limit, 0.0)
            slope, curvature = slope / (1 + part), curvature / (1 + part) ** 2
        return slope, curvature

    def _law(self, stretch: Array) -> tuple[Array, Array, Array]:
        """W, W' and W'' of cords all in one direction, J/m3 and Pa."""
        strain = np.asarray(stretch - 1)
        stiffness = np.where(strain >= 0, 1.0, self.compression) * self.stiffness
        energy = stiffness * strain**2 / 2
        if np.isfinite(self.limit):
            part = np.where(strain < 0, -stiffness * strain / self.limit, 0.0)
            energy = energy * np.where(part > 1e-6, 2 * (part - np.log1p(part)) / np.maximum(part, 1e-6) ** 2, 1.0)
        return energy, *self.slopes(stretch)

    def _deformed_directions(self, deformation: Array) -> tuple[Array, Array]:
        first, second = (np.einsum("ij...,j...->i...", deformation, d) for d in self.directions)
        return first, second


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
    """Cords per metre across them over the value at ``radius``: each parallel has as many, e r sin a = constant."""
    here = lifted_angle(angle, radius, at)
    return np.asarray(radius * np.sin(angle) / (np.asarray(at) * np.sin(here)))
