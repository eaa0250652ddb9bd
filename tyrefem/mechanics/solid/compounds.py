"""Rubber compounds: strain energy, Kirchhoff stress and consistent tangent."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.mechanics.solid.six_components import SYMMETRIC_UNIT, UNIT, box, components, outer, over

Array = NDArray[np.float64]
#: Default of bulk modulus over shear modulus: Poisson's ratio 0.495.
BULK_RATIO = 100.0


@dataclass(frozen=True)
class Compound:
    """Rubber whose energy per undeformed volume is W = W_iso + kappa/2 (J - 1)^2, with

    W_iso = c10 (I1 - 3) + c01 (I2 - 3) + c20 (I1 - 3)^2 + c30 (I1 - 3)^3  [J/m3],

    I1 = J^(-2/3) tr b, I2 = J^(-4/3) (tr^2 b - tr b^2)/2, b = F F'. Made by `neo_hookean`, `mooney_rivlin`, `yeoh`.
    The methods give the isochoric part alone; the body adds the pressure kappa (J - 1), projected.

    Raises
    ------
    InputError : a shear modulus 2 (c10 + c01) or a bulk modulus that is not positive.

    >>> round(neo_hookean(1e6).shear_modulus), round(mooney_rivlin(3e5, 1e5).bulk_modulus)
    (1000000, 80000000)
    """

    c10: float
    c01: float = 0.0
    c20: float = 0.0
    c30: float = 0.0
    bulk: float | None = None

    def __post_init__(self) -> None:
        if not self.shear_modulus > 0:
            raise InputError(f"the shear modulus 2 (c10 + c01) must be positive, not {self.shear_modulus:.4g} Pa")
        if not self.bulk_modulus > 0:
            raise InputError(f"the bulk modulus must be positive, not {self.bulk_modulus:.4g} Pa")

    @property
    def shear_modulus(self) -> float:
        """Shear modulus at small strain, Pa."""
        return 2 * (self.c10 + self.c01)

    @property
    def bulk_modulus(self) -> float:
        """kappa, Pa."""
        return BULK_RATIO * self.shear_modulus if self.bulk is None else self.bulk

    def energy(self, deformation: Array) -> Array:
        """W_iso, J/m3, of deformation gradients (3, 3, ...)."""
        first, second, _, _ = _invariants(deformation)
        x = first - 3
        return np.asarray(self.c10 * x + self.c01 * (second - 3) + self.c20 * x**2 + self.c30 * x**3)

    def stress(self, deformation: Array) -> Array:
        """Isochoric Kirchhoff stress tau = 2 W_1 dev b + 2 W_2 dev(I1 b - b^2), Pa, (6, ...); b at unit volume."""
        first, second, b, b2 = _invariants(deformation)
        slope, _ = self.slopes(first)
        g1, g2 = _directions(first, second, b, b2)
        return np.asarray(2 * (slope * g1 + self.c01 * g2))

    def tangent(self, deformation: Array) -> Array:
        """Spatial tangent of the isochoric part, J c = F F (4 d2W/dC dC) F' F', Pa, (6, 6, ...).

        4 [W_11 g1 g1 + W_1 h1 + W_2 h2], g the stresses' directions and
        h1 = -(b 1 + 1 b)/3 + I1/9 1 1 + I1/3 I,
        h2 = b b - b [] b - 2/3 (a 1 + 1 a) + 4/9 I2 1 1 + 2/3 I2 I,  a = I1 b - b^2 (b at unit volume).
        """
        first, second, b, b2 = _invariants(deformation)
        shape = first.shape
        slope, curvature = self.slopes(first)
        unit, fourth = over(UNIT, shape), over(SYMMETRIC_UNIT, shape)
        ones = outer(unit, unit)
        six = components(b)
        mixed = outer(six, unit)
        tangent = slope * (-(mixed + mixed.swapaxes(0, 1)) / 3 + first / 9 * ones + first / 3 * fourth)
        if self.c20 or self.c30:
            g1 = six - first / 3 * unit
            tangent = tangent + curvature * outer(g1, g1)
        if self.c01:
            a = first * six - components(b2)
            mixed = outer(a, unit)
            h2 = outer(six, six) - box(b) - 2 / 3 * (mixed + mixed.swapaxes(0, 1))
            tangent = tangent + self.c01 * (h2 + 4 / 9 * second * ones + 2 / 3 * second * fourth)
        return np.asarray(4 * tangent)

    def slopes(self, first: Array) -> tuple[Array, Array]:
        """First and second derivative of W_iso by I1, Pa."""
        x = first - 3
        return self.c10 + 2 * self.c20 * x + 3 * self.c30 * x**2, 2 * self.c20 + 6 * self.c30 * x


def neo_hookean(shear_modulus: float, bulk: float | None = None) -> Compound:
    """W_iso = G/2 (I1 - 3)."""
    return Compound(shear_modulus / 2, bulk=bulk)


def mooney_rivlin(c10: float, c01: float, bulk: float | None = None) -> Compound:
    """W_iso = c10 (I1 - 3) + c01 (I2 - 3)."""
    return Compound(c10, c01, bulk=bulk)


def yeoh(c10: float, c20: float, c30: float, bulk: float | None = None) -> Compound:
    """W_iso = c10 (I1 - 3) + c20 (I1 - 3)^2 + c30 (I1 - 3)^3."""
    return Compound(c10, c20=c20, c30=c30, bulk=bulk)


def determinant(f: Array) -> Array:
    """J of deformation gradients (3, 3, ...)."""
    return np.asarray(
        f[0, 0] * (f[1, 1] * f[2, 2] - f[1, 2] * f[2, 1])
        - f[0, 1] * (f[1, 0] * f[2, 2] - f[1, 2] * f[2, 0])
        + f[0, 2] * (f[1, 0] * f[2, 1] - f[1, 1] * f[2, 0])
    )


def _invariants(deformation: Array) -> tuple[Array, Array, Array, Array]:
    """I1, I2, b and b^2 at unit volume."""
    f = np.asarray(deformation)
    b = np.einsum("ik...,jk...->ij...", f, f) / np.cbrt(determinant(f)) ** 2
    b2 = np.einsum("ik...,kj...->ij...", b, b)
    first = np.trace(b)
    return first, (first**2 - np.trace(b2)) / 2, b, b2


def _directions(first: Array, second: Array, b: Array, b2: Array) -> tuple[Array, Array]:
    unit = over(UNIT, first.shape)
    six = components(b)
    return six - first / 3 * unit, first * six - components(b2) - 2 / 3 * second * unit
