"""Cord tensions of every layer over a revolution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from tyrefem.mechanics.footprint.strain_harmonics import StrainHarmonics
    from tyrefem.mechanics.solid.cords import CordLayer
    from tyrefem.mechanics.solid.inflation import Inflation

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CordCycle:
    """Tension of a layer's cords over a revolution, at the place where it is largest.

    Parameters
    ----------
    region : the layer. place : (r, z) before inflation, m.
    angles : (n,) from the middle of the footprint, rad.
    plus, minus : (n,) tension of the cords at +angle and -angle; each is the mirror image of the other.
    inflated : tension before contact with the road.
    unit : ``"N"``, of one cord; ``"Pa"``, v_c E (lambda - 1) of the layer, if the stiffness of one cord is not known.
    """

    region: str
    place: tuple[float, float]
    angles: Array
    plus: Array
    minus: Array
    inflated: float
    unit: str


def cord_cycles(tyre: Inflation, cycle: StrainHarmonics, count: int = 181) -> tuple[CordCycle, ...]:
    """The cords of every region: inflated tension + E A lambda a . e a, with the cords' deformed direction a.

    E A is smaller where the inflated cord is compressed, as in the tangent of the footprint: W''/(v_c E) of it. In
    large motion the tension follows the cords' law at the stretch lambda sqrt(1 + 2 a . E a), with Green's strain E.

    Parameters
    ----------
    tyre : the inflated tyre. cycle : strains of the same tyre over a revolution. count : angles from -pi to pi.
    """
    return tuple(
        _greatest(tyre, cycle, region, layer, np.linspace(-np.pi, np.pi, count))
        for region, part in tyre.body.parts.items()
        for layer in part.cords
    )


def _greatest(tyre: Inflation, cycle: StrainHarmonics, region: str, layer: CordLayer, angles: Array) -> CordCycle:
    members = np.asarray(tyre.body.mesh.subdomains[region])
    deformation = tyre.deformation[:, :, members]
    known = layer.cord_stiffness is not None
    stretch = layer.stretch(deformation)
    inflated = layer.tension(deformation) if known else layer.stress_in_layer(deformation)
    per_stress = np.asarray(layer.cord_stiffness / layer.stiffness if layer.cord_stiffness is not None else 1.0)
    carried = (np.einsum("ij...,j...->i...", deformation, direction) / stretch for direction in layer.directions)
    strains = [cycle.along(direction, angles, members) for direction in carried]
    if cycle.footprint.balanced is None:
        slope = (per_stress * layer.slopes(stretch)[1] * stretch)[..., None]
        halves = [inflated[..., None] + slope * strain for strain in strains]
    else:
        halves = [
            per_stress[..., None] * layer.slope(stretch[..., None] * np.sqrt(1 + 2 * strain)) for strain in strains
        ]
    most = np.maximum(halves[0].max(axis=-1), halves[1].max(axis=-1))
    element, point = (int(i) for i in np.unravel_index(int(most.argmax()), most.shape))
    r, z = tyre.body.rings.points[:, members[element], point]
    plus, minus = (half[element, point] for half in halves)
    unit = "N" if known else "Pa"
    return CordCycle(region, (float(r), float(z)), angles, plus, minus, float(inflated[element, point]), unit)
