"""An inflated tyre and a road, before and after contact: stiffness, compliance of the tread, reach."""

from __future__ import annotations

import functools
from dataclasses import dataclass

from tyrefem.brief import Brief
from tyrefem.errors import InputError
from tyrefem.mechanics.footprint.compliance import TreadCompliance
from tyrefem.mechanics.footprint.harmonics import Harmonics
from tyrefem.mechanics.footprint.road import Road
from tyrefem.mechanics.solid.body import Prestressed

FLAT = Road()


@dataclass(frozen=True, eq=False)
class TyreOnRoad(Brief):
    """An inflated tyre and the road below it.

    Parameters
    ----------
    state : the inflated tyre.
    road : flat or drum, camber (camber needs a full section).

    Raises
    ------
    InputError : camber on a half section.
    """

    state: Prestressed
    road: Road = FLAT

    def __post_init__(self) -> None:
        if self.road.camber and self.state.symmetric in self.state.mesh.boundaries:
            raise InputError("camber needs a full section; this one is a half", field="camber")

    @functools.cached_property
    def harmonics(self) -> Harmonics:
        """Stiffness of every harmonic."""
        return Harmonics(self.state)

    @functools.cached_property
    def tread(self) -> TreadCompliance:
        """Compliance of the tread."""
        return TreadCompliance(self.harmonics)

    @functools.cached_property
    def reach(self) -> float:
        """Reach of the free tyre towards the road, m."""
        return self.road.lowest(self.tread.places)

    @functools.cached_property
    def bottoming(self) -> float:
        """Greatest deflection, m: at most half the drum's diameter, and less than would press the crown's inner surface
        on the highest fixed point (the rim's flange)."""
        return float(min(self._to_rim, self.road.drum_diameter / 2))

    @property
    def end(self) -> str:
        """What ends the deflection at `bottoming`."""
        return "the crown meets the rim" if self.bottoming == self._to_rim else "the tyre meets the drum's axis"

    @functools.cached_property
    def _to_rim(self) -> float:
        elements, state = self.harmonics.elements, self.state
        held = [elements.nodes[0, elements.boundary_nodes(name)].max() for name in state.fixed]
        held += [state.rim_top] if state.rim_top else []
        if not held or not state.pressure:
            return float(max(0.9 * (self.reach - max(held, default=0.0)), 0.0))
        inner = elements.nodes[0, elements.boundary_nodes(state.pressurised)].max()
        return float(inner - max(held))
