"""Friction heat of a tread whose tyre rolls, leans and corners: ring by ring from steady rolling with friction."""

from __future__ import annotations

import functools
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.cache import Cache, Content
from tyrefem.simulation.sliding_tread import SlidingTread

if TYPE_CHECKING:
    from tyrefem.boundaries.skid import Passage
    from tyrefem.inputs.drive import Phase
    from tyrefem.mechanics.rolling.friction_rings import FrictionRings

Array = NDArray[np.float64]


class RollingTread(SlidingTread):
    """The law of sliding ``rolling``: q = v w(s) into tread and road, W/m2 of the tread's surface.

    w is the friction work of the ring at s per metre and area, mean over a revolution. It is linear in s between the
    rings; a factor near 1 keeps the sum over the surface that of the rings. Over time it is linear between the solved
    states of a phase, as the strain cycle is. In contact the flux is F_0 = q over the ring's share of a revolution.
    """

    def rubs(self, phase: Phase) -> bool:
        """True if the tyre moves: free rolling has friction, too."""
        return not phase.stands

    @functools.cached_property
    def _s(self) -> Cache[Array]:
        return Cache(size=8)

    def _stations(self, x: Array) -> Array:
        """s of points (2, n), m; negative on the side z < 0 of a full section."""
        section = self.surroundings.study.section
        return self._s.get(Content.of(x), lambda: np.asarray(section.locate(np.asarray(x).T)[0]))

    @functools.cached_property
    def _rings(self) -> dict[tuple[int, int], tuple[Array, Array, Array] | None]:
        """(phase, knot) -> s (m,) of the rings, work per metre and area, N/m2, and share of a revolution in contact."""
        rings = {}
        for phase, cycles in enumerate(self.surroundings.schedule.cycles):
            for knot, cycle in enumerate(cycles):
                friction = getattr(cycle, "friction", None)
                rings[phase, knot] = None if friction is None else self._on_surface(friction)
        return rings

    def _on_surface(self, friction: FrictionRings) -> tuple[Array, Array, Array]:
        section = self.surroundings.study.section
        s = np.asarray(section.locate(friction.places.T)[0])
        ours = friction.places[1] >= -1e-9 if section.half else np.ones(len(s), dtype=bool)
        order = np.flatnonzero(ours)[np.argsort(s[ours], kind="stable")]
        s, density = s[order], friction.density[order]
        whole = self._sides * float(self.surface.weight @ np.interp(self._stations(self.surface.x), s, density))
        return s, density * (friction.total / whole if whole > 0 else 0.0), friction.share[order]

    def _interpolated(self, x: Array, t: float, which: int) -> Array:
        """Work (1) or share (2) of the rings at points x (2, n) and a time."""
        s, total = self._stations(x), np.zeros(np.shape(x)[1])
        for phase, knot, weight in self.surroundings.schedule.weights(t):
            rings = self._rings[phase, knot]
            if rings is not None and weight:
                total += weight * np.interp(s, rings[0], rings[which])
        return total

    def _mean(self, name: str, t: float) -> float:
        total = 0.0
        for phase, knot, weight in self.surroundings.schedule.weights(t):
            friction: Any = getattr(self.surroundings.schedule.cycles[phase][knot], "friction", None)
            total += 0.0 if friction is None else weight * getattr(friction, name)
        return total

    def pressure(self, t: float) -> float:
        """Mean contact pressure, Pa: load over `contact_area`; zero off the road."""
        area = self.contact_area(t)
        load = float(self.surroundings.schedule.mean(lambda case: case.load, t))
        return load / area if area > 0 else 0.0

    def friction(self, t: float) -> float:
        """Horizontal force over load, not limited by decomposition."""
        return self._mean("friction", t)

    def sliding_speed(self, t: float) -> float:
        """Nominal speed of the tread over the road, from slip and slip angle, m/s."""
        return self._mean("sliding", t) * self.surroundings.motion(t).speed

    def passage(self, t: float) -> Passage | None:
        """The passage through the footprint at the speed of the rolling tread, which a torque changes, too."""
        passage = super().passage(t)
        rolling = self._mean("rolling", t) * self.surroundings.motion(t).speed
        return passage if passage is None or not rolling else replace(passage, rolling_speed=rolling)

    def contact_share(self, x: Array, t: float) -> Array:
        """Share of a revolution in which points x (2, n) are in contact."""
        return self._interpolated(x, t, 2)

    def uncapped_flux(self, x: Array, t: float) -> Array:
        """F_0 at points x (2, n), not limited by decomposition, W/m2 of contact."""
        heat = self.surroundings.motion(t).speed * self._interpolated(x, t, 1)
        share = self.contact_share(x, t)
        return np.divide(heat, share, out=np.zeros_like(heat), where=share > 0)

    def friction_power(self, flux: Array | float, t: float) -> float:
        """Friction power of the whole tyre, W, from the flux F_0 at the points of `surface`."""
        surface = self.surface
        return self._sides * float((surface.weight * self.contact_share(surface.x, t) * flux).sum())
