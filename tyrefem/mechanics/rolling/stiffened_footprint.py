"""Small motions of a tyre about its footprint in large motion with the moduli of small strain."""

from __future__ import annotations

import functools
from dataclasses import dataclass, replace

import numpy as np

from tyrefem.mechanics.footprint.nonlinear import NonlinearForces, Tangent
from tyrefem.mechanics.footprint.taut_tyre import TautTyre
from tyrefem.mechanics.footprint.tyre_on_road import TyreOnRoad
from tyrefem.mechanics.rolling.loaded_tyre import AntisymmetricTaut, TyreOnFootprint
from tyrefem.mechanics.solid.body import Prestressed


@dataclass(frozen=True, eq=False)
class StiffenedOnFootprint(TyreOnFootprint):
    """A tyre that stands in its footprint: stresses and cords are those of the footprint, the compounds' moduli those
    of ``stiff``, which a small push meets.

    Parameters
    ----------
    stiff : the inflated state with these moduli (`solid.stiffened`). influence : of its compliance.
    """

    stiff: Prestressed | None = None

    @property
    def _stiff(self) -> Prestressed:
        assert self.stiff is not None
        return self.stiff

    @functools.cached_property
    def tangent(self) -> Tangent:
        """K of motions that are even about the lowest point, in single precision."""
        harmonics = self.footprint.pressing.harmonics
        state, forces = harmonics.state, NonlinearForces(harmonics, len(self.motion) - 1)
        known = forces.at(self.motion, np.float32)
        gradient = forces.round.gradient(self.motion)
        more = self._stiff.tangent - state.tangent
        bulk = self._stiff.bulk / state.bulk
        return replace(known, response=known.response.stiffer(harmonics.elements, gradient, more, bulk.mean(axis=1)))

    @functools.cached_property
    def taut(self) -> tuple[TautTyre, TautTyre]:
        """The taut tyre in symmetric and in antisymmetric motions."""
        slack = self.footprint.pressing.harmonics.state
        stiff = TyreOnRoad(replace(self._stiff, law=slack.law), self.footprint.pressing.road)
        return TautTyre(stiff), AntisymmetricTaut(stiff)
