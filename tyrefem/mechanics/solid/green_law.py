"""The law that is linear in Green's strain, from the stress and the moduli of the pre-stressed configuration."""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.solid.elements import Rings
from tyrefem.mechanics.solid.finite_deformation import (
    at_points,
    by_components,
    deformation,
    material_tangent,
    strain_gradients,
)
from tyrefem.mechanics.solid.finite_law import StressResponse
from tyrefem.mechanics.solid.six_components import PAIRS, PLACE

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class GreenLaw:
    """S = s_0 + c : E + kappa Proj(tr E) 1, E = sym H + H'H/2: large rotations, moderate strains.

    Parameters
    ----------
    rings : shape functions of the pre-stressed configuration.
    initial, modulus, bulk_modulus : s_0 (6, e, q), c (6, 6, e, q), kappa (e, q), Pa.
    """

    rings: Rings
    initial: Array
    modulus: Array
    bulk_modulus: Array

    @functools.cached_property
    def _bulk(self) -> Array:
        functions, weights = self.rings.linear_functions, self.rings.weights
        return np.einsum("eqa,eq,eqb->eab", functions, weights * self.bulk_modulus, functions)

    def response(self, gradient: Array, tangent: type | None = float) -> StressResponse:
        """P = F S, A = F c F' + 1 S."""
        points = (*gradient.shape[:1], *gradient.shape[2:])
        f, functions, weights = deformation(gradient), self.rings.linear_functions, self.rings.weights[..., None]
        green = [(f[:, i] * f[:, j]).sum(axis=0) - (i == j) for i, j in PAIRS]
        strain = np.stack([part / (2 if i == j else 1) for part, (i, j) in zip(green, PAIRS, strict=True)])
        six = np.einsum("ijeq,jeqm->ieqm", self.modulus, strain, optimize=True) + self.initial[..., None]
        moments = self._bulk @ (functions.transpose(0, 2, 1) @ (weights * strain[:3].sum(axis=0)))
        six[:3] += functions @ moments
        s = at_points(six[PLACE] * weights, 2)
        stress = by_components((at_points(f, 2) @ s).reshape(*points, 9))
        if tangent is None:
            return StressResponse(stress, np.zeros(0), np.zeros(0), functions, self._bulk)
        strains = strain_gradients(f)
        c = at_points(self.modulus * self.rings.weights, 2)[:, :, None]
        volume = (f * weights).reshape(9, *points).transpose(1, 0, 2, 3)
        matrix = material_tangent(strains, c, s).transpose(0, 3, 4, 1, 2)
        matrix = np.ascontiguousarray(matrix, dtype=tangent).reshape(len(gradient), 9, 9, -1)
        return StressResponse(stress, matrix, np.ascontiguousarray(volume, dtype=tangent), functions, self._bulk)
