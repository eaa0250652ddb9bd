"""Stress and tangent of a pre-stressed body in a further motion of any size: what every such law gives."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.solid.elements import Rings
from tyrefem.mechanics.solid.finite_deformation import at_points, deformation, strain_gradients

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class StressResponse:
    """First Piola stress P in the pre-stressed configuration and its derivative, both times r dA, at m angles.

    dP = A : dF + V kappa Proj(V : dF), V = dJ/dF: the dilatation is projected on 1, xi, eta of each element.

    Parameters
    ----------
    stress : (e, 9, q, m) P, N m per radian; components 3 k + i with direction k of the force and i of the gradient.
    tangent : (e, 9, 9, q m) A. volume : (e, 9, q, m) V, as precise as A. Empty if only the stress is computed.
    functions : (e, q, 3) 1, xi, eta. bulk : (e, 3, 3) bulk stiffness between them.
    """

    stress: Array
    tangent: Array
    volume: Array
    functions: Array
    bulk: Array

    def product(self, change: Array) -> Array:
        """(e, 9, q, m) change of the stress due to a change (e, 9, q, m) of the gradient."""
        precision = self.tangent.dtype
        change = change.astype(precision, copy=False)
        functions, bulk = self.functions.astype(precision), self.bulk.astype(precision)
        product = np.einsum("eijp,ejp->eip", self.tangent, change.reshape(len(change), 9, -1)).reshape(change.shape)
        dilatation = np.einsum("ecqm,ecqm->eqm", self.volume, change)
        moments = bulk @ (functions.transpose(0, 2, 1) @ dilatation)
        product += self.volume * (functions @ moments)[:, None]
        return np.asarray(product)

    def convex(self, flagged: Flags) -> StressResponse:
        """The response with |A| instead of A in some elements at some angles, flags (e, m): its eigenvalues become
        positive."""
        at = np.broadcast_to(flagged[:, None], (len(flagged), *self.volume.shape[2:])).reshape(len(flagged), -1)
        element, point = np.nonzero(at)
        matrices = self.tangent[element, :, :, point].astype(float)
        values, vectors = np.linalg.eigh(matrices)
        tangent = self.tangent.copy()
        tangent[element, :, :, point] = (vectors * np.abs(values)[:, None]) @ vectors.swapaxes(-1, -2)
        return replace(self, tangent=tangent)

    def stiffer(self, rings: Rings, gradient: Array, modulus: Array, bulk: Array) -> StressResponse:
        """The response with a tangent ``modulus`` (6, 6, e, q), Pa, more and the bulk stiffness times ``bulk`` (e,), at
        gradients (e, 9, q, m); stresses do not change: dP = F dc F' : dF more."""
        strains = strain_gradients(deformation(gradient))
        c = at_points(modulus * rings.weights, 2)[:, :, None]
        more = (strains.swapaxes(-1, -2) @ (c @ strains)).transpose(0, 3, 4, 1, 2).reshape(self.tangent.shape)
        tangent = self.tangent + more.astype(self.tangent.dtype)
        return replace(self, tangent=tangent, bulk=self.bulk * bulk[:, None, None])


class FiniteLaw(Protocol):
    """Stress as a function of displacement gradients from a pre-stressed configuration."""

    def response(self, gradient: Array, tangent: type | None = float) -> StressResponse:
        """`StressResponse` at displacement gradients H (e, 9, q, m) from the pre-stressed configuration.

        ``tangent`` : precision of the tangent; None: only the stress.
        """
        ...  # pragma: no cover
