"""Stress and tangent of a pre-stressed body in a further motion of any size: from its compounds and cords, or linear
in Green's strain."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.solid.compounds import determinant
from tyrefem.mechanics.solid.elements import SYMMETRIC_UNIT, UNIT, Indices, Rings, over
from tyrefem.mechanics.solid.parts import RegionMaterial

Array = NDArray[np.float64]
#: Index of a tensor's component among the six.
PLACE = np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]])
#: The six components.
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
#: Contribution of a pressure p J 1 to the spatial tangent, over p J.
PRESSED = np.multiply.outer(UNIT, UNIT) - 2 * SYMMETRIC_UNIT
#: Number of angles computed together; it limits the memory of intermediate tensors.
CHUNK = 8


@dataclass(frozen=True, eq=False)
class StressResponse:
    """First Piola stress P in the pre-stressed configuration and its derivative, both times r dA, at m angles.

    dP = A : dF + V kappa Proj(V : dF), V = dJ/dF: the dilatation is projected on 1, xi, eta of each element.

    Parameters
    ----------
    stress : (e, q, m, 9) P, N m per radian; components 3 k + i with direction k of the force and i of the gradient.
    tangent : (e, q, m, 9, 9) A. volume : (e, q, m, 9) V. Empty if only the stress is computed.
    functions : (e, q, 3) 1, xi, eta. bulk : (e, 3, 3) bulk stiffness between them.
    """

    stress: Array
    tangent: Array
    volume: Array
    functions: Array
    bulk: Array

    def product(self, change: Array) -> Array:
        """(e, q, m, 9) change of the stress due to a change (e, q, m, 9) of the gradient."""
        product = (self.tangent @ change[..., None])[..., 0]
        dilatation = np.einsum("eqmc,eqmc->eqm", self.volume, change)
        moments = self.bulk @ (self.functions.transpose(0, 2, 1) @ dilatation)
        product += self.volume * (self.functions @ moments)[..., None]
        return np.asarray(product)


class FiniteLaw(Protocol):
    """Stress as a function of displacement gradients from a pre-stressed configuration."""

    def response(self, gradient: Array, tangent: bool = True) -> StressResponse:
        """`StressResponse` at displacement gradients H (e, q, m, 9) from the pre-stressed configuration."""
        ...  # pragma: no cover


def _deformation(gradient: Array) -> Array:
    """(3, 3, e, q, m) F = 1 + H."""
    f = np.moveaxis(gradient.reshape(*gradient.shape[:3], 3, 3), (-2, -1), (0, 1))
    return np.asarray(f + over(np.eye(3), gradient.shape[:3]))


def _inverse(f: Array) -> Array:
    """(3, 3, ...) inverse by cofactors."""
    inverse = np.empty_like(f)
    for i in range(3):
        for j in range(3):
            a, b, c, d = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
            inverse[j, i] = f[a, c] * f[b, d] - f[a, d] * f[b, c]
    inverse /= (f[0] * inverse[:, 0]).sum(axis=0)
    return inverse


def _points(tensors: Array, axes: int) -> Array:
    """Tensors with their one or two component axes moved from the front to the end, contiguous."""
    return np.ascontiguousarray(np.moveaxis(tensors, range(axes), range(-axes, 0)))


def _tangent(strains: Array, stiffness: Array, initial: Array) -> Array:
    """(e, q, m, 9, 9) B' c B + 1 S of B (e, q, m, 6, 9), c (e, q, m or 1, 6, 6), S (e, q, m, 3, 3)."""
    tangent = strains.swapaxes(-1, -2) @ (stiffness @ strains)
    for k in range(3):
        tangent[..., 3 * k : 3 * k + 3, 3 * k : 3 * k + 3] += initial
    return np.asarray(tangent)


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

    def response(self, gradient: Array, tangent: bool = True) -> StressResponse:
        """P = F S, A = F c F' + 1 S."""
        f, functions, weights = _deformation(gradient), self.rings.linear_functions, self.rings.weights[..., None]
        green = [(f[:, i] * f[:, j]).sum(axis=0) - (i == j) for i, j in PAIRS]
        strain = np.stack([part / (2 if i == j else 1) for part, (i, j) in zip(green, PAIRS, strict=True)])
        six = np.einsum("ijeq,jeqm->ieqm", self.modulus, strain, optimize=True) + self.initial[..., None]
        moments = self._bulk @ (functions.transpose(0, 2, 1) @ (weights * strain[:3].sum(axis=0)))
        six[:3] += functions @ moments
        s = _points(six[PLACE] * weights, 2)
        stress = (_points(f, 2) @ s).reshape(gradient.shape)
        if not tangent:
            return StressResponse(stress, np.zeros(0), np.zeros(0), functions, self._bulk)
        strains = np.zeros((*gradient.shape[:3], 6, 9))
        for row, (i, j) in enumerate(PAIRS):
            for k in range(3):
                strains[..., row, 3 * k + j] += f[k, i]
                if i != j:
                    strains[..., row, 3 * k + i] += f[k, j]
        c = _points(self.modulus * self.rings.weights, 2)[:, :, None]
        volume = _points(f * weights, 2).reshape(gradient.shape)
        return StressResponse(stress, _tangent(strains, c, s), volume, functions, self._bulk)


@dataclass(frozen=True, eq=False)
class BodyLaw:
    """The stress of a body's compounds and cords at F F_0; cords may be slack at some angles and taut at others.

    Parameters
    ----------
    rings : shape functions of the body before inflation.
    parts : region -> its material. members : region -> numbers of its elements.
    bulk_modulus : (e,) Pa. inflated : (3, 3, e, q) F_0.
    """

    rings: Rings
    parts: Mapping[str, RegionMaterial]
    members: Mapping[str, Indices]
    bulk_modulus: Array
    inflated: Array

    @functools.cached_property
    def _bulk(self) -> Array:
        return np.asarray(self.bulk_modulus[:, None, None] * np.eye(3))

    @functools.cached_property
    def _parts(self) -> dict[str, RegionMaterial]:
        """The parts with a further axis in the values at the points, for the angles."""
        parts = {}
        for name, part in self.parts.items():
            layers = [
                replace(
                    layer,
                    angle=layer.angle[..., None],
                    meridian=layer.meridian[..., None],
                    stiffness=layer.stiffness[..., None],
                )
                for layer in part.cords
            ]
            parts[name] = replace(part, cords=tuple(layers))
        return parts

    def _sum_of_parts(self, deformation: Array, method: str, axes: tuple[int, ...]) -> Array:
        gathered = np.empty((*axes, *deformation.shape[2:]))
        for name, part in self._parts.items():
            members = self.members[name]
            part_deformation = deformation[:, :, members]
            total = getattr(part.compound, method)(part_deformation)
            for layer in part.cords:
                total = total + getattr(layer, method)(part_deformation)
            gathered[..., members, :, :] = total
        return gathered

    def response(self, gradient: Array, tangent: bool = True) -> StressResponse:
        """P = tau F^-T, A = F^-1 (J c + tau 1) F^-T."""
        rings, size = self.rings, gradient.shape[2]
        functions, weights = rings.linear_functions, rings.weights[..., None]
        stress, volume = np.empty(gradient.shape), np.empty(gradient.shape)
        tangents = np.empty((*gradient.shape, 9) if tangent else 0)
        for k in range(0, size, CHUNK):
            part = slice(k, k + CHUNK)
            f = _deformation(gradient[:, :, part])
            inverse = _points(_inverse(f), 2)
            total_deformation = np.einsum("ijeqm,jkeq->ikeqm", f, self.inflated)
            j = determinant(total_deformation)
            p = functions @ (self._bulk @ (functions.transpose(0, 2, 1) @ (weights * (j - 1))))
            six = self._sum_of_parts(total_deformation, "stress", (6,))
            six[:3] += p * j
            tau = _points(six[PLACE] * weights, 2)
            shape = (*inverse.shape[:3], 9)
            stress[:, :, part] = (tau @ inverse.swapaxes(-1, -2)).reshape(shape)
            if tangent:
                volume[:, :, part] = (inverse.swapaxes(-1, -2) * (j * weights)[..., None, None]).reshape(shape)
                c = self._sum_of_parts(total_deformation, "tangent", (6, 6)) + p * j * over(PRESSED, p.shape)
                strains = np.zeros((*shape[:3], 6, 9))
                for row, (i, m) in enumerate(PAIRS):
                    strains[..., row, 3 * i : 3 * i + 3] += inverse[..., m]
                    if i != m:
                        strains[..., row, 3 * m : 3 * m + 3] += inverse[..., i]
                tangents[:, :, part] = _tangent(
                    strains, _points(c * weights, 2), inverse @ tau @ inverse.swapaxes(-1, -2)
                )
        return StressResponse(stress, tangents, volume, functions, self._bulk)
