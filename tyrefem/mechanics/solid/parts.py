"""Materials of a body's regions."""

from __future__ import annotations

from dataclasses import dataclass

from tyrefem.mechanics.solid.compounds import Compound
from tyrefem.mechanics.solid.cords import CordLayer
from tyrefem.mechanics.solid.tread_blocks import TreadBlocks


@dataclass(frozen=True, eq=False)
class RegionMaterial:
    """The material of a region: a compound, and layers of cords at the points of the region's elements.

    ``blocks``: what the bending of a tread's blocks takes off the compound; None: it is whole.
    ``cord_loss`` is the cords' tan delta over the compound's: 0 if the cords lose nothing.
    """

    compound: Compound
    cords: tuple[CordLayer, ...] = ()
    cord_loss: float = 0.0
    blocks: TreadBlocks | None = None
