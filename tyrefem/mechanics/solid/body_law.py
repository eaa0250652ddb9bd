"""The law of a body by its compounds and cords."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tyrefem.mechanics.solid.compounds import determinant
from tyrefem.mechanics.solid.element_group import ElementGroup
from tyrefem.mechanics.solid.elements import Indices, Rings
from tyrefem.mechanics.solid.finite_law import StressResponse
from tyrefem.mechanics.solid.parts import RegionMaterial

Array = NDArray[np.float64]
#: Number of points computed together: their tensors stay in the processor's cache.
TOGETHER = 4000


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

    def slack(self) -> Array:
        """(6, 6, e, q) by how much more stiff slack cords would be if they were taut, in the pre-stressed
        configuration, Pa."""
        missing = np.zeros((6, 6, *self.inflated.shape[2:]))
        for name, part in self.parts.items():
            members = self.members[name]
            f = self.inflated[:, :, members]
            for layer in part.cords:
                taut = replace(layer, compression=max(layer.compression, 1.0), limit=np.inf)
                missing[:, :, members] += (taut.tangent(f) - layer.tangent(f)) / determinant(f)
        return missing

    def response(self, gradient: Array, tangent: type | None = float) -> StressResponse:
        """P and A of every region, in groups of elements."""
        e, _, q, m = gradient.shape
        stress = np.empty(gradient.shape)
        tangents = np.empty((e, 9, 9, q * m), dtype=tangent) if tangent else np.empty(0)
        volume = np.empty(gradient.shape if tangent else 0, dtype=tangent)
        count = max(1, TOGETHER // (q * m))
        for name, part in self.parts.items():
            members = np.asarray(self.members[name])
            for k in range(0, len(members), count):
                inside = slice(k, k + count)
                some = members[inside]
                bulk, inflated = self.bulk_modulus[some], self.inflated[:, :, some]
                group = ElementGroup(self.rings, some, bulk, inflated, gradient[some])
                made = group.response(_of_elements(part, inside), tangent)
                stress[some] = made[0].transpose(1, 0, 2, 3)
                if tangent:
                    tangents[some] = made[1].reshape(9, 9, len(some), q * m).transpose(2, 0, 1, 3)
                    volume[some] = made[2].transpose(1, 0, 2, 3)
        return StressResponse(stress, tangents, volume, self.rings.linear_functions, self._bulk)


def _of_elements(part: RegionMaterial, inside: slice) -> RegionMaterial:
    """The material of some elements of its region, with stiffnesses (e, q, 1) that are the same at all angles."""
    cords = tuple(
        replace(
            layer,
            angle=layer.angle[inside],
            meridian=layer.meridian[:, inside],
            stiffness=layer.stiffness[inside][..., None],
        )
        for layer in part.cords
    )
    blocks = part.blocks
    if blocks is not None:
        blocks = replace(blocks, normal=blocks.normal[:, inside], missing=blocks.missing[inside][..., None])
    return replace(part, cords=cords, blocks=blocks)
